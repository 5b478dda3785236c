"""Every stage of which a port handed in an array, judged on its own inputs, array by array where these differ in shape."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.shadows import replay_maps, replay_picture, replay_soft
from ibr_ref.oracle.referees.shadows.image import Accepted
from ibr_ref.oracle.referees.shadows.inputs import HANDED_OVER, Inputs

Judge = Callable[[Inputs], Judgement | None]
PARTS: dict[str, tuple[str, tuple[str, ...], Judge]] = {
    "maps.positions": ("maps", ("maps.positions",), replay_maps.positions),
    "maps.depths": ("maps", ("maps.depths",), replay_maps.depths),
    "maps.image": ("maps", ("maps.image",), replay_maps.images),
    "controls": ("controls", ("controls",), replay_maps.controls),
    "warp.cell": ("warp", ("warp.cell", "warp.fraction"), replay_maps.spots),
    "warp.shares": ("warp", ("warp.shares",), replay_maps.shares),
    "warp.row_grids": ("warp", ("warp.row_grids",), replay_maps.row_grids),
    "warp.rows": ("warp", ("warp.rows",), replay_maps.rows),
    "warp.grid": ("warp", ("warp.grid",), replay_maps.grids),
    "warp.image": ("warp", ("warp.image",), replay_maps.warped),
    "depth": ("depth", ("depth",), replay_picture.depth),
    "project": ("project", replay_soft.NAMES, replay_picture.projected),
    "accumulate": ("accumulate", ("accumulate.shadow",), replay_picture.sums),
    "resolve": ("resolve", ("color",), replay_picture.colors),
}
"""By part its stage, its arrays, and who judges it, in order."""
ARRAYS: dict[str, tuple[str, ...]] = {**{part: arrays for part, (_, arrays, _) in PARTS.items()}, "image": ()}
"""For each part of a stage that is judged by itself the arrays that it is compared by."""
PIXELS = ("depth", "project", "accumulate", "resolve", "image")
"""Whose elements are pixels, of which some are sooner judged than all."""
START = 100
"""What setting up a program costs, in rows of a march."""


def part_of(stage: str) -> str:
    """The part that a stage has, or that an array is of; "image" is one."""
    return next((part for part, (_, arrays, _) in PARTS.items() if stage in arrays), stage)


def judgements(given: Inputs) -> Iterator[Judgement]:
    """Of what was handed in, in pipeline order."""
    found = (judged(given, part) for part in PARTS)
    return (judgement for judgement in found if judgement is not None)


def judged(given: Inputs, part: str) -> Judgement | None:
    """Fed with the port's own nine maps, or else with those that the case hands over; None: nothing was handed in."""
    judge = PARTS[part][2]
    judgement = judge(given)
    if judgement is None or not judgement.wrong.any() or not {*HANDED_OVER} & {*judgement.replayed}:
        return judgement
    assert given.as_the_case is not None
    other = judge(given.as_the_case)
    return judgement if other is None or judgement.wrong.sum() <= other.wrong.sum() else other


@dataclass(frozen=True, eq=False)
class Replay:
    """A port's stages part by part, by the program that is given."""

    given: Inputs
    known: dict[str, Judgement | None] = field(default_factory=dict)

    @property
    def cost(self) -> int:
        """In rows of a march: those of this program are a sixteenth as long."""
        return START + self.given.model.machine.run.rows // 16

    def names(self, part: str) -> tuple[str, ...]:
        """What of a part was handed in, and is judged in this case."""
        named = tuple(name for name in ARRAYS[part] if name in self.given.handed)
        return named if named and self._judged(part) is not None else ()

    def _judged(self, part: str) -> Judgement | None:
        if part not in self.known:
            alone = part == "image"
            self.known[part] = Accepted.of(self.given).judge(self.given.picture) if alone else judged(self.given, part)
        return self.known[part]

    def judge(self, part: str) -> Judgement:
        """One part, or "image"; of a picture the pixels that are looked at."""
        found = self._judged(part)
        assert found is not None
        among = self.given.among
        if among is None or part not in PIXELS:
            return found
        return replace(found, wrong=found.wrong & among.reshape(found.wrong.shape))
