"""Planes, picture size and intrinsics of cameras, and the clip matrix made of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import checks

MOST_PIXELS = 65536
"""Largest width and height of a picture."""


def planes(near: float, far: float, above: float = -np.inf) -> tuple[float, float]:
    """near and far, checked: above < near < far."""
    near = checks.number("near", near, above=above)
    far = checks.number("far", far)
    if not far > near:
        raise checks.reject("far", far, f"> near = {near:g}")
    return near, far


def picture_size(width: int, height: int) -> tuple[int, int]:
    """Columns and rows, checked."""
    return (
        checks.whole("width", width, low=1, high=MOST_PIXELS),
        checks.whole("height", height, low=1, high=MOST_PIXELS),
    )


def depth_row(near: float, far: float, perspective: bool) -> tuple[float, float]:
    """Entries 2 and 3 of the clip matrix' row z: 0 at the near plane and w at the far plane."""
    return (far if perspective else 1.0) / (near - far), (near * far if perspective else near) / (near - far)


def intrinsics_matrix(value: ArrayLike) -> NDArray[np.float64]:
    """[[f_x, s, c_x], [0, f_y, c_y], [0, 0, 1]], checked, of a caller's `intrinsics`."""
    k = checks.matrix("intrinsics", value, 3, 3)
    if not (k[0, 0] * k[1, 1] != 0.0 and k[1, 0] == 0.0 and k[2].tolist() == [0.0, 0.0, 1.0]):
        raise checks.reject("intrinsics", k.tolist(), "an invertible [[f_x, s, c_x], [0, f_y, c_y], [0, 0, 1]]")
    return k


def clip_from_intrinsics(
    k: NDArray[np.float64], near: float, far: float, width: int, height: int, *, perspective: bool
) -> NDArray[np.float64]:
    """(4, 4) clip_from_view of intrinsics (3, 3) in pixels and a picture of width x height of them."""
    x = 2.0 * k[0, 0] / width, -2.0 * k[0, 1] / width, 1.0 - 2.0 * k[0, 2] / width
    y = 0.0, 2.0 * k[1, 1] / height, 2.0 * k[1, 2] / height - 1.0
    clip = np.zeros((4, 4))
    if perspective:
        clip[0, :3], clip[1, :3], clip[3, 2] = x, y, -1.0
    else:  # w is 1 where it was -z
        clip[0, [0, 1, 3]], clip[1, [0, 1, 3]], clip[3, 3] = (*x[:2], -x[2]), (*y[:2], -y[2]), 1.0
    clip[2, 2:] = depth_row(near, far, perspective)
    return clip


def intrinsics_of(
    clip_from_view: NDArray[np.float64], width: int, height: int, *, perspective: bool
) -> NDArray[np.float64]:
    """The inverse of `clip_from_intrinsics`, to rounding: (3, 3).

    Raises ValueError for a projection that is off the view's -z axis, which no intrinsics express.
    """
    half_width, half_height = width / 2.0, height / 2.0
    x, y = clip_from_view[:2].tolist()
    if perspective:
        unused, shift_x, shift_y = (x[3], y[0], y[3]), -x[2], y[2]
    else:
        unused, shift_x, shift_y = (x[2], y[0], y[2]), x[3], -y[3]
    if any(unused):
        form = "[[a, b, c, 0], [0, d, e, 0]]" if perspective else "[[a, b, 0, c], [0, d, 0, e]]"
        raise checks.reject("clip_from_view[:2]", [x, y], form)
    row_x = [x[0] * half_width, 0.0 - x[1] * half_width, (1.0 + shift_x) * half_width]
    row_y = [0.0, y[1] * half_height, (1.0 + shift_y) * half_height]
    return checks.matrix("intrinsics", [row_x, row_y, [0.0, 0.0, 1.0]], 3, 3)
