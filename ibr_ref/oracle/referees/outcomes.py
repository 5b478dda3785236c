"""A port's arrays against legal outcomes: which elements agree with one, and what a port's own numbers are known to be."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.arithmetic.bounds import Bounds
from ibr_ref.oracle.arithmetic.number import Number


def judged(element: Ints, agrees: Sequence[Bools], count: int) -> tuple[Bools, Any]:
    """Whether any outcome agrees with all arrays, and the first array that no outcome agrees with.

    Where each array agrees with some outcome, but none with all, the first one that breaks the agreement is blamed.
    """
    blame = np.full(count, -1, np.int8)
    together = np.ones(len(element), np.bool_)
    right = np.ones(count, np.bool_)
    for name, each in enumerate(agrees):
        together = together & each
        right = np.zeros(count, np.bool_)
        right[element[together]] = True
        blame[~right & (blame < 0)] = name
    return right, blame


def stored(do: Bounds, values: Any, own: Number | None = None) -> Number:
    """What was handed in, as the port computed with it: rounded to a float32 at most once where it was stored.

    A port that computes with more digits, or whose compiler keeps more in a register, hands in float32 all the same.
    own: what the number may be by the port's own inputs; where that is one number, and the port's, nothing was rounded.
    """
    values = np.asarray(values, np.float64)
    rounded = np.isfinite(values)
    if own is not None:
        rounded &= (own.deviation != 0.0) | (own.value != values)
    return Number(do, values, np.where(rounded, do.device.operation * UNIT * np.abs(values), 0.0))


def converted(do: Bounds, values: Floats) -> Number:
    """What was handed in of a quotient that the device makes once more before it computes with it.

    A texel k / 255, a depth of 24 bits: the one that was handed in is a quotient of the device's, stored; the one that was
    computed with is another.
    """
    number = stored(do, values)
    again = 2.0 * do.device.quotient * UNIT * np.abs(number.value)
    return number.off_by(np.where(number.error > 0.0, again, 0.0))
