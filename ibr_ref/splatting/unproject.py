"""From a pixel of a reference image with its depth to a point in the world (section 3.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Vector3, Vector4
from ibr_ref.jit import device, kernel, prange
from ibr_ref.splatting.buffers import Reference


@device
def normalized_y(f_y: float, center_y: float, row: float) -> float:
    """y_n of the centres of a row of pixels, downwards, at a distance of 1."""
    return (row + 0.5 - center_y) / f_y


@device
def normalized_x(f_x: float, skew: float, center_x: float, column: float, y_n: float) -> float:
    """x_n of the centre of a pixel of that row."""
    return (column + 0.5 - center_x - skew * y_n) / f_x


@device
def view_point(perspective: bool, x_n: float, y_n: float, depth: float) -> Vector3:
    """The pixel's point in the view space of its camera."""
    scale = depth if perspective else 1.0
    return x_n * scale, -y_n * scale, -depth


@device
def transform(row: Floats | Vector4, x: float, y: float, z: float) -> float:
    """One row (4,) of a (4, 4) matrix applied to the point (x, y, z, 1), summed from left to right."""
    return row[0] * x + row[1] * y + row[2] * z + row[3]


@device
def _row_points(reference: Reference, row: int, points: Floats) -> None:
    """The points of a row of pixels, into (P, 3)."""
    k, m = reference.intrinsics, reference.world_from_view
    y_n = normalized_y(k[1, 1], k[1, 2], row)
    for i in range(reference.row_starts[row], reference.row_starts[row + 1]):
        pixel = reference.pixels[i]
        x_n = normalized_x(k[0, 0], k[0, 1], k[0, 2], pixel - row * reference.columns, y_n)
        x, y, z = view_point(reference.perspective, x_n, y_n, reference.depth[pixel])
        for axis in range(3):
            points[pixel, axis] = transform(m[axis], x, y, z)


@kernel
def _points(reference: Reference, points: Floats) -> None:
    """All points, into (P, 3)."""
    for row in prange(len(reference.row_starts) - 1):
        _row_points(reference, row, points)


def world_points(reference: Reference) -> NDArray[np.float64]:
    """(P, 3) world positions of all pixels; NaN off the mask."""
    points = np.full((len(reference.depth), 3), np.nan)
    _points(reference, points)
    return points
