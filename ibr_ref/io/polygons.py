"""Polygons, strips and fans as triangles that cover the same points."""

from __future__ import annotations

from bisect import bisect

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Ints
from ibr_ref.scene import checks

_FLAT = 1e-12
"""Distance from a line, in extents of a polygon, that is rounding."""
_ROUNDED = 1e-13
"""Of a sum, as a share of what was summed."""
_ROUNDS = 8
"""Spikes on spikes on spikes."""
_NO_NORMAL = 1e-9
"""Length of a polygon's normal, as a share of those of its triangles, that is rounding."""
_MOST_TO_CUT = 2**16
"""Corners of a polygon that is no fan: cutting takes up to the square of their number."""


def triangulated(vertices: Floats, corners: Ints, counts: Ints) -> Ints:
    """Triangles (T, 3) of polygons: vertices (V, 3), all corners one after the other, and how many each polygon has, >= 3.

    A polygon is cut into a fan from its first corner where that covers it once, as with all convex ones, and by ear
    clipping (mapbox_earcut) else; both in the plane of two axes that it is seen largest in. Either way n corners make n - 2
    triangles with all its edges, wound as it is, in the order of the file.

    Raises ValueError for corners that do not exist, vertices that are not finite, and polygons that cross themselves.
    """
    check_corners(corners, len(vertices))
    checks.finite_rows("vertices", vertices)
    firsts, sizes = np.cumsum(counts) - counts, counts - 2
    places = np.cumsum(sizes) - sizes
    triangles = np.empty((int(sizes.sum()), 3), np.int64)
    for count in np.unique(counts).tolist():
        which = np.flatnonzero(counts == count)
        polygons = corners[firsts[which][:, None] + np.arange(count)]
        into = places[which][:, None] + np.arange(count - 2)
        triangles[into] = np.stack(
            [np.broadcast_to(polygons[:, :1], into.shape), polygons[:, 1:-1], polygons[:, 2:]], axis=2
        )
        if count == 3:
            continue
        flat = _seen_largest(vertices[polygons])
        for k in np.flatnonzero(~_is_fan(flat)).tolist():
            triangles[into[k]] = polygons[k][_cut(flat[k], f"polygon {which[k] + 1} of the file")]
    return triangles


def check_corners(corners: Ints, count: int) -> None:
    """Raise ValueError for corners that are none of `count` vertices."""
    bad = corners[(corners < 0) | (corners >= count)]
    if len(bad):
        raise checks.reject("triangles", int(bad[0]), f"indices from 0 to {count - 1}")


def strip(corners: Ints) -> Ints:
    """Triangles (n - 2, 3) of a strip of n corners, all wound as the first."""
    i = np.arange(max(len(corners) - 2, 0))
    triangles: Ints = corners[np.stack([i, i + 1 + i % 2, i + 2 - i % 2], axis=1)]
    return triangles


def fan(corners: Ints) -> Ints:
    """Triangles (n - 2, 3) of a fan of n corners around the first, in glTF's order."""
    i = np.arange(max(len(corners) - 2, 0))
    triangles: Ints = corners[np.stack([i + 1, i + 2, 0 * i], axis=1)]
    return triangles


def _seen_largest(corners: Floats) -> Floats:
    """(m, n, 2) polygons (m, n, 3) without the axis that their normals are longest on, wound counter-clockwise.

    Relative to their first corners and scaled to an extent of about 1, by powers of two.
    """
    scaled = _scaled(corners)
    scaled = _scaled(scaled - scaled[:, :1])
    crossed = np.cross(scaled[:, 1:-1], scaled[:, 2:])
    normals = crossed.sum(axis=1)
    # A bow tie has no normal, yet a plane.
    axis = np.argmax(np.abs(normals) + _NO_NORMAL * np.abs(crossed).sum(axis=1), axis=1)
    mirrored = np.take_along_axis(normals, axis[:, None], axis=1)[:, 0] < 0.0
    first, second = (axis + 1 + mirrored) % 3, (axis + 2 - mirrored) % 3
    return np.stack([np.take_along_axis(scaled, a[:, None, None], axis=2)[..., 0] for a in (first, second)], axis=2)


def _scaled(corners: Floats) -> Floats:
    exponents = np.frexp(np.abs(corners).max(axis=(1, 2)))[1]
    scaled: Floats = np.ldexp(corners, -exponents[:, None, None])
    return scaled


def _is_fan(flat: Floats) -> NDArray[np.bool_]:
    """(m,) whether the fan from the first corner covers nothing outside a polygon and nothing twice.

    Its triangles are then all wound alike, and the angles at the first corner no more than a whole turn in all.
    """
    before, after = flat[:, 1:-1], flat[:, 2:]
    angles = np.arctan2(np.maximum(_crossed(before, after), 0.0), (before * after).sum(axis=2))
    result: NDArray[np.bool_] = (_heights(before, after) >= -_FLAT).all(axis=1) & (
        angles.sum(axis=1) < 2.0 * np.pi + 1e-9
    )
    return result


def _cut(flat: Floats, name: str) -> Ints:
    """(n - 2, 3) corners of the triangles of a simple polygon (n, 2).

    Triangles that are all wound as the polygon, with its area in all, cover each point as often as it goes around it.
    """
    import mapbox_earcut

    count = len(flat)
    if count > _MOST_TO_CUT:
        raise ValueError(f"found {count} corners in {name}, which is no fan, allowed: up to {_MOST_TO_CUT}")
    ends = np.array([count], np.uint32)
    cut = mapbox_earcut.triangulate_float64(np.ascontiguousarray(flat), ends).reshape(-1, 3).astype(np.int64)
    if _crossed(*_edges(flat, cut)).sum() < 0.0:
        cut = cut[:, ::-1]
    areas, terms = _crossed(*_edges(flat, cut)), flat[:-1] * flat[1:, ::-1]  # the first corner is 0
    wanted, rounding = (terms[:, 0] - terms[:, 1]).sum(), _ROUNDED * (np.abs(terms).sum() + np.abs(areas).sum())
    if len(cut) and (_heights(*_edges(flat, cut)) >= -_FLAT).all() and abs(areas.sum() - wanted) <= rounding:
        cut = _with_all_corners(flat, cut)
        if len(cut) == count - 2:
            return cut
    raise ValueError(f"found {name}, of {count} corners, which crosses itself, allowed: polygons that do not")


def _edges(flat: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """(t, 2) twice: the edges of triangles (t, 3) of points (n, 2) from their first corners."""
    a, b, c = np.moveaxis(flat[triangles], 1, 0)
    return b - a, c - a


def _crossed(first: Floats, second: Floats) -> Floats:
    """Twice the signed areas between edges (..., 2)."""
    areas: Floats = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return areas


def _heights(first: Floats, second: Floats) -> Floats:
    """About the signed heights of triangles with edges (..., 2) of one corner: 0 for those without an extent."""
    lengths = np.abs(first).sum(axis=-1) + np.abs(second).sum(axis=-1)
    heights: Floats = _crossed(first, second) / np.where(lengths > 0.0, lengths, 1.0)
    return heights


def _with_all_corners(flat: Floats, cut: Ints) -> Ints:
    """The same with the corners that ear clipping leaves out: in the plane they bend nothing, or end a spike.

    In space they may, and neighbours have edges there. Each splits the triangle on whose edge it lies, or makes one of its
    own, without an area in the plane.
    """
    triangles: dict[int, list[int]] = {}
    on_edge: dict[tuple[int, int], tuple[int, int]] = {}
    """The triangle on an edge, and its third corner."""

    def put(index: int, triangle: list[int]) -> None:
        triangles[index] = triangle
        for k in range(3):
            on_edge[triangle[k - 2], triangle[k - 1]] = index, triangle[k]

    for index, triangle in enumerate(cut.tolist()):
        put(index, triangle)
    kept = np.unique(cut).tolist()
    waiting = sorted(set(range(len(flat))) - set(kept))
    for _ in range(_ROUNDS):
        missing, waiting = waiting, []
        for corner in missing:
            place = bisect(kept, corner)
            start, end = kept[place - 1], kept[place % len(kept)]
            index, third = on_edge.get((start, end), (0, start))
            halves = [[start, corner, third], [corner, end, third]]
            if third == start or (_heights(*_edges(flat, np.array(halves))) < -_FLAT).any():
                index, halves = len(triangles), [[start, corner, end]]
                if abs(_heights(*_edges(flat, np.array(halves)))[0]) > _FLAT:
                    waiting.append(corner)  # the foot of its spike comes first
                    continue
            kept.insert(place, corner)
            for offset, half in enumerate(halves):
                put(len(triangles) if offset else index, half)
    return np.array(list(triangles.values()), np.int64)
