"""A number with a bound of what a device may make of it, carried through every operation.

Running error analysis (Higham 2002, "Accuracy and Stability of Numerical Algorithms", section 3.3): `value` is what the
reference has, and every legal float lies within `error` of it. A product's error is the product rule of both errors and one
rounding of its largest size; a sum of n terms in any order, fused or not, is bounded by n roundings of the sum of the sizes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.affine.rows import TINY, UNIT
from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.device import Device


@dataclass(frozen=True, eq=False)
class Bounded:
    """`value` and `error` >= 0, arrays that broadcast with each other, on a device."""

    value: Floats
    error: Floats
    device: Device

    def __add__(self, other: Bounded) -> Bounded:
        return self._rounded(self.value + other.value, self.error + other.error, self.device.operation)

    def __sub__(self, other: Bounded) -> Bounded:
        return self._rounded(self.value - other.value, self.error + other.error, self.device.operation)

    def __neg__(self) -> Bounded:
        return Bounded(-self.value, self.error, self.device)

    def __mul__(self, other: Bounded) -> Bounded:
        """Without a bound where either has none, even times 0."""
        with np.errstate(invalid="ignore"):
            error = np.asarray(self.size * other.error + self.error * np.abs(other.value))
        unbounded = np.isnan(error)
        if unbounded.any():
            error = np.where(unbounded, np.inf, error)
        return self._rounded(self.value * other.value, error, self.device.operation)

    def __truediv__(self, other: Bounded) -> Bounded:
        """The divisor's error must be below its size: elsewhere the error is infinite."""
        with np.errstate(divide="ignore", invalid="ignore"):
            value = self.value / other.value
            room = np.abs(other.value) - other.error
            error = np.where(room > 0.0, (self.error + np.abs(value) * other.error) / room, np.inf)
        return self._rounded(value, error, self.device.quotient)

    def __getitem__(self, index: Any) -> Bounded:
        value, error = np.broadcast_arrays(self.value, self.error)
        return Bounded(value[index], error[index], self.device)

    @property
    def size(self) -> Floats:
        """The largest magnitude that a legal float may have."""
        return np.abs(self.value) + self.error

    @property
    def low(self) -> Floats:
        """The least legal number."""
        return self.value - self.error

    @property
    def high(self) -> Floats:
        """The largest legal number."""
        return self.value + self.error

    def allows(self, found: ArrayLike) -> Bools:
        """Whether a port's number is legal; NaN never is, but where the reference has NaN."""
        found = np.asarray(found, np.float64)
        with np.errstate(invalid="ignore"):
            near = np.abs(found - self.value) <= self.error
        return np.asarray(near | (found == self.value) | (np.isnan(found) & np.isnan(self.value)), np.bool_)

    def root(self) -> Bounded:
        """The square root of a number >= 0: |sqrt(x + e) - sqrt(x)| <= e / sqrt(x), and <= sqrt(e)."""
        value = np.sqrt(np.maximum(self.value, 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            error = np.where(value > 0.0, np.minimum(self.error / value, np.sqrt(self.error)), np.sqrt(self.error))
        return self._rounded(value, error, self.device.root)

    def between(self, low: float, high: float) -> Bounded:
        """Clamped: no farther off than before, and exact where it is certainly outside."""
        least, most = np.clip(self.low, low, high), np.clip(self.high, low, high)
        value = np.clip(self.value, low, high)
        return Bounded(value, np.maximum(most - value, value - least), self.device)

    def positive(self) -> Bounded:
        """The greater of it and 0."""
        return self.between(0.0, np.inf)

    def absolute(self) -> Bounded:
        """Without its sign."""
        return Bounded(np.abs(self.value), self.error, self.device)

    def widened(self, error: ArrayLike) -> Bounded:
        """With more error."""
        return Bounded(self.value, self.error + np.asarray(error, np.float64), self.device)

    def where(self, condition: Bools, otherwise: Bounded) -> Bounded:
        """Itself where the condition holds, else the other."""
        value = np.where(condition, self.value, otherwise.value)
        return Bounded(value, np.where(condition, self.error, otherwise.error), self.device)

    def _rounded(self, value: Floats, error: Floats, units: float) -> Bounded:
        return Bounded(value, error + units * UNIT * (np.abs(value) + error) + TINY, self.device)


def exact(value: ArrayLike, device: Device) -> Bounded:
    """A number that every float32 holds."""
    array = np.asarray(value, np.float64)
    return Bounded(array, np.zeros_like(array), device)


def uploaded(value: ArrayLike, device: Device) -> Bounded:
    """A number of the case, rounded once to float32."""
    array = np.asarray(value, np.float64)
    return Bounded(array, np.abs(array - array.astype(np.float32)), device)


def stored(value: ArrayLike, device: Device, own: Bounded | None = None) -> Bounded:
    """What a port has handed in, as it computed with it: rounded to a float32 at most once where it was stored.

    A port that computes with more digits, or whose compiler keeps more in a register, hands in float32 all the same. own:
    what the number may be by the port's own inputs; where that is one number, and the port's, nothing was rounded.
    """
    array = np.asarray(value, np.float64)
    rounded = np.isfinite(array)
    if own is not None:
        rounded &= (own.error != 0.0) | (own.value != array)
    return Bounded(array, np.where(rounded, device.operation * UNIT * np.abs(array), 0.0), device)


def converted(value: ArrayLike, device: Device, own: Bounded | None = None) -> Bounded:
    """What a port has handed in of a quotient that the device makes once more before it computes with it.

    A texel k / 255, a depth of 24 bits, s / q in a projective fetch: the one that was handed in is a quotient of the
    device's, stored; the one that was computed with is another. own: as above.
    """
    number = stored(value, device, own)
    return number.widened(np.where(number.error > 0.0, 2.0 * device.quotient * UNIT * np.abs(number.value), 0.0))


def total(terms: Sequence[Bounded]) -> Bounded:
    """The sum in any order."""
    device = terms[0].device
    value = reduce(np.add, [term.value for term in terms])
    error = reduce(np.add, [term.error for term in terms])
    rounding = len(terms) * device.operation * UNIT * reduce(np.add, [term.size for term in terms])
    return Bounded(value, error + rounding, device)


def dot(a: Sequence[Bounded], b: Sequence[Bounded]) -> Bounded:
    """The sum of products in any order; the value is summed from left to right, as the reference's is."""
    return total([x * y for x, y in zip(a, b, strict=True)])


def lerp(a: Bounded, b: Bounded, f: Bounded) -> Bounded:
    """a (1 - f) + b f, or a + (b - a) f."""
    one = exact(1.0, f.device)
    either, other = dot([a, b], [one - f, f]), (b - a) * f
    # The other form's own roundings may be larger where a and b are far apart.
    return Bounded(either.value, np.maximum(either.error, (a + other).error), f.device)


def unit(a: Sequence[Bounded]) -> list[Bounded]:
    """A vector divided by its length; or times an inverse root, which is no less accurate than `root` and a quotient."""
    length = dot(a, a).root()
    return [x / length for x in a]


def opposite(device: Device) -> float:
    """The most by which components of two unit vectors may differ: 2, and the roundings of one that was computed.

    Its sum of three squares is off by 4 roundings, the root by half of that and one, the quotient by one more; twice that
    pays for their products.
    """
    return 2.0 + 2.0 * (2.0 * device.operation + device.root + device.quotient) * UNIT


def power(base: Bounded, exponent: int) -> Bounded:
    """A whole power of a number >= 0: by products in any order, or exp2(e log2 x) where x > 0, and 0 where x is 0."""
    device, least = base.device, np.maximum(base.value, np.finfo(np.float64).tiny)
    logarithm = np.abs(np.log2(least))
    off = device.logarithm * np.maximum(logarithm, 1.0) + device.operation * logarithm
    intrinsic = (exponent * np.log(2.0) * off + device.exponential * (1.0 + exponent * logarithm)) * UNIT
    result = exact(np.ones_like(base.value), device)
    while exponent:
        if exponent % 2:
            result = result * base
        base = base * base
        exponent //= 2
    return result.widened(np.where(result.size > TINY, result.size * intrinsic, 0.0))
