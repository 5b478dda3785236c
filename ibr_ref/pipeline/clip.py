"""Clipping of triangles in clip space, before the division by w.

Near plane z >= 0, then far plane z <= w; the polygon is fanned from its first vertex. Only where a vertex then lies
outside the guard band of +-2^20 pixels around the picture's centre is the polygon cut there too, so that the edge
functions fit into 64 bits. The crossing of an edge is computed from its inside vertex to its outside one: two
triangles that share the edge get the same point, in whichever direction they run through it.

Arrays: clip (V, 4), varyings (V, K), indices (T, 3); polygon, spare, result (9, 4 + K), a vertex's clip coordinates and then
its varyings; out_clip, out_varyings, out_source as in `ClippedTriangles`, with room for all.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices
from ibr_ref.jit import device, routine
from ibr_ref.pipeline.sampling import lerp

GUARD = 2097152.0  # 2^21: |x_ndc| up to 2^21/width is +-2^20 pixels
_MOST = 9  # vertices of a triangle after six planes
_NEAR, _FAR, _LEFT, _RIGHT, _BOTTOM, _TOP = range(6)


class ClippedTriangles(NamedTuple):
    """Triangles after clipping: corners (T, 3, 4) in clip space, their varyings (T, 3, K), their source (T,) triangle."""

    clip: NDArray[np.float64]
    varyings: NDArray[np.float64]
    source: NDArray[np.int32]


@device
def _distance(plane: int, x: float, y: float, z: float, w: float, guard_x: float, guard_y: float) -> float:
    """Signed distance from a clip plane, in clip units: >= 0 inside."""
    if plane == _NEAR:
        return z
    if plane == _FAR:
        return w - z
    if plane == _LEFT:
        return guard_x * w + x
    if plane == _RIGHT:
        return guard_x * w - x
    if plane == _BOTTOM:
        return guard_y * w + y
    return guard_y * w - y


@device
def _plane_distance(plane: int, polygon: Floats, i: int, guard_x: float, guard_y: float) -> float:
    """The same of a polygon's vertex i."""
    return _distance(plane, polygon[i, 0], polygon[i, 1], polygon[i, 2], polygon[i, 3], guard_x, guard_y)


@device
def _cut(plane: int, polygon: Floats, count: int, result: Floats, guard_x: float, guard_y: float) -> int:
    """One Sutherland-Hodgman step: cut `polygon[:count]` (clip coordinates, then varyings) into `result`; its count."""
    kept = 0
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        here = _plane_distance(plane, polygon, i, guard_x, guard_y)
        there = _plane_distance(plane, polygon, j, guard_x, guard_y)
        if here >= 0.0:
            for k in range(polygon.shape[1]):
                result[kept, k] = polygon[i, k]
            kept += 1
        if (here >= 0.0) != (there >= 0.0):
            inside, outside = (i, j) if here >= 0.0 else (j, i)
            t = here / (here - there) if here >= 0.0 else there / (there - here)
            for k in range(polygon.shape[1]):
                result[kept, k] = lerp(polygon[inside, k], polygon[outside, k], t)
            kept += 1
    return kept


@device
def _needs_guard(polygon: Floats, count: int, guard_x: float, guard_y: float) -> bool:
    """Whether any of the polygon's first `count` vertices lies outside the guard band."""
    for i in range(count):
        w = polygon[i, 3]
        if abs(polygon[i, 0]) > guard_x * w or abs(polygon[i, 1]) > guard_y * w:
            return True
    return False


@device
def _clip_polygon(polygon: Floats, spare: Floats, guard_x: float, guard_y: float) -> int:
    """Clip the triangle in `polygon[:3]` in place, an even number of cuts; the number of vertices left (0: nothing)."""
    count, here, there = 3, polygon, spare
    for plane in range(_TOP + 1):  # a plane that is known at compile time is compiled for by itself, six times all
        if plane == _LEFT and not _needs_guard(polygon, count, guard_x, guard_y):
            break
        count = _cut(plane, here, count, there, guard_x, guard_y)
        here, there = there, here
    return count


@device
def _outside(clip: Floats, indices: Indices, triangle: int, guard_x: float, guard_y: float) -> bool:
    """Whether any plane has to cut the triangle."""
    for corner in range(3):
        i = indices[triangle, corner]
        x, y, z, w = clip[i, 0], clip[i, 1], clip[i, 2], clip[i, 3]
        if not (0.0 <= z <= w and abs(x) <= guard_x * w and abs(y) <= guard_y * w):
            return True
    return False


@device
def _emit(
    polygon: Floats, count: int, triangle: int, total: int, out_clip: Floats, out_varyings: Floats, out_source: Indices
) -> int:
    """Append the fan of `polygon[:count]` to the output."""
    for fan in range(count - 2):
        out_source[total] = triangle
        for corner in range(3):
            vertex = 0 if corner == 0 else fan + corner
            for k in range(polygon.shape[1]):
                if k < 4:
                    out_clip[total, corner, k] = polygon[vertex, k]
                else:
                    out_varyings[total, corner, k - 4] = polygon[vertex, k]
        total += 1
    return total


@device
def _keep(
    clip: Floats, varyings: Floats, indices: Indices, triangle: int, total: int, out_clip: Floats, out_varyings: Floats,
    out_source: Indices,
) -> None:  # fmt: skip
    """Append a triangle that no plane cuts to the output."""
    out_source[total] = triangle
    for corner in range(3):
        vertex = indices[triangle, corner]
        for k in range(4):
            out_clip[total, corner, k] = clip[vertex, k]
        for k in range(varyings.shape[1]):
            out_varyings[total, corner, k] = varyings[vertex, k]


@routine
def _clip(
    clip: Floats, varyings: Floats, indices: Indices, guard_x: float, guard_y: float, out_clip: Floats,
    out_varyings: Floats, out_source: Indices,
) -> int:  # fmt: skip
    """Clip all triangles in order; the number of triangles that are left."""
    polygon = np.empty((_MOST, 4 + varyings.shape[1]))
    spare = np.empty_like(polygon)
    total = 0
    for triangle in range(len(indices)):
        if not _outside(clip, indices, triangle, guard_x, guard_y):
            _keep(clip, varyings, indices, triangle, total, out_clip, out_varyings, out_source)
            total += 1
            continue
        for corner in range(3):
            vertex = indices[triangle, corner]
            for k in range(polygon.shape[1]):
                polygon[corner, k] = clip[vertex, k] if k < 4 else varyings[vertex, k - 4]
        count = _clip_polygon(polygon, spare, guard_x, guard_y)
        total = _emit(polygon, count, triangle, total, out_clip, out_varyings, out_source)
    return total


@routine
def _most_triangles(clip: Floats, indices: Indices, guard_x: float, guard_y: float) -> int:
    """Room for all results: a triangle with all corners inside stays one, another becomes at most a fan of seven."""
    room = 0
    for triangle in range(len(indices)):
        room += _MOST - 2 if _outside(clip, indices, triangle, guard_x, guard_y) else 1
    return room


def clip_triangles(
    clip: NDArray[np.float64], varyings: NDArray[np.float64], indices: NDArray[np.int32], width: int, height: int
) -> ClippedTriangles:
    """Clip indexed triangles for a picture of `width` x `height` pixels.

    clip (V, 4), varyings (V, K), indices (T, 3); the result keeps the triangles' order.
    """
    guard_x, guard_y = GUARD / width, GUARD / height
    room = _most_triangles(clip, indices, guard_x, guard_y)
    out_clip = np.empty((room, 3, 4))
    out_varyings = np.empty((room, 3, varyings.shape[1]))
    source = np.empty(room, np.int32)
    total = _clip(clip, varyings, indices, guard_x, guard_y, out_clip, out_varyings, source)
    return ClippedTriangles(out_clip[:total], out_varyings[:total], source[:total])
