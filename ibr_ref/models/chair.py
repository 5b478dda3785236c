"""A chair of 1,464 triangles, as many as the polygons of the chair in Kang & Ihm's tables."""

from __future__ import annotations

import numpy as np

from ibr_ref.models.loft import capped, joined, turn
from ibr_ref.models.sweep import spline, straight, tube
from ibr_ref.scene import Mesh

Point = tuple[float, float, float]

_WOOD, _DARK, _SEAT = (0.60, 0.36, 0.17), (0.36, 0.19, 0.08), (0.70, 0.46, 0.24)

_LEG_SHARES = (0.0, 0.25, 0.30, 0.36, 0.55, 0.80, 0.86, 1.0)
_LEG_RADII = (0.020, 0.024, 0.017, 0.025, 0.027, 0.018, 0.022, 0.014)
"""From the seat to the floor, as a lathe turns it."""
_SIDES = 8


def chair() -> Mesh:
    """A chair on the plane z = 0, its back towards -x: about 0.5 wide and long, 1.0 high; 1,464 triangles.

    Four turned legs with three stretchers, a dished seat, two posts and four spindles under a bowed rail.
    """
    feet = {(x, y): _foot(x, y) for x in (-1, 1) for y in (-1, 1)}
    legs = [_rod(top, foot, _LEG_SHARES, _LEG_RADII, _WOOD) for top, foot in feet.values()]
    return joined([_seat(), *legs, *_stretchers(), *_back(), _rail()])


def _foot(x: int, y: int) -> tuple[Point, Point]:
    """A leg's upper and lower end, at one corner: front or back, right or left."""
    return (0.165 * x, 0.165 * y, 0.445), (0.215 * x, 0.205 * y, 0.0021)


def _rod(start: Point, end: Point, shares: tuple[float, ...], radii: tuple[float, ...], color: Point) -> Mesh:
    """A turned rod of 16 triangles a share."""
    path = straight(start, end, shares)
    # Nothing here runs along this direction.
    return capped(tube(path, radii, (0.6, 0.64, 0.48), _SIDES), start, end, color)


def _seat() -> Mesh:
    """360 triangles: rings of the curve x⁴ + y⁴ = 1, wider in front, dished on top."""
    x, y = turn(36).T
    square = np.stack([x, y]) / np.sqrt(np.sqrt(x * x * x * x + y * y * y * y))
    scales = np.array([0.90, 1.00, 1.00, 0.93, 0.45])[:, None]
    heights = np.array([0.430, 0.440, 0.462, 0.472, 0.460])[:, None]
    forward = 0.225 * scales * square[0]
    sideways = (0.215 + 0.12 * forward) * scales * square[1]
    rings = np.stack([forward, sideways, heights + 0.0 * forward], axis=2)
    return capped(rings, (0.0, 0.0, 0.430), (0.0, 0.0, 0.457), [_DARK, _WOOD, _WOOD, _SEAT, _SEAT])


def _stretchers() -> list[Mesh]:
    """144 triangles: one on either side, from leg to leg, and one between their middles."""
    share = 0.62
    at = {(x, y): tuple(straight(*_foot(x, y), [share])[0].tolist()) for x in (-1, 1) for y in (-1, 1)}
    middle = {y: tuple(straight(at[-1, y], at[1, y], [0.5])[0].tolist()) for y in (-1, 1)}
    ends = [(at[-1, -1], at[1, -1]), (at[-1, 1], at[1, 1]), (middle[-1], middle[1])]
    return [_rod(start, end, (0.0, 0.5, 1.0), (0.011, 0.017, 0.011), _WOOD) for start, end in ends]


def _back() -> list[Mesh]:
    """352 triangles: posts of five rings, spindles of three."""
    posts = [
        _rod((-0.185, 0.165 * y, 0.45), (-0.295, 0.205 * y, 0.98), (0.0, 0.15, 0.45, 0.8, 1.0),
             (0.017, 0.022, 0.018, 0.021, 0.015), _WOOD)
        for y in (-1, 1)
    ]  # fmt: skip
    spindles = [
        _rod((-0.192, 0.066 * k, 0.455), (-0.29 - 0.004 * (6.25 - k * k), 0.082 * k, 0.91), (0.0, 0.5, 1.0),
             (0.008, 0.012, 0.008), _SEAT)
        for k in (-1.5, -0.5, 0.5, 1.5)
    ]  # fmt: skip
    return posts + spindles


def _rail() -> Mesh:
    """96 triangles: bowed backwards, high in the middle."""
    knots = [(-0.272, -0.235, 0.895), (-0.305, -0.10, 0.925), (-0.305, 0.10, 0.925), (-0.272, 0.235, 0.895)]
    path = spline(knots, 6)
    radii = np.array([(0.035, 0.012), (0.052, 0.014), (0.062, 0.014), (0.062, 0.014), (0.052, 0.014), (0.035, 0.012)])
    return capped(tube(path, radii, (-0.97, 0.0, 0.2), _SIDES), path[0], path[-1], _WOOD)
