"""Rings along paths: what handles, legs and necks are made of."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.models.loft import turn


def spline(knots: ArrayLike, count: int) -> Floats:
    """(count, K) points of the Catmull-Rom curve through the knots (P, K), from the first to the last.

    The points are even in the parameter, of which every span between two knots has as much.
    """
    points = np.asarray(knots, np.float64)
    padded = np.concatenate([[2.0 * points[0] - points[1]], points, [2.0 * points[-1] - points[-2]]])
    t = np.arange(count) * (len(points) - 1.0) / (count - 1.0)
    span = np.minimum(t.astype(np.int64), len(points) - 2)
    f = (t - span)[:, None]
    before, here, then, after = (padded[span + k] for k in range(4))
    slope_here, slope_then = (then - before) / 2.0, (after - here) / 2.0
    rise = then - here
    square, cube = f * f, f * f * f
    curve: Floats = here + slope_here * (f - 2.0 * square + cube)
    curve += rise * (3.0 * square - 2.0 * cube) + slope_then * (cube - square)
    return curve


def ellipses(centers: Floats, first: Floats, second: Floats, sides: int) -> Floats:
    """(S, sides, 3) rings centers + cos first + sin second, each (S, 3); first x second points to where the rings go."""
    cosine, sine = turn(sides).T[:, None, :, None]
    rings: Floats = centers[:, None, :] + cosine * first[:, None, :] + sine * second[:, None, :]
    return rings


def tube(path: Floats, radii: ArrayLike, across: ArrayLike, sides: int) -> Floats:
    """(S, sides, 3) rings about a path (S, 3), square to it.

    radii: (S,), or (S, 2): along `across` x path, and along what is square to both. across: a direction that the path
    never takes.
    """
    along = unit(
        path[np.minimum(np.arange(len(path)) + 1, len(path) - 1)] - path[np.maximum(np.arange(len(path)) - 1, 0)]
    )
    first = unit(cross(np.broadcast_to(np.asarray(across, np.float64), path.shape), along))
    second = cross(along, first)
    wide, high = np.broadcast_to(np.asarray(radii, np.float64).T, (2, len(path)))[:, :, None]
    return ellipses(path, wide * first, high * second, sides)


def straight(start: ArrayLike, end: ArrayLike, shares: ArrayLike) -> Floats:
    """(S, 3) points from start (share 0) to end (share 1)."""
    share = np.asarray(shares, np.float64)[:, None]
    return np.asarray(start) * (1.0 - share) + np.asarray(end) * share


def cross(a: Floats, b: Floats) -> Floats:
    """The cross products of the rows of two arrays (S, 3)."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)


def unit(a: Floats) -> Floats:
    """The rows (S, 3), none of them zero, divided by their lengths."""
    x, y, z = a.T
    length: Floats = np.sqrt(x * x + y * y + z * z)
    return a / length[:, None]
