"""Where a light must not be: inside a mesh, or on one of its triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_TOUCHES = 1e-9
"""Distance from a triangle, as a share of its size, that counts as on it: rounding of its corners."""


def _corners(vertices: Array, triangles: NDArray[np.int32], point: Array) -> Array:
    """(3, T, 3) corners seen from the point."""
    return np.moveaxis(vertices[triangles] - point, 1, 0)


def _outside_box(vertices: Array, point: Array) -> bool:
    slack = _TOUCHES * float(np.ptp(vertices, axis=0).max())
    return bool((point < vertices.min(axis=0) - slack).any() or (point > vertices.max(axis=0) + slack).any())


def touched(vertices: Array, triangles: NDArray[np.int32], point: Array) -> int | None:
    """Index of the first triangle that a point lies on, if any; triangles without an area have no points."""
    if _outside_box(vertices, point):
        return None
    a, b, c = _corners(vertices, triangles, point)
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    size = np.sqrt(np.maximum(((b - a) ** 2).sum(axis=1), ((c - a) ** 2).sum(axis=1)))
    flat = np.abs((normal * a).sum(axis=1)) <= _TOUCHES * area * size
    inside = [(np.cross(p, q) * normal).sum(axis=1) >= -_TOUCHES * area * area for p, q in ((a, b), (b, c), (c, a))]
    on = np.flatnonzero((area > 0.0) & flat & inside[0] & inside[1] & inside[2])
    return int(on[0]) if len(on) else None


def contains(vertices: Array, triangles: NDArray[np.int32], point: Array) -> bool:
    """Whether a mesh surrounds a point: the solid angle that it covers there is more than half of the sphere.

    So a closed mesh contains its inside, however it is oriented; an open one what lies well behind its surface.
    """
    if _outside_box(vertices, point):
        return False
    a, b, c = _corners(vertices, triangles, point)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    above = (a * np.cross(b, c)).sum(axis=1)
    below = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    turns = float(np.arctan2(above, below).sum()) / (2.0 * np.pi)
    return abs(turns) > 0.5 + 1e-6
