"""Clipping of triangles in clip space, before the division by w.

Near plane z >= 0, then far plane z <= w; the polygon is fanned from its first vertex. Only where a vertex then lies
outside the guard band of +-2^20 pixels around the picture's centre is the polygon cut there too, so that the edge
functions fit into 64 bits. The crossing of an edge is computed from its inside vertex to its outside one: two
triangles that share the edge get the same point, in whichever direction they run through it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import lerp

_GUARD = 2097152.0  # 2^21: |x_ndc| up to 2^21/width is +-2^20 pixels
_MOST = 9  # vertices of a triangle after six planes
_NEAR, _FAR, _LEFT, _RIGHT, _BOTTOM, _TOP = range(6)


class ClippedTriangles(NamedTuple):
    """Triangles after clipping: corners (T, 3, 4) in clip space, their varyings (T, 3, K), their source (T,) triangle."""

    clip: NDArray[np.float64]
    varyings: NDArray[np.float64]
    source: NDArray[np.int32]


@device
def _distance(plane, x, y, z, w, guard_x, guard_y):
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
def _cut(plane, polygon, count, result, guard_x, guard_y):
    """One Sutherland-Hodgman step: cut `polygon[:count]` (clip coordinates, then varyings) into `result`; its count."""
    kept = 0
    for i in range(count):
        a = polygon[i]
        b = polygon[i + 1 if i + 1 < count else 0]
        a_distance = _distance(plane, a[0], a[1], a[2], a[3], guard_x, guard_y)
        b_distance = _distance(plane, b[0], b[1], b[2], b[3], guard_x, guard_y)
        if a_distance >= 0.0:
            result[kept] = a
            kept += 1
        if (a_distance >= 0.0) != (b_distance >= 0.0):
            if a_distance >= 0.0:
                inside, outside, t = a, b, a_distance / (a_distance - b_distance)
            else:
                inside, outside, t = b, a, b_distance / (b_distance - a_distance)
            for j in range(inside.size):
                result[kept, j] = lerp(inside[j], outside[j], t)
            kept += 1
    return kept


@device
def _needs_guard(polygon, count, guard_x, guard_y):
    for i in range(count):
        w = polygon[i, 3]
        if abs(polygon[i, 0]) > guard_x * w or abs(polygon[i, 1]) > guard_y * w:
            return True
    return False


@device
def _clip_polygon(polygon, spare, guard_x, guard_y):
    """Clip the triangle in `polygon[:3]`, in place; the number of vertices left (0: nothing)."""
    count = 3
    for plane in range(_NEAR, _LEFT):
        count = _cut(plane, polygon, count, spare, guard_x, guard_y)
        polygon[:count] = spare[:count]
    if _needs_guard(polygon, count, guard_x, guard_y):
        for plane in range(_LEFT, _TOP + 1):
            count = _cut(plane, polygon, count, spare, guard_x, guard_y)
            polygon[:count] = spare[:count]
    return count


@device
def _load(clip, varyings, indices, triangle, polygon):
    for corner in range(3):
        vertex = indices[triangle, corner]
        polygon[corner, :4] = clip[vertex]
        polygon[corner, 4:] = varyings[vertex]


@kernel
def _count(clip, varyings, indices, guard_x, guard_y, counts):
    chunk = 256
    for first in prange((len(indices) + chunk - 1) // chunk):
        polygon = np.empty((_MOST, 4 + varyings.shape[1]))
        spare = np.empty_like(polygon)
        for triangle in range(first * chunk, min(len(indices), (first + 1) * chunk)):
            _load(clip, varyings, indices, triangle, polygon)
            counts[triangle] = max(0, _clip_polygon(polygon, spare, guard_x, guard_y) - 2)


@kernel
def _fill(clip, varyings, indices, guard_x, guard_y, offsets, out_clip, out_varyings, out_source):
    chunk = 256
    for first in prange((len(indices) + chunk - 1) // chunk):
        polygon = np.empty((_MOST, 4 + varyings.shape[1]))
        spare = np.empty_like(polygon)
        for triangle in range(first * chunk, min(len(indices), (first + 1) * chunk)):
            _load(clip, varyings, indices, triangle, polygon)
            count = _clip_polygon(polygon, spare, guard_x, guard_y)
            for fan in range(count - 2):
                out = offsets[triangle] + fan
                out_source[out] = triangle
                for corner in range(3):
                    vertex = 0 if corner == 0 else fan + corner
                    out_clip[out, corner] = polygon[vertex, :4]
                    out_varyings[out, corner] = polygon[vertex, 4:]


def clip_triangles(
    clip: NDArray[np.float64], varyings: NDArray[np.float64], indices: NDArray[np.int32], width: int, height: int
) -> ClippedTriangles:
    """Clip indexed triangles for a picture of `width` x `height` pixels.

    clip (V, 4), varyings (V, K), indices (T, 3); the result keeps the triangles' order.
    """
    guard_x, guard_y = _GUARD / width, _GUARD / height
    counts = np.zeros(len(indices), np.int64)
    _count(clip, varyings, indices, guard_x, guard_y, counts)
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    result = ClippedTriangles(
        np.empty((total, 3, 4)), np.empty((total, 3, varyings.shape[1])), np.empty(total, np.int32)
    )
    _fill(clip, varyings, indices, guard_x, guard_y, ends - counts, *result)
    return result
