"""Where maps are not blank: what a warp need not fetch.

A mask is 0 and a map of depths 1 outside the caster's silhouette, which is most of it. A fetch of blank texels alone is
blank to the last bit: a (1 - f) + a f = a for a = 0 and a = 1 and all f in [0, 1].

Coordinates are those of texels here: x = u S - 0.5, of which a fetch reads the columns floor(x) and floor(x) + 1. Compiled
functions take the spans of one map, (S, 2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Indices, Whole
from ibr_ref.jit import device
from ibr_ref.pipeline.sampling import clamped

_SLACK = 1.0 / 1024.0
"""Texels that coordinates may be off: far more than what rounding does to them."""


def spans(texels: NDArray[np.generic], levels: NDArray[np.float64] | None, blank: float) -> NDArray[np.int32]:
    """(..., S, 2) of maps (..., S, S): each row's first column that is not blank, and one past the last; (S, 0): none.

    levels: (256,) values of the texels' bytes, or None: the texels are the values.
    """
    solid = texels != blank if levels is None else (levels != blank)[texels]
    size = solid.shape[-1]
    some = solid.any(axis=-1)
    first = np.where(some, solid.argmax(axis=-1), size)
    stop = np.where(some, size - solid[..., ::-1].argmax(axis=-1), 0)
    return np.stack([first, stop], axis=-1).astype(np.int32)


@device
def solid_range(spans: Indices, top: float, bottom: float) -> tuple[float, float]:
    """The least and the largest x of fetches that may read what is not blank, for y from top to bottom; none: (0, -1)."""
    last = np.float64(len(spans)) - 1.0
    first_row = np.int64(clamped(np.floor(top - _SLACK), 0.0, last))
    last_row = np.int64(clamped(np.floor(bottom + _SLACK) + 1.0, 0.0, last))
    first, stop = len(spans), 0
    for row in range(first_row, last_row + 1):
        first, stop = min(first, spans[row, 0]), max(stop, spans[row, 1])
    if first >= stop:
        return 0.0, -1.0
    return np.float64(first) - 1.0 - _SLACK, np.float64(stop) + _SLACK


@device
def live_columns(spans: Indices, x0: float, y0: float, x1: float, y1: float, count: int) -> tuple[Whole, Whole]:
    """The part [first, stop) of a run of `count` columns whose fetches may read what is not blank.

    The coordinates go from (x0, y0) to (x1, y1), inside the map, in even steps.
    """
    least, most = solid_range(spans, min(y0, y1), max(y0, y1))
    if max(x0, x1) < least or min(x0, x1) > most:
        return 0, 0
    step = (x1 - x0) / np.float64(max(1, count - 1))
    if abs(step) <= _SLACK:  # also for a single column
        return 0, count
    a, b = (least - x0) / step, (most - x0) / step
    last = np.float64(count)
    return np.int64(clamped(np.floor(min(a, b)), 0.0, last)), np.int64(clamped(np.ceil(max(a, b)) + 1.0, 0.0, last))
