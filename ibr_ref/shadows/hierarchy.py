"""A hierarchy of boxes around triangles, and whether a segment meets any of them.

Median splits along the longest side of the centroids' box, down to leaves of two to four triangles; boxes lie as in a
heap (the children of i are 2 i + 1 and 2 i + 2), so that nothing points anywhere.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Ints, Vector3
from ibr_ref.jit import device

_SLACK = 1e-9
"""By which boxes are wider, as a share of the whole: rounding in a box's test must not lose what is in it."""

DEEPEST = 64
"""Room for the boxes that are still to be visited: one for each level, and one more."""


class Hierarchy(NamedTuple):
    """Triangles, ordered by the leaves that they are in."""

    low: Floats
    high: Floats
    """(B, 3) boxes, B = 2 L - 1 for L leaves."""
    starts: NDArray[np.int64]
    """(L + 1,) first triangle of each leaf, and their number."""
    corners: Floats
    """(T, 3, 3) corner and component of each triangle."""


def build(vertices: Floats, triangles: NDArray[np.int32]) -> Hierarchy:
    """The hierarchy of a mesh: vertices (V, 3), triangles (T, 3), T >= 1."""
    corners = vertices[triangles]
    levels = max(0, (len(corners) // 2).bit_length() - 1)
    order, starts = _sorted(corners.mean(axis=1), levels)
    corners = np.ascontiguousarray(corners[order])
    extent = corners.max(axis=(0, 1)) - corners.min(axis=(0, 1))
    slack = _SLACK * float(extent.max())
    low = [np.minimum.reduceat(corners.min(axis=1), starts[:-1]) - slack]
    high = [np.maximum.reduceat(corners.max(axis=1), starts[:-1]) + slack]
    for _ in range(levels):
        low.insert(0, np.minimum(low[0][::2], low[0][1::2]))
        high.insert(0, np.maximum(high[0][::2], high[0][1::2]))
    return Hierarchy(np.concatenate(low), np.concatenate(high), starts, corners)


def _sorted(centroids: Floats, levels: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The triangles' order, and where each of the 2^levels leaves begins in it."""
    order = np.arange(len(centroids))
    starts = np.array([0, len(centroids)])
    for _ in range(levels):
        for first, stop in pairwise(starts.tolist()):
            here = centroids[order[first:stop]]
            axis = int(np.argmax(here.max(axis=0) - here.min(axis=0)))
            order[first:stop] = order[first:stop][np.argsort(here[:, axis], kind="stable")]
        middles = (starts[:-1] + starts[1:]) // 2
        starts = np.sort(np.concatenate([starts, middles]))
    return order, starts


@device
def _meets_box(hierarchy: Hierarchy, i: int, origin: Vector3, inverse: Vector3) -> bool:
    """Whether a segment o + t d, t from 0 to 1, meets a box; where 0 inf = NaN says nothing, it does. inverse: 1 / d."""
    near, far = 0.0, 1.0
    for k in range(3):
        a = (hierarchy.low[i, k] - origin[k]) * inverse[k]
        b = (hierarchy.high[i, k] - origin[k]) * inverse[k]
        if inverse[k] < 0.0:
            a, b = b, a
        near = a if a > near else near
        far = b if b < far else far
    return near <= far


@device
def _meets_triangle(corners: Floats, origin: Vector3, direction: Vector3) -> bool:
    """Whether a segment meets a triangle (3, 3), its edges included (Moller & Trumbore 1997)."""
    dx, dy, dz = direction
    ux, uy, uz = corners[1, 0] - corners[0, 0], corners[1, 1] - corners[0, 1], corners[1, 2] - corners[0, 2]
    vx, vy, vz = corners[2, 0] - corners[0, 0], corners[2, 1] - corners[0, 1], corners[2, 2] - corners[0, 2]
    sx, sy, sz = origin[0] - corners[0, 0], origin[1] - corners[0, 1], origin[2] - corners[0, 2]
    px, py, pz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
    determinant = ux * px + uy * py + uz * pz
    if determinant == 0.0:
        return False
    beta = (sx * px + sy * py + sz * pz) / determinant
    qx, qy, qz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
    gamma = (dx * qx + dy * qy + dz * qz) / determinant
    t = (vx * qx + vy * qy + vz * qz) / determinant
    return (beta >= 0.0) & (gamma >= 0.0) & (beta + gamma <= 1.0) & (t > 0.0) & (t < 1.0)


@device
def meets(hierarchy: Hierarchy, origin: Vector3, direction: Vector3, waiting: Ints) -> bool:
    """Whether a segment o + t d, 0 < t < 1, meets any triangle. waiting (DEEPEST,): room for boxes."""
    inverse = 1.0 / direction[0], 1.0 / direction[1], 1.0 / direction[2]
    inner = len(hierarchy.low) - len(hierarchy.starts) + 1
    waiting[0] = 0
    count = 1
    while count > 0:
        count -= 1
        i = waiting[count]
        if not _meets_box(hierarchy, i, origin, inverse):
            continue
        if i < inner:
            waiting[count] = 2 * i + 2
            waiting[count + 1] = 2 * i + 1
            count += 2
            continue
        for t in range(hierarchy.starts[i - inner], hierarchy.starts[i - inner + 1]):
            if _meets_triangle(hierarchy.corners[t], origin, direction):
                return True
    return False
