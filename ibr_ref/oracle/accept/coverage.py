"""Which triangles cover a pixel's centre, for certain or perhaps.

A corner that the device snaps elsewhere moves an edge function E(c) = (b - a) x (c - a). E is affine in each corner: moving
a by at most d_a and b by at most d_b along each axis changes it by at most d_a |c - b|_1 + d_b |c - a|_1 + 2 d_a d_b.

The weights of a point p are affine in p, and p = sum w_i c_i. With corners c_i + d_i the weights w' of p fulfil
p - sum w'_i d_i = sum w'_i c_i: they are the weights that the unmoved triangle has at a point moved by at most
sum |w'_i| |d_i|. So they differ by at most the gradient of the weights times that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded

RASTER = 256.0
"""Subpixels of the reference."""


@dataclass(frozen=True, eq=False)
class Fragments:
    """Pixels that triangles may cover, one triangle after the other in their order."""

    triangle: Ints
    """(n,) growing."""
    rows: Ints
    columns: Ints
    turned: Bools
    """Its triangle's area is negative: its corners run counterclockwise on the screen."""
    inside: Bools
    """(n, 3) the pixel is certainly inside edge i, the one opposite corner i."""
    certain: Bools
    """(n,) every legal device covers the pixel."""
    weights: Floats
    """(n, 3) E_i / (E_0 + E_1 + E_2) of the snapped triangle, as the reference has them (beyond an edge: extrapolated)."""
    error: Floats
    """(n,) by how much a legal device's weights may differ, each; inf for a triangle that may have no area."""
    moved: Floats
    """(n,) how far, along each axis, the point that a device's weights belong to may lie from the pixel's centre."""


@dataclass(frozen=True, eq=False)
class Corners:
    """Triangles on the raster, (T, 3) each, turned so that their areas are >= 0."""

    x: Floats
    y: Floats
    off: Floats
    """How far a legal device's corner may lie from here, along each axis."""
    varying_x: Floats
    """Of the corners that varyings are interpolated between, and how far those may lie elsewhere."""
    varying_y: Floats
    varying_off: Floats
    area: Floats
    """(T,) twice the area."""
    turned: Bools
    """(T,) whether corners 1 and 2 are exchanged."""

    def edge(self, i: int) -> tuple[int, int]:
        """The corners of the edge opposite corner i."""
        return (i + 1) % 3, (i + 2) % 3


def snapped(x: Bounded) -> tuple[Floats, Floats]:
    """Where the reference snaps window coordinates, and how far a legal device's may lie from there: 0 or one step.

    With the nearest, ties to even, the outcome is certain unless a tie lies within the coordinate's error; where any
    rounding is legal, unless the coordinate lies on the raster exactly. Coarser rasters move by up to their own step.
    """
    device = x.device
    steps = RASTER * x.value
    reference = np.rint(steps)
    if device.subpixel_any or device.subpixel_bits != 8:
        on_raster = (steps == reference) & (x.error == 0.0) & (device.subpixel_bits >= 8)
        return reference / RASTER, np.where(on_raster, 0.0, max(2.0**-device.subpixel_bits, 1.0 / RASTER) + x.error)
    # From steps = reference + d a coordinate that is off by e steps goes no farther than floor(|d| + e + 1/2).
    off = np.floor(np.abs(steps - reference) + RASTER * x.error + 0.5)
    return reference / RASTER, np.where(x.error > 0.0, off, 0.0) / RASTER


def twice_area(x: Floats, y: Floats) -> Floats:
    """(T,) of triangles with corners (T, 3), negative of those that are turned."""
    return np.asarray((x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (y[:, 1] - y[:, 0]) * (x[:, 2] - x[:, 0]))


def of_varyings(x: Bounded) -> tuple[Floats, Floats]:
    """The same of what varyings are interpolated over: the snapped coordinates, those before, or either of them."""
    if not x.device.snapped:
        return x.value, np.broadcast_to(x.error, x.value.shape)
    at, off = snapped(x)
    return at, np.maximum(off, np.abs(at - x.value) + x.error) if x.device.unsnapped else off


def fragments(
    x: Bounded, y: Bounded, width: int, height: int, owns_border: Callable[[int, int], bool] | None = None
) -> Fragments:
    """The pixels that each triangle with corners x, y (T, 3), in window coordinates, may cover. NaN corners: none.

    owns_border: whether the pixels on an edge (dx, dy) that is run through clockwise are covered; the top-left rule.
    """
    corners = _corners(x, y)
    triangle, rows, columns = _near(corners, width, height)
    px, py = np.asarray(columns + 0.5, np.float64), np.asarray(rows + 0.5, np.float64)
    edges, slack = _edges(corners, triangle, px, py)
    owned = np.stack([_owned(corners, *corners.edge(i), owns_border) for i in range(3)], axis=1)[triangle]
    area = corners.area[triangle]
    reference = (edges > 0.0) | ((edges == 0.0) & owned)
    inside = reference & ((slack < edges) | (slack == 0.0))
    loose = slack > 0.0
    possible = _all((-slack <= edges) & loose | reference)
    possible &= (area > 0.0) | loose[:, 0] | loose[:, 1] | loose[:, 2]
    if not x.device.snapped:
        edges = _edge_functions(corners, (corners.varying_x, corners.varying_y), triangle, px, py)
    weights, error, moved = _weights(corners, triangle, edges)
    turned = corners.turned[triangle]
    inside[turned], weights[turned] = inside[turned][:, [0, 2, 1]], weights[turned][:, [0, 2, 1]]
    certain = _all(inside) & (area > 0.0)
    return Fragments(
        triangle=triangle[possible],
        rows=rows[possible],
        columns=columns[possible],
        turned=turned[possible],
        inside=inside[possible],
        certain=certain[possible],
        weights=weights[possible],
        error=error[possible],
        moved=moved[possible],
    )


def _all(edges: Bools) -> Bools:
    """(n,) of (n, 3): column by column, as NumPy takes ten times as long for rows of three."""
    return np.asarray(edges[:, 0] & edges[:, 1] & edges[:, 2], np.bool_)


def _corners(x: Bounded, y: Bounded) -> Corners:
    (at_x, off_x), (at_y, off_y) = snapped(x), snapped(y)
    off = np.maximum(off_x, off_y)
    (over_x, over_off_x), (over_y, over_off_y) = of_varyings(x), of_varyings(y)
    area = twice_area(at_x, at_y)
    turned = area < 0.0
    order = np.where(np.asarray(turned)[:, None], [0, 2, 1], [0, 1, 2])
    places = (at_x, at_y, off, over_x, over_y, np.maximum(over_off_x, over_off_y))
    snapped_x, snapped_y, moves, *varying = (np.take_along_axis(a, order, axis=1) for a in places)
    return Corners(
        x=snapped_x,
        y=snapped_y,
        off=moves,
        varying_x=varying[0],
        varying_y=varying[1],
        varying_off=varying[2],
        area=np.abs(area),
        turned=np.asarray(turned),
    )


def _near(corners: Corners, width: int, height: int) -> tuple[Ints, Ints, Ints]:
    """Pixels that are not certainly outside: of each triangle, row by row, the columns that no edge excludes."""
    usable = np.isfinite(corners.x + corners.y).all(axis=1)
    reach = np.where(usable, corners.off.max(axis=1), 0.0)
    x, y = (np.where(np.isfinite(a), a, -1.0) for a in (corners.x, corners.y))
    (first_row, last_row), (first, last) = (
        (_clipped(np.ceil(a.min(axis=1) - reach - 0.5), n), _clipped(np.floor(a.max(axis=1) + reach - 0.5) + 1.0, n))
        for a, n in ((y, height), (x, width))
    )
    heights = np.where(usable, np.maximum(last_row - first_row, 0), 0)
    triangle, row = _runs(np.arange(len(x)), first_row, heights)
    low, high = first[triangle].astype(np.float64), last[triangle].astype(np.float64)
    size = np.ptp(x, axis=1) + np.ptp(y, axis=1) + 2.0 * (reach + 1.0)
    most = (2.0 * reach * size + 2.0 * reach**2)[triangle]  # the slack of any edge anywhere in the box
    for i in range(3):
        a, b = corners.edge(i)
        dx, dy = (x[:, b] - x[:, a])[triangle], (y[:, b] - y[:, a])[triangle]
        with np.errstate(divide="ignore", invalid="ignore"):
            # E = dx (py - y_a) - dy (px - x_a) >= -most; a pixel more on either side, for the rounding of the quotient
            limit = x[:, a][triangle] + (dx * (row + 0.5 - y[:, a][triangle]) + most) / dy
        low = np.where(dy < 0.0, np.maximum(low, np.floor(limit) - 1.0), low)
        high = np.where(dy > 0.0, np.minimum(high, np.floor(limit) + 2.0), high)
    counts = np.maximum(high - low, 0.0).astype(np.int64)
    of_row, column = _runs(np.arange(len(row)), low.astype(np.int64), counts)
    return triangle[of_row], row[of_row], column


def _clipped(index: Floats, count: int) -> Ints:
    return np.clip(index, 0.0, float(count)).astype(np.int64)


def _runs(names: Ints, first: Ints, counts: Ints) -> tuple[Ints, Ints]:
    """Each name `counts` times, with the numbers from `first` on."""
    starts = np.cumsum(counts) - counts
    index = np.arange(int(counts.sum())) - np.repeat(starts - first, counts)
    return np.repeat(names, counts), index


def _edges(corners: Corners, triangle: Ints, px: Floats, py: Floats) -> tuple[Floats, Floats]:
    """(n, 3) the edge functions, and how much moved corners change them."""
    x, y = corners.x[triangle], corners.y[triangle]
    away = np.abs(px[:, None] - x) + np.abs(py[:, None] - y)
    edges = _edge_functions(corners, (corners.x, corners.y), triangle, px, py)
    return edges, _slack(corners.off[triangle], away)


def _edge_functions(corners: Corners, places: tuple[Floats, Floats], triangle: Ints, px: Floats, py: Floats) -> Floats:
    """(n, 3) of triangles with corners at `places` (T, 3)."""
    x, y = (place[triangle] for place in places)
    edges = np.empty_like(x)
    for i in range(3):
        a, b = corners.edge(i)
        edges[:, i] = (x[:, b] - x[:, a]) * (py - y[:, a]) - (y[:, b] - y[:, a]) * (px - x[:, a])
    return edges


def _slack(off: Floats, away: Floats) -> Floats:
    slack = np.empty_like(away)
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        slack[:, i] = off[:, a] * away[:, b] + off[:, b] * away[:, a] + 2.0 * off[:, a] * off[:, b]
    return slack


def _weights(corners: Corners, triangle: Ints, edges: Floats) -> tuple[Floats, Floats, Floats]:
    """(n, 3) shares of the varyings' edge functions; (n,) by how much a legal device's may differ, and `Fragments.moved`.

    e <= G sum (|w_i| + e) off_i with the steepest gradient G of the three weights, solved for e.
    """
    x, y, off = corners.varying_x, corners.varying_y, corners.varying_off
    area = twice_area(x, y)
    reach = [abs(x[:, b] - x[:, a]) + abs(y[:, b] - y[:, a]) for a, b in map(corners.edge, range(3))]
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = edges / area[triangle, None]
        gradient = np.max(reach, axis=0) / np.abs(area)
        room = (1.0 - gradient * off.sum(axis=1))[triangle]
        terms = np.abs(weights) * off[triangle]
        moved = np.where(room > 0.0, (terms[:, 0] + terms[:, 1] + terms[:, 2]) / room, np.inf)
        moving = np.asarray(off.max(axis=1) > 0.0)[triangle]
        return weights, np.where(moving, gradient[triangle] * moved, 0.0), np.where(moving, moved, 0.0)


def _owned(corners: Corners, a: int, b: int, owns_border: Callable[[int, int], bool] | None) -> Bools:
    """(T,) whether pixels on the edge a -> b of a triangle with E > 0 inside (y downwards) belong to it."""
    dx, dy = corners.x[:, b] - corners.x[:, a], corners.y[:, b] - corners.y[:, a]
    if owns_border is not None:
        return np.array([owns_border(*way) for way in zip(np.sign(dx), np.sign(dy), strict=True)], np.bool_)
    return np.asarray(((dy == 0.0) & (dx > 0.0)) | (dy < 0.0))
