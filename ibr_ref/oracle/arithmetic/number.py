"""Numbers that carry what a legal device may make of them, and comparisons that may have either outcome.

A `Number` is value + sum_i slope_i s_i +- error with symbols s_i in [-1, 1], on n lanes. A symbol stands for an uncertainty
that is used more than once (the eye in patch space; where on its face a fragment lies); `error` holds all that is
independent: roundings and what is not linear. Without symbols this is running error analysis (Higham 2002, section 3.3);
with them affine arithmetic (de Figueiredo & Stolfi 2004).

A comparison is a `Truth` (may, must). It is decided only where the program needs to know it: `Decisions`.

Both speak NumPy (NEP 13 and NEP 18), so that a program is written once, in NumPy's words: numpy_names.py has the tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from ibr_ref.array_types import Bools

if TYPE_CHECKING:
    from ibr_ref.oracle.arithmetic.bounds import Bounds


class _Speaks:
    """NumPy's functions, by the tables of numpy_names.py."""

    __slots__ = ()
    ops: Bounds

    def __array_function__(self, function: Any, types: Any, arguments: Any, named: Any) -> Any:
        return self.ops.functions[function](self.ops, *arguments, **named)

    def __array_ufunc__(self, function: Any, method: str, *arguments: Any, **named: Any) -> Any:
        return self.ops.ufuncs[function](self.ops, *arguments)


class Number(_Speaks):
    """`value`, `error` and each slope broadcast; `lane` (n,) says which run each row belongs to (None: to all)."""

    __slots__ = ("_deviation", "error", "lane", "ops", "slopes", "value")
    __array_priority__ = 1000

    def __init__(
        self, ops: Any, value: Any, error: Any = 0.0, slopes: dict[str, Any] | None = None, lane: Any = None
    ) -> None:
        self.ops, self.value, self.lane = ops, np.asarray(value, np.float64), lane
        self.error, self.slopes = np.asarray(error, np.float64), slopes or {}
        self._deviation: Any = None

    @property
    def deviation(self) -> Any:
        """How far a legal number may be from the value."""
        if self._deviation is None:
            self._deviation = self.error
            if self.slopes:
                found = reduce(np.add, [np.abs(s) for s in self.slopes.values()], self.error)
                self._deviation = np.where(np.isnan(found), np.inf, found)  # a slope without an end, times nothing
        return self._deviation

    @property
    def low(self) -> Any:
        """The least legal number."""
        return self.value - self.deviation

    @property
    def high(self) -> Any:
        """The largest."""
        return self.value + self.deviation

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the value."""
        return self.value.shape

    def allows(self, found: Any) -> Bools:
        """Whether a port's number is legal; NaN never is, but where the value is."""
        found = np.asarray(found, np.float64)
        with np.errstate(invalid="ignore"):
            near = np.abs(found - self.value) <= self.deviation
        return np.asarray(near | (found == self.value) | (np.isnan(found) & np.isnan(self.value)), np.bool_)

    def each(self, f: Callable[[Any], Any], lane: Any) -> Number:
        """The same selection of value, error and slopes."""

        def g(x: Any) -> Any:
            x = np.asarray(x)
            return f(x if x.shape == self.value.shape else np.broadcast_to(x, self.value.shape))

        return Number(self.ops, g(self.value), g(self.error), {k: g(s) for k, s in self.slopes.items()}, lane)

    def plus(self, other: Any, sign: float = 1.0) -> Number:
        """The sum or the difference, not rounded."""
        other = self.ops.of(other)
        put = np.add if sign > 0.0 else np.subtract
        slopes = dict(self.slopes)
        for k, s in other.slopes.items():
            slopes[k] = put(slopes.get(k, 0.0), s)
        lane = self.ops.lane(self, other)
        return Number(self.ops, put(self.value, other.value), self.error + other.error, slopes, lane)

    def absorbed(self, keep: tuple[str, ...] = ()) -> Number:
        """With its symbols, but those to keep, in its error: what leaves a run, for symbols have names within one only."""
        kept = {k: s for k, s in self.slopes.items() if k in keep}
        error = reduce(np.add, [np.abs(s) for k, s in self.slopes.items() if k not in keep], self.error)
        return Number(self.ops, self.value, error, kept, self.lane)

    # --- As NumPy's arrays are ---------------------------------------------------------------------------------------

    def __getitem__(self, index: Any) -> Number:
        """Rows; along other axes the lane stays."""
        rows = index[0] if isinstance(index, tuple) else index
        whole = (isinstance(rows, slice) and rows == slice(None)) or rows is Ellipsis
        lane = self.lane if self.lane is None or whole else self.lane[rows]
        return self.each(lambda x: x[index], lane)

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self) -> Iterator[Number]:
        return (self[i] for i in range(len(self.value)))

    @property
    def T(self) -> list[Number]:  # noqa: N802 as NumPy has it
        """Components of (n, c)."""
        return [self._component(c) for c in range(self.shape[-1])]

    def _component(self, c: int) -> Number:
        return self.each(lambda x: x[..., c], self.lane)

    def reshape(self, *shape: Any) -> Number:
        """Of numbers of the whole case."""
        return self.each(lambda x: x.reshape(*shape), self.lane)

    def swapaxes(self, first: int, second: int) -> Number:
        """Of numbers of the whole case."""
        return self.each(lambda x: x.swapaxes(first, second), self.lane)

    def astype(self, dtype: Any) -> Any:
        """Whole numbers are decided; another float type is a rounding that nowhere falls."""
        if np.dtype(dtype).kind == "i":
            return self.ops.whole(self).astype(np.int64)
        return self.ops.rising(lambda v: v.astype(dtype).astype(np.float64), self)

    def __float__(self) -> float:
        return float(self.value)

    def __bool__(self) -> bool:
        return bool(self != 0.0)

    def __neg__(self) -> Number:
        return self.ops.negative(self)

    def __abs__(self) -> Number:
        return self.ops.absolute(self)

    def __pow__(self, exponent: float) -> Any:
        return np.power(self, exponent)  # type: ignore[call-overload]

    def __add__(self, other: Any) -> Number:
        return self.ops.add(self, other)

    def __sub__(self, other: Any) -> Number:
        return self.ops.subtract(self, other)

    def __mul__(self, other: Any) -> Number:
        return self.ops.multiply(self, other)

    def __truediv__(self, other: Any) -> Number:
        return self.ops.divide(self, other)

    def __radd__(self, other: Any) -> Number:
        return self.ops.add(other, self)

    def __rsub__(self, other: Any) -> Number:
        return self.ops.subtract(other, self)

    def __rmul__(self, other: Any) -> Number:
        return self.ops.multiply(other, self)

    def __rtruediv__(self, other: Any) -> Number:
        return self.ops.divide(other, self)

    # --- Comparisons -------------------------------------------------------------------------------------------------

    def truth(self, other: Any, sign: float, strict: bool) -> Truth:
        """Whether sign (self - other) > 0, or >= 0."""
        gap = self.plus(other, -1.0)
        value, off = sign * gap.value, gap.deviation
        with np.errstate(invalid="ignore"):
            # Said the other way round: what is no number may be anything.
            may, must = (~(value + off <= 0), value - off > 0) if strict else (~(value + off < 0), value - off >= 0)
        return Truth(self.ops, may, must, gap.lane, value, off)

    def __gt__(self, other: Any) -> Truth:
        return self.truth(other, 1.0, True)

    def __lt__(self, other: Any) -> Truth:
        return self.truth(other, -1.0, True)

    def __ge__(self, other: Any) -> Truth:
        return self.truth(other, 1.0, False)

    def __le__(self, other: Any) -> Truth:
        return self.truth(other, -1.0, False)

    def __eq__(self, other: object) -> Truth:  # type: ignore[override]
        return (self >= other) & (self <= other)

    def __ne__(self, other: object) -> Truth:  # type: ignore[override]
        return ~(self == other)

    __hash__ = None  # type: ignore[assignment]


class Truth(_Speaks):
    """What a comparison, or several together, may and must be; `margin` of a single one, positive where it holds.

    bound: how far a device may move the margin.
    """

    __slots__ = ("bound", "lane", "margin", "may", "must", "ops", "outcome")
    dtype = np.dtype(np.bool_)

    def __init__(self, ops: Any, may: Any, must: Any, lane: Any, margin: Any = None, bound: Any = None) -> None:
        self.ops, self.may, self.must, self.lane = ops, np.asarray(may), np.asarray(must), lane
        self.margin, self.bound = margin, bound
        self.outcome: Any = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the lanes."""
        return np.broadcast_shapes(self.may.shape, self.must.shape)

    def decided(self) -> Bools:
        """The outcome of each lane on this path: the same however often it is asked for."""
        if self.outcome is None:
            self.outcome = self.ops.decide(self)
        return np.asarray(self.outcome, np.bool_)

    def _with(self, other: Any, f: Callable[[Any, Any], Any]) -> Truth:
        if isinstance(other, Truth):
            return Truth(self.ops, f(self._may, other._may), f(self._must, other._must), self.ops.lane(self, other))
        margin = self.margin
        if margin is not None:  # what is known beside it decides alone, or not at all
            margin = np.where(other, margin, -np.inf) if f is np.logical_and else np.where(other, np.inf, margin)
        return Truth(self.ops, f(self._may, other), f(self._must, other), self.lane, margin, self.bound)

    @property
    def _may(self) -> Any:
        """What is decided stays so."""
        return self.may if self.outcome is None else self.outcome

    @property
    def _must(self) -> Any:
        return self.must if self.outcome is None else self.outcome

    def __and__(self, other: Any) -> Truth:
        return self._with(other, np.logical_and)

    def __or__(self, other: Any) -> Truth:
        return self._with(other, np.logical_or)

    __rand__, __ror__ = __and__, __or__

    def __invert__(self) -> Truth:
        margin = None if self.margin is None else -self.margin
        return Truth(self.ops, ~self._must, ~self._may, self.lane, margin, self.bound)

    def __bool__(self) -> bool:
        return bool(np.all(self.decided()))

    def __array__(self, dtype: Any = None, copy: Any = None) -> Bools:
        return self.decided()

    def __getitem__(self, index: Any) -> Any:
        return self.decided()[index]

    def __len__(self) -> int:
        return self.shape[0]


def may_and_must(condition: Any) -> tuple[Bools, Bools]:
    """Of a comparison, or of what is decided anyway."""
    ends = (condition.may, condition.must) if isinstance(condition, Truth) else (condition, condition)
    may, must = (np.asarray(end, np.bool_) for end in ends)
    return may, must


def slope(symbol: str) -> Callable[[Number], Any]:
    """What gives a number's slope along a symbol."""
    return lambda x: x.slopes.get(symbol, 0.0)
