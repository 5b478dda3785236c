"""The operations of a device on `Number`s: what every legal device may have made of them.

The interface is that of `device.Arithmetic`; a program names what is used again (`named`), and writes the other legal forms
of a formula beside it (`either`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from math import frexp, prod
from typing import Any

import numpy as np

from ibr_ref.affine import pairs
from ibr_ref.affine.pairs import add_number, add_product, sum_up
from ibr_ref.affine.rows import DEVIATION, ERROR, EXACT, SLOPES, TINY, UNIT, VALUE, rounded
from ibr_ref.array_types import Ints
from ibr_ref.oracle.arithmetic import numpy_names
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.arithmetic.symbols import all_of, flat, places, shaped, together
from ibr_ref.oracle.arithmetic.ways import Ways
from ibr_ref.oracle.device import Device

TRUNCATED = 2.0
"""Of an operation that is rounded, or truncated, the error is below one unit in the last place: what is exact stays so."""


class Bounds(Ways):
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
        x = self.of(x)
        return Number.of_rows(self, shaped(x.rows, (len(lane),)), x.names, lane)

    def named(self, name: str, x: Any) -> Number:
        """What is used again: its own error becomes a symbol, one that no other number has."""
        number = self.of(x)
        if not np.any(number.error):
            return number
        names = self.run.names
        names[name] = names.get(name, 0) + 1
        rows = np.concatenate([number.rows, number.rows[ERROR : ERROR + 1]])
        rows[ERROR] = 0.0
        return Number.of_rows(self, rows, (*number.names, f"{name} {names[name]}"), number.lane)

    def rounded(self, x: Number, units: float) -> Number:
        """After a rounding; an exact 0 stays exact, and so do floats where rounding is correct (IEEE 754-2019, 4.3)."""
        rows = rounded(flat(x.rows, x.shape), units)
        return Number.of_rows(self, rows.reshape(x.rows.shape), x.names, x.lane)

    def widened(self, x: Any, quotients: float = 0.0, operations: float = 0.0) -> Number:
        """With so many roundings of its size more: those of another form that are not what that form's own bounds say."""
        number = self.of(x)
        units = (quotients * self.device.quotient + operations * self.device.operation) * UNIT
        return number.off_by(units * (np.abs(number.value) + number.deviation))

    # --- Operations --------------------------------------------------------------------------------------------------

    def add(self, a: Any, b: Any) -> Number:
        """A + b."""
        return self._added(a, b, 1.0)

    def subtract(self, a: Any, b: Any) -> Number:
        """A - b."""
        return self._added(a, b, -1.0)

    def _added(self, a: Any, b: Any, sign: float) -> Number:
        first, other = self.of(a), self.of(b)
        # A sum is its first number, the other being 0: operations that are rounded or truncated leave it so.
        nothing = self.device.operation <= TRUNCATED and other.lane is None and _is_zero(other)
        if nothing and together(first.shape, other.shape) == first.shape:
            return first
        return self.combined(pairs.plus, first, other, sign, self.device.operation)

    def multiply(self, a: Any, b: Any) -> Number:
        """A b; by 1 it is exact where products are correctly rounded."""
        first, second = self.of(a), self.of(b)
        if self._correct and (_is(first, 1.0) or _is(second, 1.0)):
            return second if _is(first, 1.0) else first
        return self.combined(pairs.times, first, second, self._units(first, second))

    @property
    def _correct(self) -> bool:
        """Whether operations are correctly rounded."""
        return self.device.operation <= 1.0

    def _units(self, a: Number, b: Number) -> float:
        """Of a product: by a power of two it is exact where rounding is correct."""
        return EXACT if self._correct and (_is_binary(a) or _is_binary(b)) else self.device.operation

    def divide(self, a: Any, b: Any) -> Number:
        """A / b; by a constant power of two it is exact."""
        b = self.of(b)
        return self.combined(pairs.over, self.of(a), b, EXACT if _is_binary(b) else self.device.quotient)

    def root(self, a: Any) -> Number:
        """sqrt(x + d) = r + d / 2r - d^2 / 2r (r + sqrt(x + d))^2."""
        a = self.of(a)
        r, off = np.sqrt(np.maximum(a.value, 0.0)), a.deviation
        with np.errstate(all="ignore"):
            bent = off**2 / (2.0 * r * (r + np.sqrt(np.maximum(a.value - off, 0.0))) ** 2)
            linear = (r > 0.0) & (off < a.value)
            wide = np.where(r > 0.0, np.minimum(off / r, np.sqrt(off)), np.sqrt(off))
            rows = np.where(linear, a.rows / (2.0 * r), 0.0)
            rows[VALUE], rows[ERROR] = r, np.where(linear, a.error / (2.0 * r) + bent, wide)
        return self.rounded(Number.deviating(self, rows, a.names, a.lane), self.device.root)

    def sum(self, terms: Sequence[Any], shape: tuple[int, ...] = ()) -> Number:
        """In any order: n roundings of the sum of the sizes."""
        numbers = [self.of(t) for t in terms]
        shape = together(shape, *(x.shape for x in numbers))
        return self._sum([(x, None) for x in numbers if not _is(x, 0.0)], shape)

    def dot(self, a: Sequence[Any], b: Sequence[Any]) -> Number:
        """The sum of products, fused or not."""
        both = [(self.of(x), self.of(y)) for x, y in zip(a, b, strict=True)]
        shape = together(*(x.shape for pair in both for x in pair))
        return self._sum([pair for pair in both if not self._is_no_term(*pair)], shape)

    def _is_no_term(self, a: Number, b: Number) -> bool:
        """0 x: where rounding is correct, and on any device in a sum that is the same in all lanes."""
        return (self._correct or a.rows.ndim == b.rows.ndim == 1) and (_is(a, 0.0) or _is(b, 0.0))

    def _sum(self, terms: Sequence[tuple[Number, Number | None]], shape: tuple[int, ...]) -> Number:
        """Of numbers and of products, added in any order."""
        factors = [x for term in terms for x in term if x is not None]
        names = all_of(*(x.names for x in factors))
        total, size = np.zeros((SLOPES + len(names), prod(shape))), np.zeros(prod(shape))
        room = np.empty_like(total)
        for a, b in terms:
            if b is not None and self._correct and (_is(a, 1.0) or _is(b, 1.0)):
                a, b = (b if _is(a, 1.0) else a), None
            rows, at = flat(a.rows, shape), places(names, a.names)
            if b is None:
                add_number(total, size, rows, at)
            else:
                units = self._units(a, b)
                add_product(total, size, rows, flat(b.rows, shape), at, places(names, b.names), units, room)
        sum_up(total, size, len(terms) * self.device.operation * UNIT if len(terms) > 1 else 0.0)
        return Number.of_rows(self, total.reshape(len(total), *shape), names, self.lane(*factors))

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
        return result.off_by(np.where(size > TINY, size * intrinsic, 0.0))

    def exponential(self, x: Any) -> Number:
        """e^x, of a number <= 0: exp2 of a product."""
        x, device = self.of(x), self.device
        value = np.exp(x.value)
        units = device.exponential * (1.0 + np.abs(x.value) / np.log(2.0)) + 2.0 * device.operation * np.abs(x.value)
        low, high = np.exp(x.low), np.exp(np.minimum(x.high, 0.0))  # below 0 the lower end may be the farther one
        return Number(self, value, np.maximum(high - value, value - low) + 2.0 * units * UNIT * high, {}, x.lane)

    def totals(self, terms: Any, of: Ints, count: int) -> Number:
        """(count,) sums of the terms (n,) that each row has, in any order; of (n,): whose they are."""
        terms = self.of(terms)
        many, value, error = (np.bincount(of, w, count) for w in (None, terms.value, terms.deviation))
        size = np.bincount(of, np.abs(terms.value) + terms.deviation, count)
        return Number(self, value, error + many * self.device.operation * UNIT * size)

    def mean(self, weights: Any, x: Any, of: Ints, count: int) -> Number:
        """(count,) weighted averages of what each row has: numerator and denominator have the same weights.

        Whatever these are: with weights w + e the average moves by sum (x - mean) e / sum (w + e).
        """
        weights, x = self.of(weights), self.of(x)
        w, off = weights.value, weights.deviation

        def summed(terms: Any) -> Any:
            return np.bincount(of, terms, count)

        with np.errstate(all="ignore"):
            least = summed(w) - summed(off)
            least = np.where(least > 0.0, least, np.where(summed(w) > 0.0, 0.0, np.nan))
            value = summed(w * x.value) / summed(w)
            moved = summed(np.abs(x.value - value[of]) * off) + summed((w + off) * x.deviation)
            size = summed((w + off) * (np.abs(x.value) + x.deviation))
            many, unit = np.bincount(of, minlength=count), self.device.operation * UNIT
            error = (moved + (2.0 * many + 1.0) * unit * size) / least
            error = np.where(np.isnan(error) & (many > 0), np.inf, error)
            if np.all(w >= 0.0):  # whatever they are, no average lies beyond all of its terms
                farthest, largest = np.zeros((2, count))
                np.maximum.at(farthest, of, np.abs(x.value - value[of]) + x.deviation)
                np.maximum.at(largest, of, np.abs(x.value) + x.deviation)
                error = np.fmin(error, farthest + (2.0 * many + 2.0) * unit * largest)
        return Number(self, value, error + self.device.quotient * UNIT * (np.abs(value) + error))

    # --- The device's own parts ----------------------------------------------------------------------------------------

    def weight(self, fraction: Any) -> Number:
        """A bilinear weight, which may be off by less than a step."""
        return self.of(fraction).off_by(self.device.weight_step)

    def filtered(self, mixed: Any, texels: Any) -> Any:
        """A lerp of texels in floats: what filters do in bytes is known of the right filter as a whole."""
        return mixed

    def of_bytes(self, x: Any) -> Number:
        """What a filter makes of texels that are bytes."""
        return self.of(x).off_by(self.device.filter_step)

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
        return self.of(depth).off_by(self.device.depth_step)

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
    return x.rows.ndim == 1 and not x.rows[DEVIATION] and frexp(x.rows[VALUE])[0] == 0.5


def _is_zero(x: Number) -> bool:
    """Everywhere, and exact; most numbers say with their first element that they are not."""
    return not (x.rows.size and x.rows.item(0)) and not x.value.any() and not x.deviation.any()


def _is(x: Number, number: float) -> bool:
    """A number that is the same everywhere, and exact."""
    return x.rows.ndim == 1 and x.rows[VALUE] == number and not x.rows[DEVIATION]
