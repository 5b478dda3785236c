"""Vertices and points through two matrices, with their bounds, and into a window."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.oracle.accept.bounded import Bounded, exact, total, uploaded
from ibr_ref.oracle.device import UNIT, Device

MATRIX_ROUNDINGS = 13.0
"""Of every term of B (P (V p)), however it is bracketed: the uploads of P and V; P V with a product, three sums and a
rounding of its entries; the same again with p or B (a product and three sums); one rounding of the result. B, the bias
matrix, has two terms a row with entries of 1/2, which cost nothing: a sum more."""

EYE_ROUNDINGS = 10.0
"""Besides, of the terms of -axis . eye that a port computes itself. Of the eye: uploads of two factors, a product and two
sums, centre + (g e0 + h e1), and two more where it is centre + (eye - centre); then a product with the axis and two sums."""


def gamma(device: Device, operations: float, quotients: float = 0.0) -> float:
    """Largest relative error of so many operations in a row (Higham 2002, lemma 3.1)."""
    unit = (operations * device.operation + quotients * device.quotient) * UNIT
    return unit / (1.0 - unit)


@dataclass(frozen=True, eq=False)
class Lens:
    """Two matrices and the sizes of all terms in them."""

    view: Floats
    clip: Floats
    sizes: Floats
    """(4, 4) |P| |V|: what roundings are relative to, whatever cancels."""
    column_roundings: float = MATRIX_ROUNDINGS
    """Of the terms with V's last column; of the others MATRIX_ROUNDINGS."""

    @classmethod
    def of(cls, camera: Any, eye: ArrayLike | None = None) -> Lens:
        """A camera's. eye (3,), the sizes of its terms: with it the port has computed the last column, -axis . eye."""
        view, clip = np.asarray(camera.view_from_world, np.float64), np.asarray(camera.clip_from_view, np.float64)
        absolute = np.abs(view)
        if eye is None:
            return cls(view, clip, np.abs(clip) @ absolute)
        absolute[:3, 3] = absolute[:3, :3] @ np.asarray(eye, np.float64)
        return cls(view, clip, np.abs(clip) @ absolute, MATRIX_ROUNDINGS + EYE_ROUNDINGS)

    def clip_of(self, point: Sequence[Bounded]) -> list[Bounded]:
        """Clip coordinates x, y, z, w of points, the matrices applied one after the other or multiplied before.

        An error of the point moves the result by the product's entries; every rounding is relative to a term.
        """
        device = point[0].device
        x, y, z = (p.value for p in point)
        view = [row[0] * x + row[1] * y + row[2] * z + row[3] for row in self.view[:3]]
        sizes_of_rows = self.sizes.copy()
        if device.minus_one:  # the row is 2 z - w, and what comes of it is halved
            sizes_of_rows[2] += 0.5 * self.sizes[3]
        product, rounding = np.abs(self.clip @ self.view), gamma(device, MATRIX_ROUNDINGS)
        result = []
        for row, moves, sizes in zip(self.clip, product, sizes_of_rows, strict=True):
            value = row[0] * view[0] + row[1] * view[1] + row[2] * view[2] + row[3]
            error = gamma(device, self.column_roundings) * sizes[3]
            for k, p in enumerate(point):
                error = error + (moves[k] * p.error + rounding * sizes[k] * p.size)
            result.append(Bounded(value, np.broadcast_to(error, value.shape), device))
        return result


def placed(scene: Any, offset: Sequence[Bounded]) -> list[Bounded]:
    """x, y, z (V,) of the caster's vertices at an offset (x, y)."""
    device = offset[0].device
    vertices, axes = np.asarray(scene.caster.vertices, np.float64), np.asarray(scene.axes, np.float64)
    return [
        total([uploaded(vertices[:, k], device), *(o * uploaded(axes[i, k], device) for i, o in enumerate(offset))])
        for k in range(3)
    ]


def window(clip: Sequence[Bounded], width: int, height: int) -> list[Bounded]:
    """Window x, y and depth z / w of clip coordinates."""
    device = clip[0].device
    one = exact(1.0, device)
    x = (clip[0] / clip[3] + one) * exact(width / 2.0, device)
    y = (one - clip[1] / clip[3]) * exact(height / 2.0, device)
    z = clip[2] / clip[3]
    # From [-1, 1]: a quotient, a half and a sum, of numbers up to 1.
    return [x, y, z.widened(gamma(device, 2.0, 1.0)) if device.minus_one else z]


def centered(low: Floats, high: Floats, device: Device) -> Bounded:
    """Everything between two numbers."""
    return Bounded((low + high) / 2.0, (high - low) / 2.0, device)
