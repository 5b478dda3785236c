"""Stage raster: which faces may cover a pixel, and where on them its fragment lies."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept import coverage
from ibr_ref.oracle.accept.bounded import Bounded, exact
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.referees.displacement.arrays import joined, stacked
from ibr_ref.oracle.referees.displacement.vertex import Triangles

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

EDGE_ROUNDINGS = 9.0
"""Of a product in an edge function, relative to that product, besides one quotient. As (x_b - x_a)(y - y_a) - ...: two
differences, the product, the sum: 4. As a plane q_0 + (dq/dx)(x - x_0) + (dq/dy)(y - y_0): a difference of q and one of
positions, their product, the sum of two, the quotient by the area (whose own product and sum are 2 more), a difference of
positions, the product with it, and two sums: 9 and a quotient."""
MIX_ROUNDINGS = 5.0
"""Of a term E_i a_i / w_i in a sum of three, besides one quotient: E_i a_i, the rounding of E_i, and three of the sum."""
PLANE_ROUNDINGS = 6.0
"""Of a term of q_0 + b_1 (q_1 - q_0) + b_2 (q_2 - q_0) with q = a/w, besides the quotients of q and b: the rounding of E,
the difference, the product and three of the sum."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fragments:
    """Candidates for pixels, (n,) each. Candidates of one polygon at a pixel are alternatives: its faces do not overlap."""

    pixel: Ints
    """row * width + column."""
    polygon: Ints
    face: Ints
    certain: Bools
    """The pixel gets this candidate, or another one of the same polygon, whatever the device does."""
    point: Bounded
    """(n, 3) C."""
    depth: Bounded
    """Window depth of the face."""

    def __len__(self) -> int:
        return len(self.pixel)

    def take(self, index: Ints | Bools | slice) -> Fragments:
        """Some of them."""
        return Fragments(
            pixel=self.pixel[index],
            polygon=self.polygon[index],
            face=self.face[index],
            certain=self.certain[index],
            point=self.point[index],
            depth=self.depth[index],
        )


def fragments_of(triangles: list[Triangles], device: Device, width: int, height: int) -> Fragments:
    """The candidates of all polygons, in submission order."""
    found = [_fragments(polygon, each, width, height) for polygon, each in enumerate(triangles) if len(each.face)]
    if not found:
        nothing = exact(np.empty((0, 3)), device)
        empty = np.empty(0, np.int64)
        return Fragments(pixel=empty, polygon=empty, face=empty, certain=empty > 0, point=nothing, depth=nothing[:, 0])
    return Fragments(
        **{name: np.concatenate([getattr(f, name) for f in found]) for name in ("pixel", "polygon", "face", "certain")},
        point=joined([f.point for f in found]),
        depth=joined([f.depth for f in found]),
    )


def _fragments(polygon: int, triangles: Triangles, width: int, height: int) -> Fragments:
    x, y = window(triangles.clip, width, height)
    found = coverage.fragments(x, y, width, height)
    weights = _weights(found, coverage.snapped(x)[0], coverage.snapped(y)[0], x.device)
    pixel = found.rows * width + found.columns
    t = found.triangle
    return Fragments(
        pixel=pixel,
        polygon=np.full(len(t), polygon),
        face=triangles.face[t],
        certain=_surely_covered(pixel, found, triangles.patch.value),
        point=_varying(weights, triangles, t),
        depth=_linear(weights, triangles.clip[..., 2] / triangles.clip[..., 3], t),
    )


def window(clip: Bounded, width: int, height: int) -> tuple[Bounded, Bounded]:
    """Window x and y, downwards, of clip positions (..., 4)."""
    one, half = exact(1.0, clip.device), exact(0.5, clip.device)
    x, y = clip[..., 0] / clip[..., 3], clip[..., 1] / clip[..., 3]
    return (x + one) * half * exact(float(width), clip.device), (one - y) * half * exact(float(height), clip.device)


def _surely_covered(pixel: Ints, found: coverage.Fragments, patch: Floats) -> Bools:
    """Whether the polygon covers the pixel in any case.

    Its triangles share edges, with the same corners on either side: a pixel near such an edge alone is covered by one of
    the two, whichever it is. So only the edges that one triangle has for itself leave room for nothing, and only where a
    triangle that may cover the pixel is not certainly inside of them.
    """
    corners = [[tuple(corner) for corner in triangle] for triangle in patch.tolist()]
    keys = [[frozenset((c[(i + 1) % 3], c[(i + 2) % 3])) for i in range(3)] for c in corners]
    count = Counter(key for triangle in keys for key in triangle)
    shared = np.array([[count[key] > 1 for key in triangle] for triangle in keys])
    loose = ~(found.inside | shared[found.triangle]).all(axis=1)
    doubtful = np.zeros(int(pixel.max(initial=-1)) + 1, np.bool_)
    doubtful[pixel[loose]] = True
    return ~doubtful[pixel]


@dataclass(frozen=True, eq=False)
class _Weights:
    """(n, 3) weights of the corners as the reference has them, and what a device may make of them."""

    value: Floats
    rounding: Floats
    """(n, 3) of a device's arithmetic."""
    gradient: Floats
    """(n, 3, 2) along x and y, a pixel."""
    moved: Floats
    """(n,) by how much the point may move along x and y, for the device's corners lie elsewhere."""


def _weights(found: coverage.Fragments, x: Floats, y: Floats, device: Device) -> _Weights:
    px, py, t = found.columns + 0.5, found.rows + 0.5, found.triangle
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (y[:, 1] - y[:, 0]) * (x[:, 2] - x[:, 0])
    rounding, gradient = np.empty_like(found.weights), np.empty((len(x), 3, 2))
    units = (EDGE_ROUNDINGS * device.operation + device.quotient) * UNIT
    with np.errstate(divide="ignore", invalid="ignore"):
        for i in range(3):
            a, b = (i + 1) % 3, (i + 2) % 3
            dx, dy = x[:, b] - x[:, a], y[:, b] - y[:, a]
            gradient[:, i] = np.stack([-dy / area, dx / area], axis=1)
            products = np.abs(dx[t] * (py - y[t, a])) + np.abs(dy[t] * (px - x[t, a]))
            rounding[:, i] = units * products / np.abs(area[t])
    return _Weights(found.weights, rounding, gradient[t], found.moved)


def _varying(weights: _Weights, triangles: Triangles, t: Ints) -> Bounded:
    """C = (sum b_i a_i / w_i) / (sum b_i / w_i).

    With weights b' and w' of the device, C' - C = sum (b'_i / w'_i)(a_i - C) / sum b'_i / w'_i, and the terms without a
    prime add up to 0. Where the point moves by d, b' - b = d grad b: the sum moves by d sum grad b_i (a_i - C) / w_i.
    To that come the roundings of b and the errors of w, each for itself, those of a, and the roundings of the two sums.
    """
    device = triangles.clip.device
    w, a = triangles.clip[..., 3], triangles.patch
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        relative = np.where(w.error < w.value, w.error / (w.value - w.error), np.inf)
        shares = weights.value / w.value[t]
        slopes = weights.gradient / w.value[t][:, :, None]
        off = (weights.rounding + np.abs(weights.value) * relative[t]) / w.value[t]
        whole = shares.sum(axis=1)
        units = (MIX_ROUNDINGS * device.operation + device.quotient) * UNIT
        plane = (PLANE_ROUNDINGS * device.operation + 2.0 * device.quotient) * UNIT
        inverse = 1.0 / w.value[t]
        blur = np.maximum(units * np.abs(shares).sum(axis=1), plane * _plane_size(weights, inverse))
        room = whole - off.sum(axis=1) - blur - weights.moved * _steepness(slopes)
        result = []
        for k in range(3):
            values, errors = a.value[t, :, k], a.error[t, :, k]
            value = (shares * values).sum(axis=1) / whole
            away = values - value[:, None]
            moved = weights.moved * _steepness(slopes * away[:, :, None])
            blurred = (off * np.abs(away) + (np.abs(shares) + off) * errors).sum(axis=1)
            mixed = units * (np.abs(shares) * np.abs(values)).sum(axis=1)
            rounded = np.maximum(mixed, plane * _plane_size(weights, values * inverse)) + blur * np.abs(value)
            error = np.where(room > 0.0, (moved + blurred + rounded) / room, np.inf)
            error += device.quotient * UNIT * np.abs(value)
            result.append(Bounded(value, np.where(np.isnan(error), np.inf, error), device))
    return stacked(result)


def _plane_size(weights: _Weights, q: Floats) -> Floats:
    """(n,) the sizes of the terms of a plane through the corners' q (n, 3), from the corner where they are largest."""
    sizes = [np.abs(q[:, j]) + (np.abs(weights.value) * np.abs(q - q[:, j, None])).sum(axis=1) for j in range(3)]
    return np.asarray(np.max(sizes, axis=0))


def _steepness(gradients: Floats) -> Floats:
    """(n,) how much a sum with these gradients (n, 3, 2) of its terms changes at most, where x and y move by 1."""
    along = gradients[:, 0] + gradients[:, 1] + gradients[:, 2]
    return np.asarray(np.abs(along[:, 0]) + np.abs(along[:, 1]))


def _linear(weights: _Weights, z: Bounded, t: Ints) -> Bounded:
    """sum b_i z_i, which moves as its gradient says."""
    device = z.device
    values = z.value[t]
    value = (weights.value * values).sum(axis=1)
    moved = weights.moved * _steepness(weights.gradient * values[:, :, None])
    blurred = (weights.rounding * np.abs(values - value[:, None])).sum(axis=1)
    carried = ((np.abs(weights.value) + weights.rounding) * z.error[t]).sum(axis=1)
    units = (MIX_ROUNDINGS * device.operation + device.quotient) * UNIT
    error = moved + blurred + carried + units * (np.abs(weights.value) * np.abs(values)).sum(axis=1)
    return Bounded(value, np.where(np.isnan(error), np.inf, error), device)
