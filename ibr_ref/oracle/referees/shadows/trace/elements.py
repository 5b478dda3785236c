"""Which trace belongs to which element of which stage."""

from __future__ import annotations

from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.stages import PARTS
from ibr_ref.oracle.referees.shadows.trace.grid import grid_texel
from ibr_ref.oracle.referees.shadows.trace.maps import control, depth, map_texel, position
from ibr_ref.oracle.referees.shadows.trace.picture import pixel
from ibr_ref.oracle.referees.shadows.trace.warp import grid_point, paced, place, warped_texel

STEPS = ("maps", "controls", "warp")
PICTURES = ("depth", "project", "accumulate", "resolve", "image")


def trace(given: Inputs, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
    """Rows of one element, by its index in its judgement.

    A stage has elements of several kinds: its array in place of its name says which. Of a stage an index that fits more than
    one belongs to the first that is wrong there. Raises ValueError for a stage that the method has not, and for an index
    that no element has.
    """
    if stage in PICTURES:
        return pixel(given, stage, index)
    name, _, part = stage.partition(".")
    if name not in STEPS:
        raise ValueError(f"stage: found {stage!r}, allowed: {' | '.join([*STEPS, *PICTURES])}")
    array = stage if part else _array(given, stage, index)
    if array == "maps.positions":
        return position(given, index)
    if array == "maps.depths":
        return depth(given, index)
    if array == "maps.image" or (array == "warp.image" and given.direct):
        return map_texel(given, array, index)
    if array == "warp.image" and not given.warps:
        return grid_texel(given, index)
    if array == "controls":
        return control(given, index)
    if array in ("warp.cell", "warp.fraction"):
        return place(given, index)
    if array == "warp.shares":
        return paced(given, index)
    if array in ("warp.row_grids", "warp.grid"):
        return grid_point(given, array, index)
    return warped_texel(given, array, index)


def _array(given: Inputs, stage: str, index: tuple[int, ...]) -> str:
    """The first of the stage's arrays with an element of that index, a wrong one before others."""
    fitting = []
    for judge in (judge for name, _, judge in PARTS.values() if name == stage):
        found = judge(given)
        inside = found is not None and len(index) == found.wrong.ndim
        if found is None or not inside or not all(i < n for i, n in zip(index, found.wrong.shape, strict=True)):
            continue
        if found.wrong[index]:
            return found.arrays[max(int(found.blame[index]), 0)]
        fitting.append(found.arrays[0])
    if not fitting:
        raise ValueError(f"index: found {index}, allowed: that of an element of stage {stage} that was handed in")
    return fitting[0]
