"""Which pixels a program's triangles may cover, and with which weights of their corners.

A device snaps corners within its raster: then the point of the triangle that a pixel's weights belong to lies elsewhere, by
up to `moved` along x and y. Everything else of a fragment follows from where in this box it is, but for roundings.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept import borders, coverage
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.seams import loose
from ibr_ref.oracle.accept.whole import Whole, whole
from ibr_ref.oracle.arithmetic.bounds import Bounds
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.device import Device

EDGE_ROUNDINGS = 9.0
"""Of a product in an edge function, relative to that product, besides one quotient. As (x_b - x_a)(y - y_a) - ...: two
differences, the product, the sum: 4. As a plane q_0 + (dq/dx)(x - x_0) + (dq/dy)(y - y_0): a difference of q and one of
positions, their product, the sum of two, the quotient by the area (whose own product and sum are 2 more), a difference of
positions, the product with it, and two sums: 9 and a quotient."""

FARTHEST = 1e6
"""Pixels: a triangle that may have no area has its point anywhere, which is within this; numbers stay finite."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fragments:
    """(n,) candidates for pixels. Those of one polygon at a pixel are alternatives: its faces do not overlap."""

    pixel: Ints
    """row * width + column."""
    polygon: Ints
    triangle: Ints
    """Index in the polygon's triangles."""
    face: Ints
    """As it is written."""
    certain: Bools
    """The pixel gets this candidate, or another one of the same polygon, whatever the device does."""
    weights: Floats
    """(n, 3) shares of the corners as the reference has them."""
    rounding: Floats
    """(n, 3) of a device's arithmetic."""
    pieces: Floats
    """(n, 4) by how much each varying, and window depth, may be off besides, over what else planes may be set up."""
    gradient: Floats
    """(n, 3, 2) along x and y, a pixel."""
    moved: Floats
    """(n,) half the box's side, in pixels."""

    def __len__(self) -> int:
        return len(self.pixel)

    def take(self, index: Any) -> Fragments:
        """Some of them."""
        return Fragments(**{f.name: getattr(self, f.name)[index] for f in fields(self)})

    def shares(self, do: Bounds, lane: Ints, middle: Floats, half: Floats) -> list[Number]:
        """Weights where the box's part around `middle` (n, 2), in units of `moved`, is `half` (n, 2) as large."""
        found = []
        for i in range(3):
            along = self.gradient[:, i] * self.moved[:, None]
            value = self.weights[:, i] + (along * middle).sum(axis=1)
            slopes = {"x": along[:, 0] * half[:, 0], "y": along[:, 1] * half[:, 1]}
            found.append(do.named(f"share {i}", Number(do, value, self.rounding[:, i], slopes, lane)))
        return found


Faces = list[tuple[int, list[Any]]]
"""Their numbers, and corners (7,) in clip and patch space."""


def fragments_of(program: Any, polygons: Faces, unclipped: Faces, polygon: int, device: Device) -> Fragments:
    """The candidates of one polygon's faces, as clipping leaves them, and as they were."""
    width, height = program.width, program.height
    triangles = program.fanned(polygons)
    cuts = _cuts(program, polygons, device)
    corners: list[Any] = [np.stack(vertices, axis=-1) for _, vertices in triangles]  # (7, 3)
    clip = [[np.stack([c[i] for c in corners], axis=-1)] for i in (0, 1, 3)]  # (3, T): corner, triangle
    w = clip[2][0]
    x = program.window_x(program.do.divide(clip[0][0], w))
    y = program.window_y(program.do.divide(clip[1][0], w))
    # Where a polygon is cut its corners lie on no raster, even where the triangle's own do.
    off = np.array([[0.0 if each is None else each.moved] for each in cuts])
    x, y = (_bounded(c, 0.5 - program.centre(), device).widened(off) for c in (x, y))
    found = coverage.fragments(x, y, width, height, owns_border=program.owns_border)
    at_x, at_y = (coverage.snapped(c)[0] for c in (x, y))
    area = coverage.twice_area(at_x, at_y)
    # Corners that are no numbers cover nothing, whichever way round.
    drawn = np.array([bool(program.draws_orientation(int(np.nan_to_num(np.sign(a))))) for a in area], np.bool_)
    shift = program.varying_centre() - program.centre()
    over = coverage.of_varyings(x)[0], coverage.of_varyings(y)[0]
    value, rounding, gradient = _weights(found, *over, (width, height), device, shift)
    values = np.array([[c.value[:, k] for k in range(3)] for c in corners]).reshape(-1, 3, 7)
    wholes = _wholes(program, polygons, unclipped, device)
    pieces, moved = _pieces([*enumerate(cuts), *enumerate(wholes)], found, (*over, values), device)
    t, pixel = found.triangle, found.rows * width + found.columns
    kept = ~np.array([program.may_lie_in_a_plane(vertices) for _, vertices in triangles], np.bool_)
    result = Fragments(
        pixel=pixel,
        polygon=np.full(len(t), polygon),
        triangle=t,
        face=np.array([program.face_number(face) for face, _ in triangles], np.int64)[t],
        certain=_surely_covered(found, pixel, values[..., 4:], drawn) & kept[t],
        weights=value,
        rounding=rounding,
        pieces=pieces,
        gradient=gradient,
        moved=np.minimum(moved, FARTHEST),
    )
    return result.take(drawn[t])


def _bounded(x: Number, shift: float, device: Device) -> Bounded:
    """(T, 3) window coordinates."""
    return Bounded(x.value.T + shift, np.broadcast_to(x.deviation, x.shape).T, device)


def _cuts(program: Any, polygons: Faces, device: Device) -> list[borders.Cut | None]:
    """Of each triangle: what the picture's borders leave of its polygon, where the device may cut it there."""
    result: list[borders.Cut | None] = []
    for _, corners in polygons:
        found = None
        if device.clip_border and corners:
            found = borders.cut(*_clip(corners), (program.width, program.height), device)
        result += [found] * max(0, len(corners) - 2)
    return result


def _wholes(program: Any, polygons: Faces, unclipped: Faces, device: Device) -> list[Whole | None]:
    """Of each triangle: the one that it was clipped from, where the device may set up that one."""
    result: list[Whole | None] = []
    for (_, corners), (_, before) in zip(polygons, unclipped, strict=True):
        found = None
        if device.whole and corners and not _same(corners, before):
            found = whole(*_clip(before), (program.width, program.height), device)
        result += [found] * max(0, len(corners) - 2)
    return result


def _same(corners: list[Any], before: list[Any]) -> bool:
    """Whether clipping left a polygon as it was."""
    same = (np.array_equal(a.value, b.value) for a, b in zip(corners, before, strict=False))
    return len(corners) == len(before) and all(same)


def _clip(corners: list[Any]) -> tuple[Floats, Floats]:
    """(m, 4) clip coordinates and how far they may be off."""
    return np.stack([c.value[:4] for c in corners]), np.stack([c.deviation[:4] for c in corners])


def _pieces(
    setups: Iterable[tuple[int, borders.Cut | Whole | None]],
    found: coverage.Fragments,
    corners: tuple[Floats, Floats, Floats],
    device: Device,
) -> tuple[Floats, Floats]:
    """(n, 4) what planes of pieces make of varyings and of depth, (n,) how far their points are moved.

    corners: x and y (T, 3), and clip coordinates with the varyings (T, 3, 7). A varying is N / D, two planes, each off by
    itself: (off N + u off D) / (D - off D).
    """
    off, moved = np.zeros((len(found.triangle), 4)), found.moved.copy()
    x, y, values = corners
    for triangle, each in setups:
        if each is None:
            continue
        mine = np.flatnonzero(found.triangle == triangle)
        px, py = (np.asarray(a[mine] + 0.5, np.float64) for a in (found.columns, found.rows))
        z, w = values[triangle, :, 2], values[triangle, :, 3]
        planes = np.column_stack([values[triangle, :, 4:], z, np.ones(3)]) / w[:, None]
        for piece in each.pieces((x[triangle], y[triangle]), px, py, device):
            at = mine[piece.points]
            here, plane = found.weights[at] @ planes, piece.off(planes)
            under = here[:, 4] - plane[:, 4]
            apart = plane[:, :3] + np.abs(here[:, :3] / here[:, 4:]) * plane[:, 4:]
            apart = np.where(under[:, None] > 0.0, apart / under[:, None], np.inf)
            off[at] = np.maximum(off[at], np.nan_to_num(np.column_stack([apart, plane[:, 3]]), nan=np.inf))
            moved[at] = np.maximum(moved[at], piece.moved)
    return off, moved


def _weights(
    found: coverage.Fragments, x: Floats, y: Floats, size: tuple[int, int], device: Device, shift: float
) -> tuple[Floats, Floats, Floats]:
    """Weights, their roundings and gradients; at `shift` from the pixels' centres.

    What is interpolated over unsnapped corners alone is known so well that it counts where planes are anchored: with the
    picture's corner between, as in borders.py.
    """
    px, py, t = found.columns + 0.5, found.rows + 0.5, found.triangle
    area = coverage.twice_area(x, y)
    rounding, gradient = np.empty_like(found.weights), np.empty((len(x), 3, 2))
    units = (EDGE_ROUNDINGS * device.operation + device.quotient) * UNIT
    with np.errstate(divide="ignore", invalid="ignore"):
        for i in range(3):
            a, b = (i + 1) % 3, (i + 2) % 3
            dx, dy = x[:, b] - x[:, a], y[:, b] - y[:, a]
            gradient[:, i] = np.stack([-dy / area, dx / area], axis=1)
            products = np.abs(dx[t] * (py - y[t, a])) + np.abs(dy[t] * (px - x[t, a]))
            if not device.snapped:
                across = px + np.abs(x).max(axis=1)[t]
                down = np.maximum(py + np.abs(y).max(axis=1)[t], size[1] - py + np.abs(size[1] - y).max(axis=1)[t])
                products = np.abs(dx[t]) * down + np.abs(dy[t]) * across
            rounding[:, i] = units * products / np.abs(area[t])
    value = found.weights + shift * gradient[t].sum(axis=2)
    return value, rounding, gradient[t]


def _surely_covered(found: coverage.Fragments, pixel: Ints, patch: Floats, drawn: Bools) -> Bools:
    """(n,) whether the polygon covers the pixel in any case; patch (T, 3, 3): corners, drawn (T,): triangles."""
    _, vertices = np.unique(patch.reshape(-1, 3), axis=0, return_inverse=True)
    doubtful = np.zeros(int(pixel.max(initial=-1)) + 1, np.bool_)
    doubtful[pixel[loose(found, pixel, vertices.reshape(-1, 3), drawn)]] = True
    return ~doubtful[pixel]
