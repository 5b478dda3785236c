"""What rows of a number are, and what is done with those of one number.

number: (3 + K, n) of n elements their values, errors, deviations, and their slopes along K symbols.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.jit import device, routine

VALUE, ERROR, DEVIATION, SLOPES = 0, 1, 2, 3
"""Slopes are the rest."""

UNIT = 2.0**-24
"""Largest relative error of one correct rounding to float32: IEEE 754-2019, section 4.3.1, 24 significant bits."""
TINY = 2.0**-126
"""Smallest normal float32: results below it may be flushed to zero. IEEE 754-2019, table 3.5; Vulkan 1.3, "Precision and
Operation of SPIR-V Instructions": denormals may be flushed."""

EXACT = -1.0
"""Units of an operation that is not rounded."""


@device
def deviate(number: Floats) -> None:
    """Its deviation, of its error and slopes; a slope without an end, times nothing, may be anything."""
    for i in range(number.shape[1]):
        number[DEVIATION, i] = number[ERROR, i]
    for k in range(SLOPES, len(number)):
        for i in range(number.shape[1]):
            number[DEVIATION, i] += abs(number[k, i])
    if len(number) > SLOPES:
        for i in range(number.shape[1]):
            if np.isnan(number[DEVIATION, i]):
                number[DEVIATION, i] = np.inf


@device
def round_once(number: Floats, units: float) -> None:
    """A rounding more; an exact 0 stays exact, and so do floats where rounding is correct (IEEE 754-2019, 4.3)."""
    for i in range(number.shape[1]):
        size = abs(number[VALUE, i]) + number[DEVIATION, i]
        added = units * UNIT * size
        if size > 0.0:
            added += TINY
        if units <= 1.0 and number[DEVIATION, i] == 0.0 and size >= TINY:
            added = from_float(number[VALUE, i])
        number[ERROR, i] += added
        number[DEVIATION, i] += added


@device
def from_float(x: float) -> float:
    """How far a number is from the nearest float32, if there is one."""
    off = abs(x - np.float64(np.float32(x)))
    return off if np.isfinite(off) else 0.0


@device
def finish(number: Floats, units: float) -> None:
    """Its deviation, and the rounding of the operation that it comes from."""
    deviate(number)
    if units >= 0.0:
        round_once(number, units)


@routine
def deviated(number: Floats) -> None:
    """(3 + K, n) whose deviations are filled in."""
    deviate(number)


@routine
def rounded(number: Floats, units: float) -> Floats:
    """(3 + K, n) after an operation of so many units in the last place."""
    result = number.copy()
    round_once(result, units)
    return result
