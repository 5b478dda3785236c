"""Triangles that the near or the far plane cuts, but that a device sets up from their own corners, behind the eye too.

A rasterizer in homogeneous coordinates clips nothing (Olano and Greer 1997). Others cover the clipped polygon's pixels, but
make their planes of the three corners that the vertex stage gave: each is projected, x / w and y / w, whatever the sign of
w, and snapped. In exact arithmetic such planes are the clipped polygon's: over w, what is linear in space is affine over
the window.

**Places.** At p a device with corners p_i + d_i has what the plane has at p - sum l_i d_i, with l its own weights of p.
Between a triangle's corners they are between 0 and 1; but if a corner lies behind the eye, the picture is beyond the others,
and the same step of the raster weighs sum |l_i| times as much. A corner near w = 0 is far away, and weighs little.

**Values.** Over w they are off by the roundings of 1 / w, each by the share of its corner; what the corners themselves are
off by is the clipped polygon's.

**Planes.** They are set up in floats as over any piece (`borders.py`), and anchored at the corner of the largest w: the
others' places, divided by a small w, are not known so well.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Floats
from ibr_ref.oracle.accept.borders import ROUNDINGS, Piece, weights
from ibr_ref.oracle.accept.coverage import RASTER
from ibr_ref.oracle.device import Device


@dataclass(frozen=True, eq=False)
class Whole:
    """A triangle's own corners (3,), in the window."""

    x: Floats
    y: Floats
    off: Floats
    """How far a device's corner may lie from here along each axis, snapped."""
    relative: Floats
    """Of values over w, relative to them."""
    anchor: int
    """The corner of the largest w."""
    size: tuple[int, int]
    """Of the picture, in pixels."""

    def pieces(self, corners: tuple[Floats, Floats], px: Floats, py: Floats, device: Device) -> Iterator[Piece]:
        """The triangle itself, over all points (n,); corners x, y (3,): of a triangle of the clipped polygon."""
        shares = weights(*corners, self.x, self.y)
        dx, dy = (np.abs(np.roll(a, -2) - np.roll(a, -1)) for a in (self.x, self.y))
        area = abs(
            (self.x[1] - self.x[0]) * (self.y[2] - self.y[0]) - (self.y[1] - self.y[0]) * (self.x[2] - self.x[0])
        )
        room = float(area - self.off @ (dx + dy) - 2.0 * self.off.sum() ** 2)
        here = np.abs(weights(self.x, self.y, px, py))
        # |l'| <= |l| + G sum |l'_i| d_i, with the steepest gradient G of the weights.
        steepest = float((dx + dy).max()) / area if area > 0.0 else np.inf
        left = 1.0 - steepest * float(self.off.sum())
        moved = here @ self.off / left if room > 0.0 and left > 0.0 else np.full(len(px), np.inf)
        across = px + abs(self.x[self.anchor])
        down = np.maximum(py + abs(self.y[self.anchor]), self.size[1] - py + abs(self.size[1] - self.y[self.anchor]))
        terms = np.multiply.outer(across, dy) + np.multiply.outer(down, dx)
        units = (ROUNDINGS * device.operation + device.quotient) * UNIT
        with np.errstate(invalid="ignore"):
            most = here + steepest * moved[:, None]
        yield Piece(
            points=np.arange(len(px)),
            rounding=units * terms / room if room > 0.0 else np.full(terms.shape, np.inf),
            shares=shares,
            own=most * self.relative,
            anchors=(self.anchor,),
            # The reference's own corners are snapped as well.
            moved=moved + (0.5 / RASTER if device.snapped else 0.0),
        )


def whole(clip: Floats, error: Floats, size: tuple[int, int], device: Device) -> Whole | None:
    """A triangle that a plane cuts, corners (3, 4) in clip space with their errors; None: one of them may have w = 0.

    Such a corner has no place in the window, and whoever draws the triangle has to cut it.
    """
    w, room = clip[:, 3], np.abs(clip[:, 3]) - error[:, 3]
    if not np.isfinite(clip).all() or not (room > 0.0).all():
        return None
    half = np.asarray(size) / 2.0
    ndc = clip[:, :2] / w[:, None]
    roundings = (device.quotient + 3.0 * device.operation) * UNIT * (1.0 + np.abs(ndc))
    slack = (error[:, :2] + np.abs(ndc) * error[:, 3:]) / room[:, None] + roundings
    step = device.varying_step
    return Whole(
        x=(ndc[:, 0] + 1.0) * half[0],
        y=(1.0 - ndc[:, 1]) * half[1],
        off=(slack * half).max(axis=1) + (step if device.subpixel_any else step / 2.0),
        relative=error[:, 3] / room + (device.quotient + device.operation) * UNIT,
        anchor=int(np.argmax(w)),
        size=size,
    )
