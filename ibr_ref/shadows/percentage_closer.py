"""Percentage-closer soft shadows (Fernando 2005): one map of distances, asked in a region as large as the penumbra.

For a point at place x and distance r from the light's plane, with the map parallel to the light (`parallel`):

1. *Blocker search*: over the part of the map through which the light is seen from the point, at the caster's nearest
   distance n, l (1/n - 1/r) around x for l in the light: the mean distance b of the texels nearer than r. None: lit.
2. *Penumbra estimate*: light, blocker and receiver as if they were parallel planes. The filter's region on the map is
   l (1/b - 1/r), Fernando's w = (r - b) w_light / b, seen from the light.
3. *Filter*: the mean of percentage-closer comparisons over that region, each the bilinear mix of four (Reeves 1987).

Both regions are sampled at the points of a lattice (`lattice`), the same for every pixel: no noise. A blocker is nearer
than r - bias. Places and points are kept as texture coordinates, v downwards.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices, Texels, Vector3
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline import memory
from ibr_ref.pipeline.sampling import footprint, lerp, nearest_index
from ibr_ref.shadows.lattice import on_parallelogram
from ibr_ref.shadows.parallel import Frame, Window
from ibr_ref.shadows.project import edge_distance


class Filter(NamedTuple):
    """How the map is asked."""

    search: Floats
    """(N, 2) points of the light, for the blocker search: texture coordinates on the map at distance 1."""
    points: Floats
    """(M, 2) points of the light, for the filter."""
    bias: float
    """Of distances, world units."""
    caster: int
    """The first of the caster's triangles: they and those after it are lit."""


class Softened(NamedTuple):
    """The arrays of the stage."""

    coord: Floats
    """(H, W, 3) s, t, and r, the distance from the light's plane; 0 where no surface is."""
    shadow: Floats
    """(H, W) 0 lit to 1."""
    blocker: Floats
    """(H, W) b; 0 where no blocker is."""
    penumbra: Floats
    """(H, W) 1/b - 1/r; 0 where no blocker is."""
    margin: Floats
    """(H, W)."""
    texel_margin: Floats
    """(H, W)."""


def on_map(frame: Frame, window: Window, count: int) -> Floats:
    """(N, 2) so many points of the light, as texture coordinates at distance 1."""
    points = on_parallelogram(np.zeros(2), frame.half_edges, count)
    shares: Floats = points / (window.high - window.low) * np.array([1.0, -1.0])
    return shares


@device
def _is_on_map(u: float, v: float) -> bool:
    return (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0)


@device
def _mean_blocker(
    texels: Texels, size: float, search: Floats, u: float, v: float, scale: float, nearer_than: float
) -> Vector3:
    """The mean distance of the blockers around a place, 0 without any; and the margins of what was asked. search (N, 2)."""
    total, count, margin, edge = 0.0, 0, np.inf, np.inf
    for i in range(len(search)):
        s, t = u + search[i, 0] * scale, v + search[i, 1] * scale
        if _is_on_map(s, t):
            distance = texels[nearest_index(s, t, size, size, None)]
            margin = min(margin, abs(distance - nearer_than))
            edge = min(edge, min(edge_distance(s * size), edge_distance(t * size)))
            if distance < nearer_than:
                total += distance
                count += 1
    return (total / count if count > 0 else 0.0), margin, edge


@device
def _nearer(texel: float, nearer_than: float) -> float:
    return 1.0 if texel < nearer_than else 0.0


@device
def _filtered(
    texels: Texels, size: float, points: Floats, u: float, v: float, scale: float, nearer_than: float
) -> tuple[float, float]:
    """The mean of the comparisons around a place, and their smallest margin. points (M, 2)."""
    total, margin = 0.0, np.inf
    for i in range(len(points)):
        s, t = u + points[i, 0] * scale, v + points[i, 1] * scale
        if _is_on_map(s, t):
            i00, i10, i01, i11, fx, fy = footprint(s, t, size, size, None)
            t00, t10, t01, t11 = texels[i00], texels[i10], texels[i01], texels[i11]
            top = lerp(_nearer(t00, nearer_than), _nearer(t10, nearer_than), fx)
            bottom = lerp(_nearer(t01, nearer_than), _nearer(t11, nearer_than), fx)
            total += lerp(top, bottom, fy)
            upper = min(abs(t00 - nearer_than), abs(t10 - nearer_than))
            margin = min(margin, min(upper, min(abs(t01 - nearer_than), abs(t11 - nearer_than))))
    return total / len(points), margin


@device
def _nothing(result: Softened, row: int, i: int) -> None:
    for k in range(3):
        result.coord[row, i, k] = 0.0
    result.shadow[row, i], result.blocker[row, i], result.penumbra[row, i] = 0.0, 0.0, 0.0
    result.margin[row, i], result.texel_margin[row, i] = np.inf, np.inf


@device
def _soften_row(
    triangle: Indices,
    world: Floats,
    view: Floats,
    window: Window,
    texels: Texels,
    size: float,
    wanted: Filter,
    row: int,
    result: Softened,
) -> None:
    """A row: triangle (W,), world (W, 3 or more), view (4, 4)."""
    low, high = window.low, window.high
    for i in range(len(triangle)):
        _nothing(result, row, i)
        if triangle[i] < 0:
            continue
        x, y, z = world[i, 0], world[i, 1], world[i, 2]
        r = -(view[2, 0] * x + view[2, 1] * y + view[2, 2] * z + view[2, 3])
        across = (view[0, 0] * x + view[0, 1] * y + view[0, 2] * z + view[0, 3]) / r
        up = (view[1, 0] * x + view[1, 1] * y + view[1, 2] * z + view[1, 3]) / r
        s, t = (across - low[0]) / (high[0] - low[0]), (high[1] - up) / (high[1] - low[1])
        result.coord[row, i, 0], result.coord[row, i, 1], result.coord[row, i, 2] = s, t, r
        if triangle[i] >= wanted.caster or r <= window.near or not _is_on_map(s, t):
            continue  # the map is wider than any penumbra
        before, scale = r - wanted.bias, 1.0 / window.near - 1.0 / r
        b, margin, edge = _mean_blocker(texels, size, wanted.search, s, t, scale, before)
        if b > 0.0:
            scale = 1.0 / b - 1.0 / r
            shadow, other = _filtered(texels, size, wanted.points, s, t, scale, before)
            result.blocker[row, i], result.penumbra[row, i], result.shadow[row, i] = b, scale, shadow
            margin = min(margin, other)
        result.margin[row, i], result.texel_margin[row, i] = margin, edge


@kernel
def _soften(
    triangle: Indices,
    varyings: Floats,
    view: Floats,
    window: Window,
    texels: Texels,
    size: float,
    wanted: Filter,
    result: Softened,
) -> None:
    """All rows of `soften`; the map's texels flat, (S S,)."""
    for row in prange(len(triangle)):
        _soften_row(triangle[row], varyings[row], view, window, texels, size, wanted, row, result)


def soften(
    triangle: NDArray[np.int32], varyings: Floats, frame: Frame, window: Window, distances: Floats, wanted: Filter
) -> Softened:
    """The shadow of what the camera sees, from a map of the caster's distances (S, S), infinite where it is not.

    triangle (H, W), varyings (H, W, 3 or more): those of the `Surface`.
    """
    height, width = triangle.shape
    result = Softened(*memory.arrays([(np.float64, (height, width, 3)), *[(np.float64, (height, width))] * 5]))
    size, view = float(len(distances)), frame.view_from_world
    _soften(triangle, varyings, view, window, distances.reshape(-1), size, wanted, result)
    return result
