"""Which triangles cover a pixel's centre, for certain or perhaps.

A corner that the device snaps elsewhere moves an edge function E(c) = (b - a) x (c - a). E is affine in each corner: moving
a by at most d_a and b by at most d_b along each axis changes it by at most d_a |c - b|_1 + d_b |c - a|_1 + 2 d_a d_b.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.device import Device

Floats = NDArray[np.float64]

RASTER = 256.0
"""Subpixels of the reference."""


@dataclass(frozen=True, eq=False)
class Covered:
    """Pixels that one triangle may cover."""

    triangle: int
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    certain: NDArray[np.bool_]
    """Every legal device covers the pixel."""
    weights: Floats
    """(n, 3) E_i / (E_0 + E_1 + E_2) of the snapped triangle, as the reference has them (beyond an edge: extrapolated)."""
    error: Floats
    """(n,) by how much a legal device's weights may differ, each; inf for a triangle that may have no area."""


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
    to_tie = 0.5 - np.abs(steps - reference)
    return reference / RASTER, np.where(to_tie > RASTER * x.error, 0.0, 1.0 / RASTER)


def covered(x: Bounded, y: Bounded, width: int, height: int) -> Iterator[Covered]:
    """For each triangle with corners x, y (T, 3), in window coordinates, the pixels that it may cover. NaN corners: none."""
    (at_x, off_x), (at_y, off_y) = snapped(x), snapped(y)
    off = np.maximum(off_x, off_y)
    if x.device.unsnapped:
        varying_off = np.maximum(off, np.maximum(np.abs(at_x - x.value) + x.error, np.abs(at_y - y.value) + y.error))
    else:
        varying_off = off
    for triangle in range(len(at_x)):
        if not (np.isfinite(at_x[triangle]).all() and np.isfinite(at_y[triangle]).all()):
            continue
        found = _covered(triangle, at_x[triangle], at_y[triangle], off[triangle], varying_off[triangle], width, height)
        if found is not None:
            yield found


def _covered(
    triangle: int, x: Floats, y: Floats, off: Floats, varying_off: Floats, width: int, height: int
) -> Covered | None:
    area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0])
    if area < 0.0:
        found = _covered(triangle, x[[0, 2, 1]], y[[0, 2, 1]], off[[0, 2, 1]], varying_off[[0, 2, 1]], width, height)
        if found is None:
            return None
        weights = found.weights[:, [0, 2, 1]]
        return Covered(triangle, found.rows, found.columns, found.certain, weights, found.error)
    reach = off.max()
    box = [
        (max(int(np.ceil(axis.min() - reach - 0.5)), 0), min(int(np.floor(axis.max() + reach - 0.5)) + 1, count))
        for axis, count in ((y, height), (x, width))
    ]
    if box[0][0] >= box[0][1] or box[1][0] >= box[1][1]:
        return None
    rows, columns = (axis.ravel() for axis in np.mgrid[slice(*box[0]), slice(*box[1])])
    edges, slacks, varying_slacks = [], [], []
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        edge, slack = _edge(x, y, off, a, b, columns + 0.5, rows + 0.5)
        edges.append(edge)
        slacks.append(slack)
        varying_slacks.append(_edge(x, y, varying_off, a, b, columns + 0.5, rows + 0.5)[1])
    E, slack = np.stack(edges, 1), np.stack(slacks, 1)
    owned = np.array([_top_left(x, y, (i + 1) % 3, (i + 2) % 3) for i in range(3)])
    reference = ((E > 0.0) | ((E == 0.0) & owned)).all(axis=1) & (area > 0.0)
    certain = reference & ((slack < E) | (slack == 0.0)).all(axis=1)
    possible = reference | ((-slack <= E) & (slack > 0.0) | (E > 0.0) | ((E == 0.0) & owned)).all(axis=1)
    keep = possible
    room = area - np.stack(varying_slacks, 1).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = E / area
        total = np.stack(varying_slacks, 1)
        error = np.where(
            room > 0.0, (total.max(axis=1) + np.abs(weights).max(axis=1) * total.sum(axis=1)) / room, np.inf
        )
    return Covered(triangle, rows[keep], columns[keep], certain[keep], weights[keep], error[keep])


def _edge(x: Floats, y: Floats, off: Floats, a: int, b: int, px: Floats, py: Floats) -> tuple[Floats, Floats]:
    """E of the edge a -> b at the points, and how much moved corners change it."""
    edge = (x[b] - x[a]) * (py - y[a]) - (y[b] - y[a]) * (px - x[a])
    to_a, to_b = np.abs(px - x[a]) + np.abs(py - y[a]), np.abs(px - x[b]) + np.abs(py - y[b])
    return edge, off[a] * to_b + off[b] * to_a + 2.0 * off[a] * off[b]


def _top_left(x: Floats, y: Floats, a: int, b: int) -> bool:
    """Whether pixels on the edge a -> b of a triangle with E > 0 inside (y downwards) belong to it."""
    return bool((y[b] == y[a] and x[b] > x[a]) or y[b] < y[a])


def window_raster(device: Device) -> float:
    """The step of the device's raster of window positions, in pixels."""
    return 2.0**-device.subpixel_bits
