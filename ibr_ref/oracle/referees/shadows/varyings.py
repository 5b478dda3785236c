"""What is interpolated over triangles, with its bounds, whichever way a device does it.

**Moved corners.** A device that has corner i at a_i + d_i gives a pixel at p what the unmoved triangle has at
p - sum l_i d_i, exactly, with l its own barycentrics of p. So an affine function moves by its gradient times that, and the
quotient u = N / D of two of them by |grad N - u grad D| over what D may shrink to.

**Roundings.** Barycentrics, which are made of exact edge functions of snapped corners, in either form, sum l_i a_i or
a_0 + l_1 (a_1 - a_0) + l_2 (a_2 - a_0): relative to the terms. A device that does not say what it interpolates over does not
say either how: planes a_0 + g_x x + g_y y in floats, as rasterizers have them, are relative to their terms over the extent
of picture and triangle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.accept.borders import Cut, Piece
from ibr_ref.oracle.accept.bounded import Bounded, exact
from ibr_ref.oracle.accept.coverage import Fragments, of_varyings
from ibr_ref.oracle.accept.whole import Whole
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.referees.shadows.transform import gamma


@dataclass(frozen=True, eq=False)
class Triangles:
    """Corners in the window, and how far they may be moved."""

    x: Floats
    """(T, 3) on the raster, or as they were before, where varyings are interpolated over those alone."""
    y: Floats
    reach: tuple[Floats, Floats]
    """(T, 3) each: a corner's longest move along x and y."""
    area: Floats
    """(T,) twice the signed area."""
    extent: tuple[Floats, Floats]
    """(T,) each: the largest coordinate at which a plane is evaluated or anchored."""
    unsnapped: bool
    cuts: Sequence[Sequence[Cut | Whole]]
    """(T,) what else planes may be set up over: what the picture's borders leave of its polygon, the triangle before it
    was clipped."""
    device: Device

    @classmethod
    def of(
        cls, x: Bounded, y: Bounded, width: int, height: int, cuts: Sequence[Sequence[Cut | Whole]] = ()
    ) -> Triangles:
        """x, y (T, 3) in pixels, before they are snapped; cuts: none, or those of each triangle."""
        (at_x, off_x), (at_y, off_y) = of_varyings(x), of_varyings(y)
        edge_x, edge_y = ((a[:, 1] - a[:, 0], a[:, 2] - a[:, 0]) for a in (at_x, at_y))
        area = edge_x[0] * edge_y[1] - edge_y[0] * edge_x[1]
        extent_x, extent_y = (np.maximum(np.abs(a).max(axis=1), n) for a, n in ((at_x, width), (at_y, height)))
        return cls(at_x, at_y, (off_x, off_y), area, (extent_x, extent_y), x.device.unsnapped, cuts, x.device)

    @cached_property
    def whole(self) -> Bools:
        """(T,) planes may be set up over the triangle before it was clipped."""
        found = np.zeros(len(self.x), np.bool_)
        found[: len(self.cuts)] = [any(isinstance(each, Whole) for each in cuts) for cuts in self.cuts]
        return found

    def pieces(self, found: Fragments) -> list[tuple[int, Piece]]:
        """Triangles, and the pieces that may cover fragments of theirs."""
        result = []
        for triangle, cut in ((t, cut) for t, cuts in enumerate(self.cuts) for cut in cuts):
            mine = np.flatnonzero(found.triangle == triangle)
            px, py = (np.asarray(a[mine] + 0.5, np.float64) for a in (found.columns, found.rows))
            for piece in cut.pieces((self.x[triangle], self.y[triangle]), px, py, self.device):
                result.append((triangle, replace(piece, points=mine[piece.points])))
        return result


@dataclass(frozen=True, eq=False)
class Mixer:
    """A device's own barycentrics of fragments: |l'| <= |l| + what they may differ by."""

    found: Fragments
    moves: tuple[Floats, Floats]
    """(n,) each: how far the corners' moves take a fragment along x and y."""
    pieces: list[tuple[int, Piece]]
    """Triangles, and what else their planes may be set up over."""

    @classmethod
    def of(cls, triangles: Triangles, found: Fragments) -> Mixer:
        """Moves are sum |l'_i| |d_i|."""
        rough = cls(found, (np.zeros(0), np.zeros(0)), triangles.pieces(found))
        x, y = (rough.most(reach) for reach in triangles.reach)
        for _, piece in rough.pieces:
            for moved in (x, y):
                moved[piece.points] = np.maximum(moved[piece.points], piece.moved)
        return replace(rough, moves=(x, y))

    def most(self, sizes: Floats) -> Floats:
        """(n,) the most that sum |l'_i| s_i may be, of sizes (T, 3) >= 0."""
        t, l, s = self.found.triangle, np.abs(self.found.weights), sizes
        known: Floats = l[:, 0] * s[t, 0] + l[:, 1] * s[t, 1] + l[:, 2] * s[t, 2]
        largest = s.max(axis=1)
        if not largest.any():
            return known
        return np.asarray(known + np.where(largest[t] > 0.0, 3.0 * self.found.error * largest[t], 0.0))

    def moved(self, x: Floats, y: Floats) -> Floats:
        """(n,) what the moves make of a function with this gradient, (n,) each."""
        found = np.abs(x) * self.moves[0] + np.abs(y) * self.moves[1]
        return np.where(np.isnan(found), np.inf, found)


@dataclass(frozen=True, eq=False)
class Plane:
    """An affine function by its values at the corners (T, 3)."""

    corner: Floats
    error: Floats
    """(T, 3) of a corner's value."""
    gradient: tuple[Floats, Floats]
    """(T,) each."""
    rounding: Floats
    """(T,) of a plane's evaluation anywhere on the picture; 0 where planes are not used."""
    device: Device

    @classmethod
    def of(cls, triangles: Triangles, corner: Bounded) -> Plane:
        """Gradients are ((a_1 - a_0) p_2 - (a_2 - a_0) p_1) / area, with p the corners' differences along the other axis."""
        a = corner.value
        d1, d2 = a[:, 1] - a[:, 0], a[:, 2] - a[:, 0]
        p = [(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]) for c in (triangles.y, triangles.x)]
        flat = triangles.area == 0.0
        area = np.where(flat, 1.0, triangles.area)
        x, y = (np.where(flat, np.inf, (d1 * p2 - d2 * p1) / area) for p1, p2 in p)
        rounding = np.where(flat, np.inf, 0.0)
        if triangles.unsnapped:
            rounding = rounding + _evaluation(triangles, a, corner.device, area)
        return cls(a, np.broadcast_to(corner.error, a.shape), (x, -y), rounding, corner.device)

    def at(self, found: Fragments) -> Floats:
        """(n,) the value."""
        a = self.corner[found.triangle]
        l = found.weights
        return np.asarray(l[:, 0] * a[:, 0] + l[:, 1] * a[:, 1] + l[:, 2] * a[:, 2])

    def size(self, found: Fragments) -> Floats:
        """(n,) sum |l_i a_i|, or that of the differences from the first corner, the larger."""
        a, l = self.corner, np.abs(found.weights)
        t, size = found.triangle, np.abs(a)
        apart = np.abs(a - a[:, :1])
        sums: Floats = l[:, 0] * size[t, 0] + l[:, 1] * size[t, 1] + l[:, 2] * size[t, 2]
        return np.asarray(np.maximum(sums, size[t, 0] + l[:, 1] * apart[t, 1] + l[:, 2] * apart[t, 2]))

    def own(self, mixer: Mixer) -> Floats:
        """(n,) roundings and the corners' errors: all but the move.

        Barycentrics: conversion of E, their sum, a quotient by it and one by w, a difference, a product, two sums.
        """
        barycentric, t = gamma(self.device, 6.0, 2.0) * self.size(mixer.found), mixer.found.triangle
        pieces = np.zeros(len(t))
        for triangle, piece in mixer.pieces:
            pieces[piece.points] = np.maximum(pieces[piece.points], piece.off(self.corner[triangle]))
        return np.asarray(mixer.most(self.error) + np.maximum.reduce([barycentric, self.rounding[t], pieces]))


def _evaluation(triangles: Triangles, a: Floats, device: Device, area: Floats) -> Floats:
    """(T,) roundings of planes anywhere on the picture.

    Of the gradient: two differences, a product, their sum, and a quotient, or an inverse and a product: 5 operations and a
    quotient, relative to its terms, and as many of the area's terms, which are `condition` times larger than the area. A
    plane is anchored and then evaluated, each a product and a sum an axis; its corner's value is a product with 1 / w, and
    stored: 6 operations.
    """
    d1, d2 = np.abs(a[:, 1] - a[:, 0]), np.abs(a[:, 2] - a[:, 0])
    p = [(np.abs(c[:, 1] - c[:, 0]), np.abs(c[:, 2] - c[:, 0])) for c in (triangles.y, triangles.x)]
    condition = (p[0][1] * p[1][0] + p[0][0] * p[1][1]) / np.abs(area)
    terms = [(d1 * p2 + d2 * p1) / np.abs(area) for p1, p2 in p]
    across = terms[0] * triangles.extent[0] + terms[1] * triangles.extent[1]
    once, whole = gamma(device, 5.0, 1.0), gamma(device, 6.0)
    return np.asarray(2.0 * (once * (1.0 + condition) + whole) * across + whole * np.abs(a).max(axis=1))


# What is unknown of triangles without an area comes out as NaN or infinity, and is told as an infinite error.
@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def linear(triangles: Triangles, found: Fragments, corners: Sequence[Bounded]) -> list[Bounded]:
    """(n,) each of the varyings that are linear in the window, by their values (T, 3)."""
    mixer, t, result = Mixer.of(triangles, found), found.triangle, []
    for corner in corners:
        plane = Plane.of(triangles, corner)
        error = mixer.moved(plane.gradient[0][t], plane.gradient[1][t]) + plane.own(mixer)
        result.append(_between_corners(triangles, found, corner, Bounded(plane.at(found), error, corner.device)))
    return result


def _between_corners(triangles: Triangles, found: Fragments, corner: Bounded, value: Bounded) -> Bounded:
    """No farther off than the corners' values, between which a device that covers and interpolates by one triangle stays.

    That is all that is known of a triangle without an area, which other corners may give one.
    """
    t, error = found.triangle, np.broadcast_to(corner.error, corner.value.shape)
    low, high = (corner.value - error).min(axis=1)[t], (corner.value + error).max(axis=1)[t]
    known = np.isfinite(value.value)
    at = np.where(known, value.value, (low + high) / 2.0)
    off = np.where(known & ~np.isnan(value.error), value.error, np.inf)
    if not triangles.unsnapped:
        most = np.maximum(high - at, at - low)
        between = most + gamma(value.device, 6.0, 2.0) * np.maximum(np.abs(low), np.abs(high))
        off = np.where(triangles.whole[t], off, np.minimum(off, between))
    return Bounded(at, off, value.device)


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def perspective(triangles: Triangles, found: Fragments, corners: Sequence[Bounded], w: Bounded) -> list[Bounded]:
    """(n,) each of the varyings by their values (T, 3), w (T, 3) > 0.

    An error of w_i, which numerator and denominator share, moves N - u D by l_i (a_i - u) / w_i times its relative size.
    """
    device, t, mixer = w.device, found.triangle, Mixer.of(triangles, found)
    inverse = 1.0 / w.value
    room_w = np.abs(w.value) - w.error
    off = np.where(room_w > 0.0, w.error / np.where(room_w > 0.0, room_w, 1.0), np.inf) + device.quotient * UNIT
    below = Plane.of(triangles, exact(inverse, device))
    D, own_D, gradient_D = below.at(found), below.own(mixer), [g[t] for g in below.gradient]
    room = D - own_D - mixer.moved(*gradient_D) - mixer.most(inverse * off)
    result = []
    for corner in corners:
        apart = np.ptp(corner.value, axis=1)[:, None]
        both = (corner.error + apart * off + device.quotient * UNIT * np.abs(corner.value)) * inverse
        above = Plane.of(triangles, Bounded(corner.value * inverse, both, device))
        u = above.at(found) / D
        moved = mixer.moved(*(above.gradient[k][t] - u * gradient_D[k] for k in range(2)))
        error = (moved + above.own(mixer) + np.abs(u) * own_D) / room + device.quotient * UNIT * np.abs(u)
        error = np.where((room > 0.0) & np.isfinite(error), error, np.inf)
        result.append(_between_corners(triangles, found, corner, Bounded(u, error, device)))
    return result
