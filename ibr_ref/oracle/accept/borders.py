"""Polygons that a device may cut at the picture's borders, |x| <= w and |y| <= w: what is left may be slivers.

The view volumes of OpenGL, Vulkan and WebGPU end there. A device that clips has the polygon's part within the picture, of
which the corners are known, and triangulates it: any triangle of three of them may be a piece, as no standard says which.

**Planes.** A varying (over w) is the same affine function over every piece, so exact arithmetic gives the same. But it is
set up from the piece's corners, in floats: q + (dq/dx) x + (dq/dy) y with gradients sum q_i (dy, dx) / area. So the weight
of corner i is off by `ROUNDINGS` of its terms (|dx| Y + |dy| X) / area, with dx, dy of the edge opposite to it, and X, Y the
way from the picture's corner to the plane's anchor and on to the pixel: little for a wide triangle, and any number for a
piece without an area.

**Values.** A plane is anchored at a corner, a, and made of differences from its value: with weights that are off by e_i a
varying is off by sum e_i |f_i - f_a|. Where the polygon is cut its corners are sums p (1 - t) + q t: `CROSSING` roundings of
each of the terms. An error of t itself moves the corner along its edge, with all that is interpolated: nothing changes but
where the polygon ends, beside the picture.

**Places.** Corners of a piece are snapped, as any. A pixel within the snapped piece has weights of 0 to 1 there, which add
up to 1: the point that they belong to is off by no more than a corner is. Where varyings are interpolated over unsnapped
corners alone, those are off by their arithmetic only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.device import Device

ROUNDINGS = 9.0
"""Of a term of a plane, besides a quotient: a difference of corners, one of values, their product, the sum of two, the
area's product and its sum, a product with the position, and two sums."""
CROSSING = 5.0
"""Of a (1 - t) + b t: 1 - t, two products, a sum; one of the result."""
SIDES = ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0))
"""Axis and sign of w + sign x >= 0."""


@dataclass(frozen=True, eq=False)
class Cut:
    """The corners (k,) of a polygon's part within the picture, in the window."""

    x: Floats
    y: Floats
    off: Floats
    """How far a device's corner may lie from here along each axis, before it is snapped."""
    crossings: int
    """The most cuts that a corner is made by."""
    size: tuple[int, int]
    """Of the picture, in pixels."""

    @property
    def moved(self) -> float:
        """By how much, along each axis, a corner may be elsewhere, in pixels."""
        return float(self.off.max(initial=0.0))

    def pieces(self, corners: tuple[Floats, Floats], px: Floats, py: Floats, device: Device) -> Iterator[Piece]:
        """Those that may cover points (n,); corners x, y (3,): of a triangle of the polygon."""
        shares = weights(*corners, self.x, self.y)
        units = (ROUNDINGS * device.operation + device.quotient) * UNIT
        crossing = self.crossings * CROSSING * device.operation * UNIT
        for piece in map(list, combinations(range(len(self.x)), 3)):
            x, y, off = self.x[piece], self.y[piece], self.off[piece]
            here = np.flatnonzero(_within(x, y, off + 2.0**-device.subpixel_bits, px, py))
            reach = off + device.varying_step
            if not len(here):
                continue
            dx, dy = (np.abs(np.roll(a, -2) - np.roll(a, -1)) for a in (x, y))
            area = abs((x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]))
            room = float(area - reach @ (dx + dy) - 2.0 * reach.sum() ** 2)
            # From the picture's corner to the anchor, and from there to the pixel; rows may be counted from below.
            across = px[here] + x.max()
            down = np.maximum(py[here] + y.max(), 2.0 * self.size[1] - py[here] - y.min())
            terms = np.multiply.outer(across, dy) + np.multiply.outer(down, dx)
            beyond = float(reach.max() * (dx + dy).sum())
            yield Piece(
                points=here,
                rounding=units * terms / room if room > 0.0 else np.full(terms.shape, np.inf),
                shares=shares[piece],
                crossing=crossing,
                moved=float(reach.max() + 2.0 * off.max() * (beyond / room if room > 0.0 else np.inf)),
            )


def cut(clip: Floats, error: Floats, size: tuple[int, int], device: Device) -> Cut | None:
    """Cut a polygon, corners (m, 4) in clip space with their errors; None: it lies within the picture, or beside it."""
    if not np.isfinite(clip).all() or not (clip[:, 3] > 0.0).all():
        return None
    if not (np.abs(clip[:, :2]) > clip[:, 3:]).any():
        return None
    polygon = [(*corner, 0) for corner in zip(clip, error, strict=True)]
    unit = device.operation * UNIT
    for axis, sign in SIDES:
        distance = [c[3] + sign * c[axis] for c, _, _ in polygon]
        kept: list[tuple[Floats, Floats, int]] = []
        for i, (here, there) in enumerate(zip(polygon, [*polygon[1:], *polygon[:1]], strict=True)):
            d, e = distance[i], distance[(i + 1) % len(polygon)]
            if d >= 0.0:
                kept.append(here)
            if (d >= 0.0) != (e >= 0.0):
                t = d / (d - e)
                terms = (1.0 - t) * np.abs(here[0]) + t * np.abs(there[0])
                off = (1.0 - t) * here[1] + t * there[1] + CROSSING * unit * terms
                kept.append(((1.0 - t) * here[0] + t * there[0], off, max(here[2], there[2]) + 1))
        polygon = kept
    if len(polygon) < 3:
        return None
    corners, errors = (np.stack([c[k] for c in polygon]) for k in (0, 1))
    w = corners[:, 3]
    half = np.asarray(size) / 2.0
    ndc = corners[:, :2] / w[:, None]
    slack = (errors[:, :2] + np.abs(ndc) * errors[:, 3:]) / w[:, None] + (
        device.quotient + 3.0 * device.operation
    ) * UNIT
    return Cut(
        x=(ndc[:, 0] + 1.0) * half[0],
        y=(1.0 - ndc[:, 1]) * half[1],
        off=(slack * half).max(axis=1),
        crossings=max(c[2] for c in polygon),
        size=size,
    )


@dataclass(frozen=True, eq=False)
class Piece:
    """A triangle of three of the corners that may cover some of the points."""

    points: Ints
    """(n,) which."""
    rounding: Floats
    """(n, 3) of its corners' weights; infinite where it may have no area."""
    shares: Floats
    """(3, 3) of the corners of the whole triangle at its own."""
    moved: float | Floats
    """How far, along each axis, the point that a device's weights belong to may lie from the pixel's centre; or (n,)."""
    crossing: float = 0.0
    """Roundings of its corners' values, relative to the terms of their sums."""
    own: Floats | None = None
    """(n, 3) what its corners' values are off by, relative to them, each by the share that it has at the points."""
    anchors: tuple[int, ...] = (0, 1, 2)
    """The corners at which a plane may be anchored."""

    def off(self, corner: Floats) -> Floats:
        """(n, ...) of an affine function by its values (3, ...) at the corners of the whole triangle, by a plane."""
        f = np.tensordot(self.shares, corner, 1)
        anchored = [_sum(self.rounding, np.abs(f - f[a])) for a in self.anchors]
        terms = np.tensordot(np.abs(self.shares), np.abs(corner), 1).max(axis=0)
        off = np.maximum.reduce(anchored) + self.crossing * terms
        return np.asarray(off if self.own is None else off + _sum(self.own, np.abs(f)))


def _sum(rounding: Floats, apart: Floats) -> Floats:
    """(n, ...) of (n, 3) and (3, ...): what does not differ is not off, whatever the rounding."""
    with np.errstate(invalid="ignore"):
        each = rounding.reshape(-1, 3, *[1] * (apart.ndim - 1)) * apart
    return np.asarray(np.where(apart > 0.0, each, 0.0).sum(axis=1))


def weights(x: Floats, y: Floats, at_x: Floats, at_y: Floats) -> Floats:
    """(k, 3) shares of the corners x, y (3,) of a triangle at points (k,); NaN without an area."""
    dx, dy = np.roll(x, -2) - np.roll(x, -1), np.roll(y, -2) - np.roll(y, -1)
    start_x, start_y = np.roll(x, -1), np.roll(y, -1)
    edges = dx * (at_y[:, None] - start_y) - dy * (at_x[:, None] - start_x)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(edges / (dx[1] * dy[2] - dx[2] * dy[1]))


def _within(x: Floats, y: Floats, off: Floats, px: Floats, py: Floats) -> Bools:
    """(n,) whether a triangle with corners that may be `off` (3,) elsewhere along each axis may cover the points."""
    away = [np.abs(px - x[i]) + np.abs(py - y[i]) for i in range(3)]
    sign = np.sign((x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0])) or 1.0
    result = np.ones(len(px), np.bool_)
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        edge = sign * ((x[b] - x[a]) * (py - y[a]) - (y[b] - y[a]) * (px - x[a]))
        result &= edge >= -(off[a] * away[b] + off[b] * away[a] + 2.0 * off[a] * off[b])
    return result
