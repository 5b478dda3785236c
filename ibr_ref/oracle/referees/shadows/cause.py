"""The known bugs that explain a wrong stage of shadows, or a picture by itself."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from typing import Any

from ibr_ref.array_types import Bools
from ibr_ref.oracle.faults.shadows import MUTANTS
from ibr_ref.oracle.faults.shadows.hidden import GIVEN
from ibr_ref.oracle.faults.taken import Setting
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement
from ibr_ref.oracle.programs.shadows import Port as Program
from ibr_ref.oracle.referees.causes import Inquiry, Numbers, explained
from ibr_ref.oracle.referees.shadows.image import Accepted
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.stages import PARTS, judged

ARRAYS = {**{part: arrays for part, (_, arrays, _) in PARTS.items()}, "image": ()}
"""For each part of a stage that is judged by itself the arrays that it is compared by."""
FIRST = {stage: part for part, (stage, _, _) in reversed(PARTS.items())}
"""Of each stage the first part: from there on its bugs are tried."""
PIXELS = ("depth", "project", "accumulate", "resolve", "image")
"""Whose elements are pixels, of which some are looked at before all."""
START = 100
"""What setting up a program costs, in rows of a march."""

_SUSPECTS = tuple(replace(mutant, stage=FIRST[mutant.stage]) for mutant in MUTANTS)


@dataclass(frozen=True, eq=False)
class Replay:
    """A port's stages by the program of a known bug."""

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


def causes(right: Inputs, handed: Handed, wrong: Judgement) -> Explanation | None:
    """The bugs that explain every element of a part of a stage.

    Bugs of the stage first, then, where none of them does, those that may hide in it; of a picture those of all stages. And
    the numbers of the case that do, or that the port's results look like.
    """
    inquiry, numbers, part = _inquiry(right), _numbers(right, handed), _part(wrong)
    if part == "image":
        return explained(inquiry, numbers, replace(wrong, stage=part), [*FIRST.values()])
    hidden = {FIRST[PARTS[each][0]] for each in inquiry.hidden_in(part, handed)}
    return explained(inquiry, numbers, replace(wrong, stage=part), (FIRST[wrong.stage],), hidden - {FIRST[wrong.stage]})


def recognizes(right: Inputs, wrong: Judgement, cause: str) -> bool:
    """Whether the bug of that name explains every element of a part of a stage, or of a picture."""
    part = replace(wrong, stage=_part(wrong))
    return _numbers(right, right.picture or right.handed).recognizes(_inquiry(right), part, cause)


def _numbers(right: Inputs, handed: Handed) -> Numbers:
    """Those of maps, of comparisons and of the light."""
    case = right.case
    mask, maps = case.params.content == "mask", "warp" if right.direct else "maps"
    frustum, given = ("caster_clip", "moved_clip"), right.picture and not right.direct
    settings = [Setting(path=("scene", "ambient"), stages=("resolve",), read_by=("ambient",))]
    if not mask:
        settings.append(
            Setting(path=("params", "bias"), stages=("project",), read_by=("biased",), jumps=not case.params.pcf)
        )
    if not given:  # a picture is made with the maps that the case hands over
        settings += [Setting(path=("params", "map_samples"), stages=(maps,), read_by=("share",))] if mask else []
    if right.direct and right.picture:  # else the arrays' shapes say it
        settings += [
            Setting(path=("params", "map_size"), stages=(maps,), read_by=frustum),
            Setting(path=("params", "light_samples"), stages=(maps,), read_by=("sample_places",), among=(1, 5, 9)),
        ]
    light = ("near", "far") if not mask else ()
    settings += [
        Setting(path=("scene", "light", name), stages=(maps, "project"), read_by=frustum)
        for name in (*light, "vertical_fov")
    ]
    settings = [replace(each, stages=tuple(FIRST[stage] for stage in each.stages)) for each in settings]
    return Numbers(case=case, port=Program, settings=settings, handed=handed)


def _part(wrong: Judgement) -> str:
    """A stage of several arrays is judged array by array."""
    if wrong.stage not in FIRST:
        return wrong.stage
    return next(
        part for part, (stage, arrays, _) in PARTS.items() if stage == wrong.stage and {*arrays} & {*wrong.arrays}
    )


def _inquiry(right: Inputs) -> Inquiry:
    def replay(kind: type[Any], among: Bools | None) -> Replay:
        return Replay(replace(right, kind=kind, among=among, right=right))

    sampled: Collection[str] = PIXELS
    # A picture is made with the maps that the case hands over.
    suspects = [m for m in _SUSPECTS if m.applies(right.case.system) and not (right.picture and m.hidden == GIVEN)]
    return Inquiry(mutants=suspects, arrays=ARRAYS, replay=replay, sampled=sampled)
