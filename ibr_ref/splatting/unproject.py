"""From a pixel of a reference image with its depth to a point in the world (section 3.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import device, kernel, prange
from ibr_ref.splatting.buffers import Reference


@device
def normalized_y(intrinsics, row):
    """y_n of the centres of a row of pixels, downwards, at a distance of 1."""
    return (row + 0.5 - intrinsics[1, 2]) / intrinsics[1, 1]


@device
def normalized_x(f_x, skew, center_x, column, y_n):
    """x_n of the centre of a pixel of that row."""
    return (column + 0.5 - center_x - skew * y_n) / f_x


@device
def view_point(perspective, x_n, y_n, depth):
    """The pixel's point in the view space of its camera."""
    scale = depth if perspective else 1.0
    return x_n * scale, -y_n * scale, -depth


@device
def transform(row, x, y, z):
    """One row of a (4, 4) matrix applied to the point (x, y, z, 1), summed from left to right."""
    return row[0] * x + row[1] * y + row[2] * z + row[3]


@device
def world_point(reference, pixel):
    """World position of a pixel, given by its index."""
    row = pixel // reference.columns
    column = pixel - row * reference.columns
    k = reference.intrinsics
    y_n = normalized_y(k, row)
    x_n = normalized_x(k[0, 0], k[0, 1], k[0, 2], column, y_n)
    x, y, z = view_point(reference.perspective, x_n, y_n, reference.depth[pixel])
    m = reference.world_from_view
    return transform(m[0], x, y, z), transform(m[1], x, y, z), transform(m[2], x, y, z)


@device
def _row_points(reference, first, last, points):
    for i in range(first, last):
        pixel = reference.pixels[i]
        points[pixel, 0], points[pixel, 1], points[pixel, 2] = world_point(reference, pixel)


@kernel
def _points(reference, points):
    for row in prange(len(reference.row_starts) - 1):
        _row_points(reference, reference.row_starts[row], reference.row_starts[row + 1], points)


def world_points(reference: Reference) -> NDArray[np.float64]:
    """(P, 3) world positions of all pixels; NaN off the mask."""
    points = np.full((len(reference.depth), 3), np.nan)
    _points(reference, points)
    return points
