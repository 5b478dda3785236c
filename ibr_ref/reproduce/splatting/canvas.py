"""Pictures put together into a figure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.float64]

_GAP = 6


def enlarged(picture: Picture, times: int) -> Picture:
    """Every pixel as a square of so many."""
    return picture.repeat(times, axis=0).repeat(times, axis=1)


def cropped(picture: Picture, column: int, row: int, width: int, height: int) -> Picture:
    """A part of it."""
    return picture[row : row + height, column : column + width]


def framed(picture: Picture, color: tuple[float, float, float], width: int = 3) -> Picture:
    """With a border inside."""
    result = picture.copy()
    for side in (result[:width], result[-width:], result[:, :width], result[:, -width:]):
        side[:] = color
    return result


def side_by_side(pictures: Sequence[Picture]) -> Picture:
    """In a row, on white."""
    height = max(len(picture) for picture in pictures)
    padded = [
        np.pad(p, ((0, height - len(p)), (0, _GAP if i + 1 < len(pictures) else 0), (0, 0)), constant_values=1.0)
        for i, p in enumerate(pictures)
    ]
    return np.concatenate(padded, axis=1)


def grid(pictures: Sequence[Picture], columns: int) -> Picture:
    """In rows of so many, on white."""
    rows = [side_by_side(pictures[first : first + columns]) for first in range(0, len(pictures), columns)]
    width = max(row.shape[1] for row in rows)
    padded = [np.pad(row, ((0, _GAP), (0, width - row.shape[1]), (0, 0)), constant_values=1.0) for row in rows]
    return np.concatenate(padded)[:-_GAP]
