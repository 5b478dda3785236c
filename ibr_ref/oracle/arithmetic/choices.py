"""What is known of numbers besides arithmetic: their ends, which of two they are, and the other legal forms of a formula."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ibr_ref.affine import pairs
from ibr_ref.affine.rows import DEVIATION, ERROR, VALUE
from ibr_ref.array_types import Ints
from ibr_ref.oracle.arithmetic.decisions import Decisions
from ibr_ref.oracle.arithmetic.number import Number, Truth, may_and_must
from ibr_ref.oracle.arithmetic.symbols import all_of, over_symbols, shaped, together


class Choices(Decisions):
    """Numbers chosen, replaced, and kept within what is known of them: nothing here rounds."""

    def of(self, x: Any) -> Number:
        """Any number as a `Number`."""
        return x if isinstance(x, Number) else Number(self, x)

    def negative(self, x: Any) -> Number:
        """-x."""
        x = self.of(x)
        rows = -x.rows
        rows[ERROR], rows[DEVIATION] = x.error, x.deviation
        return Number.of_rows(self, rows, x.names, x.lane)

    def absolute(self, x: Any) -> Number:
        """|x|."""
        x = self.of(x)
        sign = np.where(x.value < 0.0, -1.0, 1.0)
        sure = np.abs(x.value) >= x.deviation
        rows = np.where(sure, sign * x.rows, 0.0)
        rows[VALUE], rows[ERROR], rows[DEVIATION] = np.abs(x.value), np.where(sure, x.error, x.deviation), x.deviation
        return Number.of_rows(self, rows, x.names, x.lane)

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
        rows, off = np.where(same, x.rows, 0.0), np.where(bounded, half, np.inf)
        rows[VALUE], rows[ERROR] = value, np.where(same, x.error, off)
        rows[DEVIATION] = np.where(same, x.deviation, off)
        return Number.of_rows(self, rows, x.names, x.lane)

    def where(self, condition: Any, a: Any, b: Any) -> Number:
        """One or the other; the condition is decided."""
        a, b = self.of(a), self.of(b)
        lane = self.lane(a, b)
        if isinstance(condition, Truth):
            lane, condition = lane if lane is not None else condition.lane, condition.decided()
        names = all_of(a.names, b.names)
        shape = together(a.shape, b.shape)
        first, second = (shaped(over_symbols(x.rows, x.names, names), shape) for x in (a, b))
        return Number.of_rows(self, np.where(condition, first, second), names, lane)

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
            self.run.lost[x.lane[far]] = True
        while (low < high).any():
            stays = Truth(self, np.ones(low.shape, np.bool_), low == high, x.lane).decided()
            high = np.where(stays, high, high - 1.0)
            low = np.where(stays, np.maximum(low, high), low)
        return high

    def pick(self, condition: Any, first: Callable[[], Any], other: Callable[[], Any]) -> Any:
        """One of two, by a condition of the whole case: either where it may go either way, the value's outcome before."""
        may, must = may_and_must(condition)
        if may == must:
            return first() if must else other()
        likelier, less_so = (first, other) if bool(condition) else (other, first)
        return self.alternatives(self.of(likelier()), self.of(less_so()))

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
        return self.combined(pairs.either, f, g)

    def between(self, x: Number, low: Any, high: Any) -> Number:
        """What is known to lie between two ends, where that says much more than its own bound; the value stays if it may."""
        low, high = self.of(low).low, self.of(high).high
        with np.errstate(invalid="ignore"):
            inside = (low <= x.value) & (x.value <= high)
            value = np.where(inside, x.value, 0.5 * (low + high))
            error = np.maximum(high - value, value - low) + 2.0**-52 * np.abs(value)
            error = np.where(np.isnan(error), np.inf, error)
            wide = ~(x.deviation <= 2.0 * error)
        rows = np.where(wide, 0.0, x.rows)
        rows[VALUE], rows[ERROR] = np.where(wide, value, x.value), np.where(wide, error, x.error)
        rows[DEVIATION] = np.where(wide, error, x.deviation)
        return Number.of_rows(self, rows, x.names, x.lane)

    def beyond(self, x: Number, least: float, up: Any) -> Number:
        """What is decided to be >= `least` (`up`), or <= -`least`."""
        above, below = (self.rising(f, x) for f in (lambda v: np.maximum(v, least), lambda v: np.minimum(v, -least)))
        return self.where(up, above, below)

    def rows(self, x: Any, at: Ints) -> Any:
        """Rows of a number, or of each component of a vector, a lane each where lanes are followed."""
        if isinstance(x, list):
            return [self.rows(each, at) for each in x]
        found = self.of(x)[at]
        found.lane = np.arange(len(at)) if self.run.following else None
        return found

    def blank(self, like: Any, shape: tuple[int, ...]) -> Any:
        """Zeros of the same kind."""
        return (
            Number(self, np.zeros(shape), np.zeros(shape)) if isinstance(like, Number) else np.zeros(shape, like.dtype)
        )

    def alike(self, a: Any, b: Any) -> Any:
        """Which of two uploaded numbers are the same on every device: those that are the same here."""
        return np.asarray(self.of(a).value == self.of(b).value)

    def missing(self, x: Any) -> Any:
        """Which are no numbers."""
        return np.isnan(self.of(x).value)

    def settled(self, x: Any, *others: Any) -> Number:
        """With the symbols that others have, the rest in its error: what a loop carries on, or it drags on all of them."""
        known = {name for other in others for name in self.of(other).names}
        return self.of(x).absorbed(tuple(known))

    def in_lanes(self, x: Any, like: Any) -> Number:
        """A number of the whole case for each row of `like`: what is decided of it is decided lane by lane, both ways."""
        x, like = self.of(x), self.of(like)
        return Number.of_rows(self, shaped(x.rows, like.shape), x.names, like.lane)

    def surely(self, truth: Any) -> bool:
        """Whether something holds for all rows, whatever is decided."""
        return bool(np.all(truth.must if isinstance(truth, Truth) else truth))

    def replaced(self, x: Any, where: Any, by: Any) -> Number:
        """With other rows at some places."""
        x, by = self.of(x), self.of(by)
        names = all_of(x.names, by.names)
        rows = np.array(over_symbols(x.rows, x.names, names))
        for row, new in zip(rows, over_symbols(by.rows, by.names, names), strict=True):
            row[where] = new
        return Number.of_rows(self, rows, names, x.lane)

    def spread(self, x: Any, where: Any, count: int, nothing: float) -> Any:
        """Rows at some of `count` places, `nothing` elsewhere; places are lanes. What is decided are arrays."""
        if not isinstance(x, Number):
            result = np.full(count, nothing, np.asarray(x).dtype)
            result[where] = x
            if result.dtype.kind in "ib":
                return result
        empty = Number(self, np.full(count, nothing), np.zeros(count), {}, np.arange(count))
        return self.replaced(empty, where, x)
