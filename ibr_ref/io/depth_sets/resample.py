"""The colours of one camera at the pixels of another one in the same place, with other intrinsics."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats


def colors_at(color: Floats, k: Floats, k_other: Floats, width: int, height: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Colours (height, width, 3), fetched bilinearly from a picture, and where its field of view has any.

    k, k_other: (3, 3) intrinsics of the picture and of the pixels, centres at half-integers.
    """
    rows, columns = color.shape[:2]
    y_n = (np.arange(height) + 0.5 - k_other[1, 2]) / k_other[1, 1]
    x_n = (np.arange(width)[None, :] + 0.5 - k_other[0, 2] - k_other[0, 1] * y_n[:, None]) / k_other[0, 0]
    y = np.broadcast_to((k[1, 1] * y_n + k[1, 2])[:, None], (height, width))
    x = k[0, 0] * x_n + k[0, 1] * y_n[:, None] + k[0, 2]
    known = (x >= 0.0) & (x <= columns) & (y >= 0.0) & (y <= rows)
    left, right, across = _neighbours(np.where(known, x, 0.5), columns)
    top, bottom, down = _neighbours(np.where(known, y, 0.5), rows)
    above = color[top, left] * (1.0 - across) + color[top, right] * across
    below = color[bottom, left] * (1.0 - across) + color[bottom, right] * across
    return above * (1.0 - down) + below * down, known


def _neighbours(place: Floats, count: int) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats]:
    """The two texels about each place, clamped, and the weight of the second (H, W, 1)."""
    first = np.floor(place - 0.5)
    weight = (place - 0.5 - first)[..., None]
    before = np.clip(first, 0, count - 1).astype(np.intp)
    return before, np.clip(first + 1, 0, count - 1).astype(np.intp), weight
