"""The area light itself: rays from every visible point to points all over the light, through the caster's triangles.

What the light's samples, and everything that softens one map, converge to or fall short of: the share of the light's area
that the caster hides. As in the maps, nothing but the caster hides it, and the caster itself is lit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices, Ints
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline import memory
from ibr_ref.shadows.hierarchy import DEEPEST, Hierarchy, build, meets


@device
def _is_lit(hierarchy: Hierarchy, light_low: Floats, light_high: Floats, x: float, y: float, z: float) -> bool:
    """Whether the box around a point and the light has nothing in common with the caster's: then no ray need be cast.

    light_low, light_high (3,): the ends of the lights' box.
    """
    low, high = hierarchy.low[0], hierarchy.high[0]
    beside_x = (min(x, light_low[0]) > high[0]) | (max(x, light_high[0]) < low[0])
    beside_y = (min(y, light_low[1]) > high[1]) | (max(y, light_high[1]) < low[1])
    beside_z = (min(z, light_low[2]) > high[2]) | (max(z, light_high[2]) < low[2])
    return beside_x | beside_y | beside_z


@device
def _hidden(hierarchy: Hierarchy, lights: Floats, x: float, y: float, z: float, waiting: Ints) -> int:
    """How many of the lights (N, 3) a point does not see. waiting (DEEPEST,): room for boxes."""
    hidden = 0
    for i in range(len(lights)):
        direction = lights[i, 0] - x, lights[i, 1] - y, lights[i, 2] - z
        hidden += meets(hierarchy, (x, y, z), direction, waiting)
    return hidden


@device
def _trace_row(
    triangle: Indices,
    world: Floats,
    caster: int,
    hierarchy: Hierarchy,
    lights: Floats,
    light_low: Floats,
    light_high: Floats,
    shadow: Floats,
) -> None:
    """A row: triangle (W,), world (W, 3 or more), lights (N, 3) and the ends of their box (3,), into shadow (W,)."""
    waiting = np.empty(DEEPEST, np.int64)
    for i in range(len(shadow)):
        shadow[i] = 0.0
        if triangle[i] < 0 or triangle[i] >= caster:
            continue
        x, y, z = world[i, 0], world[i, 1], world[i, 2]
        if not _is_lit(hierarchy, light_low, light_high, x, y, z):
            shadow[i] = _hidden(hierarchy, lights, x, y, z, waiting) / len(lights)


@kernel
def _trace(
    triangle: Indices,
    varyings: Floats,
    caster: int,
    hierarchy: Hierarchy,
    lights: Floats,
    light_low: Floats,
    light_high: Floats,
    shadow: Floats,
) -> None:
    """All rows of `traced`."""
    rows = len(shadow)
    for turn in prange(rows):
        # Rows far apart in turn, as the shadow lies in a few neighbouring ones.
        row = turn // 2 if turn % 2 == 0 else rows - 1 - turn // 2
        _trace_row(triangle[row], varyings[row], caster, hierarchy, lights, light_low, light_high, shadow[row])


def traced(
    triangle: NDArray[np.int32],
    varyings: Floats,
    caster: int,
    vertices: Floats,
    triangles: NDArray[np.int32],
    lights: Floats,
) -> Floats:
    """(H, W) the share of the lights (N, 3) that the caster hides from each visible point.

    triangle (H, W), varyings (H, W, 3 or more): those of the `Surface`, where the caster's triangles begin with index
    `caster`; vertices (V, 3) and triangles (T, 3): the caster in world space.
    """
    (shadow,) = memory.arrays([(np.float64, triangle.shape)])
    hierarchy: Hierarchy = build(vertices, triangles)
    ends = lights.min(axis=0), lights.max(axis=0)
    _trace(triangle, varyings, caster, hierarchy, lights, *ends, shadow)
    return shadow
