"""Which texels a fetch may read."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.bounded import Bounded


def reads(marked: Bools, u: Bounded, v: Bounded) -> Bools:
    """(n,) whether a marked texel (S, S) is among those that a bilinear or a nearest fetch may read."""
    size = len(marked)
    (first_row, last_row), (first, last) = (_footprint(size, axis) for axis in (v, u))
    sums = np.zeros((size + 1, size + 1), np.int64)
    sums[1:, 1:] = np.cumsum(np.cumsum(marked, axis=0), axis=1)
    last_row, last = last_row + 1, last + 1
    count = sums[last_row, last] - sums[first_row, last] - sums[last_row, first] + sums[first_row, first]
    return np.asarray(count > 0)


def _footprint(size: int, axis: Bounded) -> tuple[Ints, Ints]:
    """First and last texel, clamped: those whose centres are less than one away."""
    reach = np.nan_to_num(axis.error * size + axis.device.weight_step, nan=float(size))
    x = np.nan_to_num(axis.value * size - 0.5)
    low, high = np.floor(np.clip(x - reach, -1.0, size)), np.floor(np.clip(x + reach, -1.0, size)) + 1.0
    first, last = (np.clip(end, 0, size - 1).astype(np.int64) for end in (low, high))
    return first, last
