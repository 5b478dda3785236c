"""Three-vectors as arrays: sums from left to right, as the conventions have it."""

from __future__ import annotations

import math

import numpy as np

from ibr_ref.array_types import Floats


def cross(a: Floats, b: Floats) -> Floats:
    """The cross product of two (3,) vectors."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def dot(a: Floats, b: Floats) -> float:
    """The dot product of two (3,) vectors."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def length(a: Floats) -> float:
    """The length of a (3,) vector."""
    return math.sqrt(dot(a, a))


def unit(a: Floats) -> Floats:
    """The (3,) vector, not zero, divided by its length.

    Scaled by a power of two first, which is exact, so that no square over- or underflows.
    """
    scaled = np.ldexp(a, -int(np.frexp(abs(a).max())[1]))
    return scaled / length(scaled)
