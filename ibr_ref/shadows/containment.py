"""Where a light must not be: inside a mesh, or on one of its triangles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats

_TOUCHES = 1e-9
"""Distance from a triangle, as a share of its size, that counts as on it: rounding of its corners."""


class Solid(NamedTuple):
    """A mesh in world space, and the box around it."""

    vertices: Floats
    """(V, 3)."""
    triangles: NDArray[np.int32]
    """(T, 3)."""
    low: Floats
    high: Floats
    """(3,) each, with room for rounding."""


def solid(vertices: Floats, triangles: NDArray[np.int32]) -> Solid:
    """A mesh to ask `touched` and `contains` about."""
    corners = vertices[np.unique(triangles)]
    low, high = corners.min(axis=0), corners.max(axis=0)
    slack = _TOUCHES * float((high - low).max())
    return Solid(vertices, triangles, low - slack, high + slack)


def _in_box(mesh: Solid, point: Floats) -> bool:
    return bool(((mesh.low <= point) & (point <= mesh.high)).all())


def _corners(mesh: Solid, point: Floats) -> Floats:
    """(3, T, 3) corners seen from the point."""
    return np.moveaxis(mesh.vertices[mesh.triangles] - point, 1, 0)


def touched(mesh: Solid, point: Floats) -> int | None:
    """Index of the first triangle that a point lies on, if any; triangles without an area have no points."""
    if not _in_box(mesh, point):
        return None
    a, b, c = _corners(mesh, point)
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    size = np.sqrt(np.maximum(((b - a) ** 2).sum(axis=1), ((c - a) ** 2).sum(axis=1)))
    flat = np.abs((normal * a).sum(axis=1)) <= _TOUCHES * area * size
    inside = [(np.cross(p, q) * normal).sum(axis=1) >= -_TOUCHES * area * area for p, q in ((a, b), (b, c), (c, a))]
    on = np.flatnonzero((area > 0.0) & flat & inside[0] & inside[1] & inside[2])
    return int(on[0]) if len(on) else None


def contains(mesh: Solid, point: Floats) -> bool:
    """Whether a mesh surrounds a point: the solid angle that it covers there is more than half of the sphere.

    So a closed mesh contains its inside, however it is oriented; an open one what lies well behind its surface.
    """
    if not _in_box(mesh, point):
        return False
    a, b, c = _corners(mesh, point)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    above = (a * np.cross(b, c)).sum(axis=1)
    below = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    turns = float(np.arctan2(above, below).sum()) / (2.0 * np.pi)
    return abs(turns) > 0.5 + 1e-6
