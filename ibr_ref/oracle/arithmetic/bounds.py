"""The operations of a device on `Number`s: what every legal device may have made of them.

The interface is that of `device.Arithmetic`; a program names what is used again (`named`), and writes the other legal forms
of a formula beside it (`either`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np

from ibr_ref.array_types import Ints
from ibr_ref.oracle.arithmetic import numpy_names
from ibr_ref.oracle.arithmetic.choices import Choices
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.device import TINY, UNIT, Device

TRUNCATED = 2.0
"""Of an operation that is rounded, or truncated, the error is below one unit in the last place: what is exact stays so."""


class Bounds(Choices):
    """Each result carries a rounding, and what it owes to the symbols."""

    bounded = True
    backwards = False
    functions, ufuncs = numpy_names.FUNCTIONS, numpy_names.UFUNCS

    def __init__(self, device: Device) -> None:
        self.device = device
        super().__init__()

    # --- Numbers -----------------------------------------------------------------------------------------------------

    def number(self, x: Any) -> Any:
        """What is uploaded: rounded once. Textures stay arrays: their rounding is counted where they are filtered."""
        x = np.asarray(x, np.float64)
        return x if x.ndim >= 2 else self.texels(x)

    def matrix(self, x: Any) -> Number:
        """A matrix that is uploaded."""
        return self.texels(x)

    def texels(self, x: Any) -> Number:
        """A texture that is fetched texel by texel."""
        x = np.asarray(x, np.float64)
        return Number(self, x, _from_float(x))

    @property
    def minus_one(self) -> bool:
        """Whether clip z may start at -w."""
        return self.device.minus_one

    def lanes(self, x: Any, lane: Ints) -> Number:
        """A row for each lane."""
        x, zero = self.of(x), np.zeros(len(lane))
        return Number(self, x.value + zero, x.error + zero, {k: s + zero for k, s in x.slopes.items()}, lane)

    def named(self, name: str, x: Any) -> Number:
        """What is used again: its own error becomes a symbol, one that no other number has."""
        number = self.of(x)
        if not np.any(number.error):
            return number
        self.names[name] = self.names.get(name, 0) + 1
        slopes = {**number.slopes, f"{name} {self.names[name]}": number.error}
        return Number(self, number.value, 0.0, slopes, number.lane)

    def rounded(self, x: Number, units: float) -> Number:
        """After a rounding; an exact 0 stays exact, and so do floats where rounding is correct (IEEE 754-2019, 4.3)."""
        size = np.abs(x.value) + x.deviation
        added = units * UNIT * size + TINY * (size > 0.0)
        if units <= 1.0 and not x.deviation.all():
            added = np.where((x.deviation == 0.0) & (size >= TINY), _from_float(x.value), added)
        result = Number(self, x.value, x.error + added, x.slopes, x.lane)
        result._deviation = x.deviation + added
        return result

    def widened(self, x: Any, quotients: float = 0.0, operations: float = 0.0) -> Number:
        """With so many roundings of its size more: those of another form that are not what that form's own bounds say."""
        x = self.of(x)
        units = (quotients * self.device.quotient + operations * self.device.operation) * UNIT
        return Number(self, x.value, x.error + units * (np.abs(x.value) + x.deviation), x.slopes, x.lane)

    # --- Operations --------------------------------------------------------------------------------------------------

    def add(self, a: Any, b: Any) -> Number:
        """A + b."""
        if self._stays(a, b):
            return self.of(a)
        return self.rounded(self.of(a).plus(b), self.device.operation)

    def subtract(self, a: Any, b: Any) -> Number:
        """A - b."""
        if self._stays(a, b):
            return self.of(a)
        return self.rounded(self.of(a).plus(b, -1.0), self.device.operation)

    def _stays(self, a: Any, b: Any) -> bool:
        """Whether a sum is its first number, the other being 0: operations that are rounded or truncated leave it so."""
        a, b = self.of(a), self.of(b)
        nothing = self.device.operation <= TRUNCATED and not b.value.any() and not b.deviation.any()
        return bool(nothing and b.lane is None and np.broadcast_shapes(a.shape, b.shape) == a.shape)

    def product(self, a: Any, b: Any) -> Number:
        """A b, not rounded."""
        a, b = self.of(a), self.of(b)
        with np.errstate(invalid="ignore"):
            slopes = {k: s * b.value for k, s in a.slopes.items()}
            for k, t in b.slopes.items():
                along = a.value * t
                slopes[k] = slopes[k] + along if k in slopes else along
            error = np.abs(a.value) * b.error + a.error * np.abs(b.value) + a.deviation * b.deviation
        error = np.where(np.isnan(error), np.inf, error)
        return Number(self, a.value * b.value, error, slopes, self.lane(a, b))

    def multiply(self, a: Any, b: Any) -> Number:
        """A b; by 1 it is exact where products are correctly rounded."""
        first, second = self.of(a), self.of(b)
        if self.device.operation <= 1.0 and (_is(first, 1.0) or _is(second, 1.0)):
            return second if _is(first, 1.0) else first
        found = self.product(first, second)
        if self.device.operation <= 1.0 and (_is_binary(first) or _is_binary(second)):
            return found
        return self.rounded(found, self.device.operation)

    def quotient(self, a: Any, b: Any) -> Number:
        """A / b, not rounded: (a - q b) / b with q = the quotient of the values, to first order over b's value."""
        a, b = self.of(a), self.of(b)
        with np.errstate(all="ignore"):
            q, size = a.value / b.value, np.abs(b.value)
            slopes = {k: (s - q * t) / b.value for k, s, t in self.pairs(a, b)}
            error = (a.error + np.abs(q) * b.error) / size
            room = size - b.deviation
            over = reduce(np.add, [np.abs(s) for s in slopes.values()], error) * b.deviation / room
            error = np.where(room > 0.0, error + over, np.inf)
        slopes = {k: np.where(np.isfinite(error), s, 0.0) for k, s in slopes.items()}
        return Number(self, q, np.where(np.isnan(error), np.inf, error), slopes, self.lane(a, b))

    def divide(self, a: Any, b: Any) -> Number:
        """A / b; by a constant power of two it is exact."""
        b = self.of(b)
        found = self.quotient(a, b)
        return found if _is_binary(b) else self.rounded(found, self.device.quotient)

    def root(self, a: Any) -> Number:
        """sqrt(x + d) = r + d / 2r - d^2 / 2r (r + sqrt(x + d))^2."""
        a = self.of(a)
        r, off = np.sqrt(np.maximum(a.value, 0.0)), a.deviation
        with np.errstate(all="ignore"):
            bent = off**2 / (2.0 * r * (r + np.sqrt(np.maximum(a.value - off, 0.0))) ** 2)
            linear = (r > 0.0) & (off < a.value)
            wide = np.where(r > 0.0, np.minimum(off / r, np.sqrt(off)), np.sqrt(off))
            error = np.where(linear, a.error / (2.0 * r) + bent, wide)
            slopes = {k: np.where(linear, s / (2.0 * r), 0.0) for k, s in a.slopes.items()}
        return self.rounded(Number(self, r, error, slopes, a.lane), self.device.root)

    def sum(self, terms: Sequence[Any], shape: tuple[int, ...] = ()) -> Number:
        """In any order: n roundings of the sum of the sizes."""
        terms = [self.of(t) for t in terms]
        shape = np.broadcast_shapes(shape, *(t.shape for t in terms))
        terms = [t for t in terms if not _is(t, 0.0)] or [self.of(np.zeros(shape))]
        total = reduce(Number.plus, terms)
        size = reduce(np.add, [np.abs(t.value) + t.deviation for t in terms])
        error = total.error + (len(terms) if len(terms) > 1 else 0) * self.device.operation * UNIT * size
        return Number(self, total.value + np.zeros(shape), error, total.slopes, total.lane)

    def dot(self, a: Sequence[Any], b: Sequence[Any]) -> Number:
        """The sum of products, fused or not; where rounding is correct, 0 x is no term."""
        pairs = [(self.of(x), self.of(y)) for x, y in zip(a, b, strict=True)]
        shape = np.broadcast_shapes(*(x.shape for pair in pairs for x in pair))
        if self.device.operation <= 1.0:
            pairs = [pair for pair in pairs if not any(_is(x, 0.0) for x in pair)]
        return self.sum([self.multiply(x, y) for x, y in pairs] or [0.0], shape)

    def lerp(self, a: Any, b: Any, f: Any) -> Number:
        """A (1 - f) + b f, or a + (b - a) f."""
        return self.alternatives(
            self.dot([a, b], [self.subtract(1.0, f), f]), self.add(a, self.multiply(self.subtract(b, a), f))
        )

    def unit(self, a: Sequence[Any]) -> list[Number]:
        """A vector divided by its length: no component beyond what the ranges of all of them allow, and roundings."""
        numbers, length = [self.of(x) for x in a], self.root(self.dot(a, a))
        return [self.between(self.divide(x, length), *self._share_of_length(numbers, i)) for i, x in enumerate(numbers)]

    def _share_of_length(self, vector: Sequence[Number], i: int) -> tuple[Any, Any]:
        """The ends of x / sqrt(x^2 + r^2): it rises with x, and is the nearer to 0 the larger r, the other components."""
        x, others = vector[i], [y for j, y in enumerate(vector) if j != i]
        least = reduce(np.add, [np.maximum(np.abs(y.value) - y.deviation, 0.0) ** 2 for y in others])
        most = reduce(np.add, [(np.abs(y.value) + y.deviation) ** 2 for y in others])
        slack = 2.0 * (2.0 * self.device.operation + self.device.root + self.device.quotient) * UNIT
        ends = []
        with np.errstate(all="ignore"):
            for end, away in ((x.low, -1.0), (x.high, 1.0)):
                far = np.where(away * end > 0.0, least, most)
                share = end / np.sqrt(end**2 + far)
                ends.append(np.where(np.isnan(share), away, share) + away * slack * np.abs(share))
        return np.maximum(ends[0], -1.0 - slack), np.minimum(ends[1], 1.0 + slack)

    def power(self, base: Any, exponent: int) -> Number:
        """A whole power of a number >= 0: by products, or exp2(e log2 x) where x > 0, and 0 where x is 0."""
        base, device = self.of(base), self.device
        logarithm = np.abs(np.log2(np.maximum(base.value, np.finfo(np.float64).tiny)))
        off = device.logarithm * np.maximum(logarithm, 1.0) + device.operation * logarithm
        intrinsic = (exponent * np.log(2.0) * off + device.exponential * (1.0 + exponent * logarithm)) * UNIT
        result = self.of(np.ones(base.shape))
        while exponent:
            if exponent % 2:
                result = self.multiply(result, base)
            base, exponent = self.multiply(base, base), exponent // 2
        size = np.abs(result.value) + result.deviation
        error = result.error + np.where(size > TINY, size * intrinsic, 0.0)
        return Number(self, result.value, error, result.slopes, result.lane)

    # --- The device's own parts ----------------------------------------------------------------------------------------

    def weight(self, fraction: Any) -> Number:
        """A bilinear weight, which may be off by less than a step."""
        x = self.of(fraction)
        return Number(self, x.value, x.error + self.device.weight_step, x.slopes, x.lane)

    def filtered(self, mixed: Any, texels: Any) -> Any:
        """A lerp of texels in floats: what filters do in bytes is known of the right filter as a whole."""
        return mixed

    def of_bytes(self, x: Any) -> Number:
        """What a filter makes of texels that are bytes."""
        x = self.of(x)
        return Number(self, x.value, x.error + self.device.filter_step, x.slopes, x.lane)

    def blended_byte(self, value: Any) -> Number:
        """The sum that blending makes, as a frame buffer of bytes holds it.

        Where the device converts to the nearest byte (0.5) the sums are those of the conventions. Elsewhere blending may
        round source and product too: up to one step away from the unrounded sum (shadows/method.md, "In 8 bits").
        """
        x, step = self.of(value), self.device.byte
        slack, off = 0.5 if step == 0.5 else max(step, 1.0), 2.0 * 255.0 * self.device.operation * UNIT
        low, high = 255.0 * x.low - off - slack, 255.0 * x.high + off + slack
        low, high = np.clip(np.ceil(low), 0.0, 255.0), np.clip(np.floor(high), 0.0, 255.0)
        middle = Number(self, 0.5 * (low + high), 0.5 * (high - low), {}, x.lane)
        return self.divide(middle, 255.0)

    def depth(self, depth: Any) -> Number:
        """A window depth in the depth buffer."""
        x = self.of(depth)
        return Number(self, x.value, x.error + self.device.depth_step, x.slopes, x.lane)

    def color(self, color: Any) -> Any:
        """A colour: bytes are judged where they are read."""
        return color


def _from_float(x: Any) -> Any:
    """How far numbers are from the nearest float32."""
    with np.errstate(invalid="ignore", over="ignore"):
        off = np.abs(x - x.astype(np.float32))
    return np.where(np.isfinite(off), off, 0.0)


def _is_binary(x: Number) -> bool:
    """A power of two that is the same everywhere, and exact: products with it and quotients by it are exact."""
    return x.value.ndim == 0 and not x.deviation and np.frexp(x.value)[0] == 0.5


def _is(x: Number, number: float) -> bool:
    """A number that is the same everywhere, and exact."""
    return x.value.ndim == 0 and float(x.value) == number and not x.deviation.any()
