"""Every stage of which a port handed in an array, judged on its own inputs, array by array where these differ in shape."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.shadows import replay_maps, replay_picture, replay_soft
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
