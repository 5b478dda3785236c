"""The operations of a device on `Number`s: what every legal device may have made of them.

The interface is that of `device.Arithmetic`; a program names what is used again (`named`), and writes the other legal forms
of a formula beside it (`either`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic import numpy_names
from ibr_ref.oracle.arithmetic.decisions import Decisions
from ibr_ref.oracle.arithmetic.number import Ints, Number, Truth
from ibr_ref.oracle.device import TINY, UNIT, Device


class Bounds(Decisions):
    """Each result carries a rounding, and what it owes to the symbols."""

    bounded = True
    functions, ufuncs = numpy_names.FUNCTIONS, numpy_names.UFUNCS

    def __init__(self, device: Device) -> None:
        self.device = device
        super().__init__()

    # --- Numbers -----------------------------------------------------------------------------------------------------

    def of(self, x: Any) -> Number:
        """Any number as a `Number`."""
        return x if isinstance(x, Number) else Number(self, x)

    def number(self, x: Any) -> Any:
        """What is uploaded: rounded once. Textures stay arrays: their rounding is counted where they are filtered."""
        x = np.asarray(x, np.float64)
        if x.ndim >= 2:
            return x
        return Number(self, x, np.abs(x - x.astype(np.float32)))

    def matrix(self, x: Any) -> Number:
        """A matrix that is uploaded."""
        x = np.asarray(x, np.float64)
        return Number(self, x, np.abs(x - x.astype(np.float32)))

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
        """After a rounding; an exact 0 stays exact."""
        size = np.abs(x.value) + x.deviation
        added = units * UNIT * size + TINY * (size > 0.0)
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
        return self.rounded(self.of(a).plus(b), self.device.operation)

    def subtract(self, a: Any, b: Any) -> Number:
        """A - b."""
        return self.rounded(self.of(a).plus(b, -1.0), self.device.operation)

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
        return self.rounded(self.product(first, second), self.device.operation)

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
        exact = b.value.ndim == 0 and np.frexp(b.value)[0] == 0.5 and not b.deviation
        found = self.quotient(a, b)
        return found if exact else self.rounded(found, self.device.quotient)

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

    def sum(self, terms: Sequence[Any]) -> Number:
        """In any order: n roundings of the sum of the sizes."""
        terms = [self.of(t) for t in terms]
        shape = np.broadcast_shapes(*(t.shape for t in terms))
        terms = [t for t in terms if not _is(t, 0.0)] or [self.of(np.zeros(shape))]
        total = reduce(Number.plus, terms)
        size = reduce(np.add, [np.abs(t.value) + t.deviation for t in terms])
        error = total.error + (len(terms) if len(terms) > 1 else 0) * self.device.operation * UNIT * size
        return Number(self, total.value + np.zeros(shape), error, total.slopes, total.lane)

    def dot(self, a: Sequence[Any], b: Sequence[Any]) -> Number:
        """The sum of products, fused or not."""
        return self.sum([self.multiply(x, y) for x, y in zip(a, b, strict=True)])

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

    # --- Legal alternatives, and what is known besides -------------------------------------------------------------------

    def either(self, first: Any, *others: Callable[[], Any]) -> Any:
        """A formula's other legal forms beside it; of vectors, of each component."""
        for other in others:
            again = other()
            if isinstance(first, (list, tuple)):
                first = [self.alternatives(self.of(x), self.of(y)) for x, y in zip(first, again, strict=True)]
            else:
                first = self.alternatives(self.of(first), self.of(again))
        return first

    def alternatives(self, f: Number, g: Number) -> Number:
        """Two legal forms of one thing: the first one's value, and an error that covers both."""
        away = g.plus(f, -1.0)
        spread = reduce(np.add, [np.abs(s) for s in away.slopes.values()], np.abs(away.value) + g.error)
        error = np.maximum(f.error, np.where(np.isnan(spread), np.inf, spread))
        return Number(self, f.value, error, f.slopes, self.lane(f, g))

    def between(self, x: Number, low: Any, high: Any) -> Number:
        """What is known to lie between two ends, where that says more than its own bound."""
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        half = half + 2.0**-52 * np.abs(middle)
        wide = ~(x.deviation <= half)
        slopes = {k: np.where(wide, 0.0, s) for k, s in x.slopes.items()}
        return Number(self, np.where(wide, middle, x.value), np.where(wide, half, x.error), slopes, x.lane)

    def beyond(self, x: Number, least: float, up: Any) -> Number:
        """What is decided to be >= `least` (`up`), or <= -`least`."""
        above, below = (self.rising(f, x) for f in (lambda v: np.maximum(v, least), lambda v: np.minimum(v, -least)))
        return self.where(up, above, below)

    def rising(self, f: Callable[[Any], Any], x: Any) -> Number:
        """A function that nowhere falls: x where it changes nothing, else all between its ends, the value in the middle."""
        x = self.of(x)
        value, low, high = f(x.value), f(x.low), f(x.high)
        same = (low == x.low) & (high == x.high) & (value == x.value)
        with np.errstate(invalid="ignore"):
            middle = 0.5 * (low + high)
            half = np.maximum(high - middle, middle - low)
            for _ in range(2):  # both ends are reached: 1 where a colour is clamped to it
                half = np.where((middle + half < high) | (middle - half > low), np.nextafter(half, np.inf), half)
        bounded = np.isfinite(middle)
        value = np.where(same | ~bounded, value, middle)
        error = np.where(same, x.error, np.where(bounded, half, np.inf))
        return Number(self, value, error, {k: np.where(same, s, 0.0) for k, s in x.slopes.items()}, x.lane)

    def absolute(self, x: Any) -> Number:
        """|x|."""
        x = self.of(x)
        sign = np.where(x.value < 0.0, -1.0, 1.0)
        sure = np.abs(x.value) >= x.deviation
        error = np.where(sure, x.error, x.deviation)
        return Number(
            self, np.abs(x.value), error, {k: np.where(sure, sign * s, 0.0) for k, s in x.slopes.items()}, x.lane
        )

    def negative(self, x: Any) -> Number:
        """-x."""
        x = self.of(x)
        return Number(self, -x.value, x.error, {k: -s for k, s in x.slopes.items()}, x.lane)

    def where(self, condition: Any, a: Any, b: Any) -> Number:
        """One or the other; the condition is decided."""
        a, b = self.of(a), self.of(b)
        lane = self.lane(a, b)
        if isinstance(condition, Truth):
            lane, condition = lane if lane is not None else condition.lane, condition.decided()
        slopes = {k: np.where(condition, s, t) for k, s, t in self.pairs(a, b)}
        return Number(self, np.where(condition, a.value, b.value), np.where(condition, a.error, b.error), slopes, lane)

    def least(self, a: Any, b: Any) -> Number:
        """The smaller of two: one of them where that is certain, else all between the ends."""
        a, b = self.of(a), self.of(b)
        first, second = a.high <= b.low, b.high <= a.low
        value = np.minimum(a.value, b.value)
        low, high = np.minimum(a.low, b.low), np.minimum(a.high, b.high)
        with np.errstate(invalid="ignore"):
            error = np.where(low == high, 0.0, np.maximum(high - value, value - low))
        return self.where(first, a, self.where(second, b, Number(self, value, error, {}, self.lane(a, b))))

    def greatest(self, a: Any, b: Any) -> Number:
        """The larger of two."""
        return self.negative(self.least(self.negative(a), self.negative(b)))

    def first_least(self, numbers: Sequence[Number]) -> Ints:
        """Which is the least, of equal ones the first: decided, one against the least of those before."""
        best, at = numbers[0], np.zeros(numbers[0].shape, np.int64)
        for k, x in enumerate(numbers[1:], 1):
            less = (x < best).decided()
            best, at = self.where(less, x, best), np.where(less, k, at)
        return at

    def whole(self, x: Any) -> Any:
        """floor(x): decided, one border at a time."""
        x = self.of(x)
        low, high = np.floor(x.low), np.floor(x.high)
        far = ~(high - low <= 4.0)
        low, high = (np.where(far, np.floor(np.nan_to_num(x.value)), end) for end in (low, high))
        if far.any() and x.lane is not None:
            self.lost[x.lane[far]] = True
        while (low < high).any():
            stays = Truth(self, np.ones(low.shape, np.bool_), low == high, x.lane).decided()
            high = np.where(stays, high, high - 1.0)
            low = np.where(stays, np.maximum(low, high), low)
        return high

    # --- The device's own parts ----------------------------------------------------------------------------------------

    def weight(self, fraction: Any) -> Number:
        """A bilinear weight, which may be off by less than a step."""
        x = self.of(fraction)
        return Number(self, x.value, x.error + self.device.weight_step, x.slopes, x.lane)

    def depth(self, depth: Any) -> Number:
        """A window depth in the depth buffer."""
        x = self.of(depth)
        return Number(self, x.value, x.error + self.device.depth_step, x.slopes, x.lane)

    def color(self, color: Any) -> Any:
        """A colour: bytes are judged where they are read."""
        return color

    def constant(self, value: float, like: Any) -> Number:
        """The same number for each row of `like`, in its lanes."""
        like = self.of(like)
        return Number(self, np.full(like.shape, value), np.zeros(like.shape), {}, like.lane)

    # --- Rows ----------------------------------------------------------------------------------------------------------

    def replaced(self, x: Any, where: Any, by: Any) -> Number:
        """With other rows at some places."""
        x, by = self.of(x), self.of(by)

        def put(old: Any, new: Any) -> Any:
            result = np.array(np.broadcast_to(old, x.shape))
            result[where] = new
            return result

        slopes = {k: put(a, b) for k, a, b in self.pairs(x, by)}
        return Number(self, put(x.value, by.value), put(x.error, by.error), slopes, x.lane)

    def spread(self, x: Any, where: Any, count: int, nothing: float) -> Any:
        """Rows at some of `count` places, `nothing` elsewhere; places are lanes. What is decided are arrays."""
        if not isinstance(x, Number):
            result = np.full(count, nothing, np.asarray(x).dtype)
            result[where] = x
            if result.dtype.kind in "ib":
                return result
        empty = Number(self, np.full(count, nothing), np.zeros(count), {}, np.arange(count))
        return self.replaced(empty, where, x)


def _is(x: Number, number: float) -> bool:
    """A number that is the same everywhere, and exact."""
    return x.value.ndim == 0 and float(x.value) == number and not x.deviation.any()
