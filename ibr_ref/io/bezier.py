"""Bicubic Bézier patches as triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats


def tessellate(patches: Floats, quads: int) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices (P (quads + 1)², 3) and triangles (2 P quads², 3) of patches with control points (P, 4, 4, 3).

    A patch is cut into quads x quads pieces, even in its parameters, and each piece from corner (i, j) to (i + 1, j + 1).
    Vertices and pieces go patch by patch and row by row; i counts along the first axis of the control points. Outside,
    where triangles run counter-clockwise, is second axis x first axis, as in the teapot. Triangles without area, as where
    a border of the patch is one point, are kept.
    """
    weights = _bernstein(quads)
    rows = _mixed(weights, patches)
    points = _mixed(weights, rows.transpose(0, 2, 1, 3)).transpose(0, 2, 1, 3)
    side = quads + 1
    corner = (np.arange(quads)[:, None] * side + np.arange(quads)).reshape(-1)
    a, b, c, d = corner, corner + side, corner + side + 1, corner + 1
    pieces = np.stack([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)], axis=1)
    starts = np.arange(len(patches)) * side * side
    return points.reshape(-1, 3), (starts[:, None, None, None] + pieces).reshape(-1, 3)


def _bernstein(quads: int) -> Floats:
    """(quads + 1, 4) the cubic Bernstein polynomials at even steps; the same bits backwards."""
    t = np.arange(quads + 1.0) / quads
    s = t[::-1]
    return np.stack([s * s * s, 3.0 * (s * s * t), 3.0 * (t * t * s), t * t * t], axis=1)


def _mixed(weights: Floats, points: Floats) -> Floats:
    """(P, quads + 1, n, 3) the points (P, 4, n, 3) weighted along their second axis.

    Outer and inner pairs are summed first: a curve has the same bits in both directions, so that patches that share a
    border meet without a gap, whichever way they run along it.
    """
    w0, w1, w2, w3 = weights.T[:, None, :, None, None]
    p0, p1, p2, p3 = points.transpose(1, 0, 2, 3)[:, :, None]
    mixed: Floats = (w0 * p0 + w3 * p3) + (w1 * p1 + w2 * p2)
    return mixed
