"""Percentage-closer soft shadows (Fernando 2005): one map of distances, asked in a region as large as the penumbra.

For a point at place x and distance r from the light's plane, with the map parallel to the light (`parallel`):

1. *Blocker search*: over the part of the map through which the light is seen from the point, at the caster's nearest
   distance n, l (1/n - 1/r) around x for l in the light: the mean distance b of the texels nearer than r. None: lit.
2. *Penumbra estimate*: light, blocker and receiver as if they were parallel planes. The filter's region on the map is
   l (1/b - 1/r), Fernando's w = (r - b) w_light / b, seen from the light.
3. *Filter*: the mean of percentage-closer comparisons over that region, each the bilinear mix of four (Reeves 1987).

Both regions are sampled at the points of a lattice (`lattice`), the same for every pixel: no noise. A blocker is nearer
than r - bias.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline import memory
from ibr_ref.pipeline.sampling import footprint, lerp, nearest_index
from ibr_ref.shadows.lattice import on_parallelogram
from ibr_ref.shadows.parallel import Frame, Window


class Filter(NamedTuple):
    """How the map is asked."""

    search: Floats
    """(N, 2) points of the light, for the blocker search."""
    points: Floats
    """(M, 2) points of the light, for the filter."""
    bias: float
    """Of distances, world units."""


class Softened(NamedTuple):
    """What is found of each pixel."""

    blocker: Floats
    """(H, W) b; infinite where no blocker is."""
    shadow: Floats
    """(H, W)."""


def filter_of(frame: Frame, search: int, points: int, bias: float) -> Filter:
    """The filter for a light, with so many points."""
    centre = np.zeros(2)
    return Filter(
        on_parallelogram(centre, frame.half_edges, search), on_parallelogram(centre, frame.half_edges, points), bias
    )


@device
def _to_map(x, y, low, high):
    """Texture coordinates of a place, v downwards."""
    return (x - low[0]) / (high[0] - low[0]), (high[1] - y) / (high[1] - low[1])


@device
def _is_on_map(u, v):
    return (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0)


@device
def _mean_blocker(texels, size, low, high, search, x, y, scale, nearer_than):
    """The mean distance of the blockers around a place; infinite without any."""
    total, count = 0.0, 0
    for i in range(len(search)):
        u, v = _to_map(x + search[i, 0] * scale, y + search[i, 1] * scale, low, high)
        if _is_on_map(u, v):
            distance = texels[nearest_index(u, v, size, size, None)]
            if distance < nearer_than:
                total += distance
                count += 1
    return total / count if count > 0 else np.inf


@device
def _nearer(texel, nearer_than):
    return 1.0 if texel < nearer_than else 0.0


@device
def _filtered(texels, size, low, high, points, x, y, scale, nearer_than):
    """The mean of the comparisons around a place."""
    total = 0.0
    for i in range(len(points)):
        u, v = _to_map(x + points[i, 0] * scale, y + points[i, 1] * scale, low, high)
        if _is_on_map(u, v):
            i00, i10, i01, i11, fx, fy = footprint(u, v, size, size, None)
            top = lerp(_nearer(texels[i00], nearer_than), _nearer(texels[i10], nearer_than), fx)
            bottom = lerp(_nearer(texels[i01], nearer_than), _nearer(texels[i11], nearer_than), fx)
            total += lerp(top, bottom, fy)
    return total / len(points)


@device
def _soften_row(triangle, world, view, caster, low, high, nearest, texels, size, wanted, blocker, shadow):
    for i in range(len(shadow)):
        blocker[i], shadow[i] = np.inf, 0.0
        if triangle[i] < 0 or triangle[i] >= caster:
            continue
        x, y, z = world[i, 0], world[i, 1], world[i, 2]
        r = -(view[2, 0] * x + view[2, 1] * y + view[2, 2] * z + view[2, 3])
        if r <= nearest:
            continue
        s = (view[0, 0] * x + view[0, 1] * y + view[0, 2] * z + view[0, 3]) / r
        t = (view[1, 0] * x + view[1, 1] * y + view[1, 2] * z + view[1, 3]) / r
        if s < low[0] or s > high[0] or t < low[1] or t > high[1]:  # the map is wider than any penumbra
            continue
        before, scale = r - wanted.bias, 1.0 / nearest - 1.0 / r
        blocker[i] = _mean_blocker(texels, size, low, high, wanted.search, s, t, scale, before)
        if blocker[i] < np.inf:
            scale = 1.0 / blocker[i] - 1.0 / r
            shadow[i] = _filtered(texels, size, low, high, wanted.points, s, t, scale, before)


@kernel
def _soften(triangle, varyings, view, caster, low, high, nearest, texels, size, wanted, result):
    for row in prange(len(triangle)):
        _soften_row(
            triangle[row],
            varyings[row],
            view,
            caster,
            low,
            high,
            nearest,
            texels,
            size,
            wanted,
            result.blocker[row],
            result.shadow[row],
        )


def soften(
    triangle: NDArray[np.int32],
    varyings: Floats,
    caster: int,
    frame: Frame,
    window: Window,
    distances: Floats,
    wanted: Filter,
) -> Softened:
    """The shadow of what the camera sees, from a map of the caster's distances (S, S), infinite where it is not.

    triangle (H, W), varyings (H, W, 3 or more): those of the `Surface`; triangles from index `caster` on are lit.
    """
    height, width = triangle.shape
    result = Softened(*memory.arrays([(np.float64, (height, width))] * 2))
    size, view = float(len(distances)), frame.view_from_world
    _soften(
        triangle,
        varyings,
        view,
        caster,
        window.low,
        window.high,
        window.near,
        distances.reshape(-1),
        size,
        wanted,
        result,
    )
    return result
