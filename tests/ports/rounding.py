"""How far a port may be off: a float64 value with a bound of what float32 makes of it, carried through every operation.

Running error analysis, as in Higham, "Accuracy and Stability of Numerical Algorithms", section 3.3, with the accuracies that
GLSL 4.50 promises (section 4.7.1): sums and products correctly rounded, quotients to 2.5 and inverse roots to 2 units in
the last place. Sums of several terms are bounded for every order and for fused multiply-adds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

UNIT = 2.0**-24
"""Largest relative error of one float32 rounding."""
LOOSE = 8.0 * UNIT
"""The same of a quotient, and of a square root made as the quotient of 1 and an inverse root."""


@dataclass(frozen=True)
class Rounded:
    """`value` and `error`, arrays that broadcast with each other."""

    value: np.ndarray
    error: np.ndarray

    @classmethod
    def of(cls, value: object) -> Rounded:
        """A float64 number that is uploaded as float32."""
        array = np.asarray(value, np.float64)
        return cls(array, np.abs(array - array.astype(np.float32)))

    def __add__(self, other: Rounded) -> Rounded:
        return self._result(self.value + other.value, self.error + other.error)

    def __sub__(self, other: Rounded) -> Rounded:
        return self + -other

    def __neg__(self) -> Rounded:
        return Rounded(-self.value, self.error)

    def __mul__(self, other: Rounded) -> Rounded:
        error = self._size * other.error + self.error * np.abs(other.value)
        return self._result(self.value * other.value, error)

    def __truediv__(self, other: Rounded) -> Rounded:
        value = self.value / other.value
        error = (self.error + np.abs(value) * other.error) / (np.abs(other.value) - other.error)
        return self._result(value, error, LOOSE)

    def root(self) -> Rounded:
        """The square root; the value well above its own error."""
        value = np.sqrt(self.value)
        return self._result(value, self.error / value, LOOSE)

    def between(self, low: float, high: float) -> Rounded:
        """Clamped: no farther off than before, and not at all where the value is safely outside."""
        least, most = Rounded.of(low), Rounded.of(high)
        below = self.value + self.error < low - least.error
        above = self.value - self.error > high + most.error
        error = np.where(below, least.error, np.where(above, most.error, self.error + least.error + most.error))
        return Rounded(np.clip(self.value, low, high), error)

    def positive(self) -> Rounded:
        """The greater of it and 0."""
        return Rounded(np.maximum(self.value, 0.0), np.where(self.value + self.error < 0.0, 0.0, self.error))

    def where(self, condition: np.ndarray, otherwise: Rounded) -> Rounded:
        """This where the condition holds, else the other."""
        return Rounded(
            np.where(condition, self.value, otherwise.value), np.where(condition, self.error, otherwise.error)
        )

    @property
    def _size(self) -> np.ndarray:
        """The largest magnitude that the float32 may have."""
        return np.abs(self.value) + self.error

    @staticmethod
    def _result(value: np.ndarray, error: np.ndarray, rounding: float = UNIT) -> Rounded:
        return Rounded(value, error + rounding * (np.abs(value) + error))


def total(terms: Sequence[Rounded]) -> Rounded:
    """The sum in any order."""
    value = reduce(np.add, [term.value for term in terms])
    error = reduce(np.add, [term.error for term in terms])
    return Rounded(value, error + len(terms) * UNIT * reduce(np.add, [term._size for term in terms]))


def dot(a: Sequence[Rounded], b: Sequence[Rounded]) -> Rounded:
    """The sum of products in any order."""
    return total([x * y for x, y in zip(a, b, strict=True)])


def unit(a: Sequence[Rounded]) -> list[Rounded]:
    """The vector divided by its length."""
    length = dot(a, a).root()
    return [x / length for x in a]


def power(base: Rounded, exponent: int) -> Rounded:
    """A whole power by repeated squaring."""
    result = Rounded.of(1.0)
    while exponent:
        if exponent % 2:
            result = result * base
        base = base * base
        exponent //= 2
    return result
