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
from typing import TYPE_CHECKING, Any

import numpy as np

from ibr_ref.affine import pairs
from ibr_ref.affine.rows import DEVIATION, ERROR, EXACT, SLOPES, VALUE, deviated
from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.arithmetic.symbols import shaped, together

if TYPE_CHECKING:
    from ibr_ref.oracle.arithmetic.bounds import Bounds


class _Speaks:
    """NumPy's functions, by the tables of numpy_names.py."""

    __slots__ = ()
    do: Bounds

    def __array_function__(self, function: Any, types: Any, arguments: Any, named: Any) -> Any:
        return self.do.functions[function](self.do, *arguments, **named)

    def __array_ufunc__(self, function: Any, method: str, *arguments: Any, **named: Any) -> Any:
        return self.do.ufuncs[function](self.do, *arguments)


class Number(_Speaks):
    """`rows` (3 + K, ...): value, error, deviation (how far a legal number may be off) and the slopes along `names`.

    `lane` (n,) says which run each row belongs to (None: to all).
    """

    __slots__ = ("do", "lane", "names", "rows")
    __array_priority__ = 1000

    def __init__(
        self, do: Any, value: Any, error: Any = 0.0, slopes: dict[str, Any] | None = None, lane: Any = None
    ) -> None:
        """Of a value, and of an error and slopes that broadcast with it."""
        value, error = np.asarray(value, np.float64), np.asarray(error, np.float64)
        self.do, self.lane, self.names = do, lane, tuple(slopes) if slopes else ()
        shape = together(value.shape, error.shape)
        self.rows = np.empty((SLOPES + len(self.names), *shape))
        self.rows[VALUE], self.rows[ERROR], self.rows[DEVIATION] = value, error, error
        if slopes:
            for k, slope in enumerate(slopes.values(), SLOPES):
                self.rows[k] = slope
            deviated(self.rows.reshape(len(self.rows), -1))

    @classmethod
    def of_rows(cls, do: Any, rows: Floats, names: tuple[str, ...], lane: Any) -> Number:
        """Of rows as they are."""
        result = cls.__new__(cls)
        result.do, result.rows, result.names, result.lane = do, rows, names, lane
        return result

    @classmethod
    def deviating(cls, do: Any, rows: Floats, names: tuple[str, ...], lane: Any) -> Number:
        """Of rows whose deviation is filled in."""
        rows = np.ascontiguousarray(rows)  # which reshape then need not copy
        deviated(rows.reshape(len(rows), -1))
        return cls.of_rows(do, rows, names, lane)

    @property
    def value(self) -> Any:
        """What the reference has, but for roundings."""
        return self.rows[VALUE]

    @property
    def error(self) -> Any:
        """How far a legal number may be off besides what it owes to symbols."""
        return self.rows[ERROR]

    @property
    def deviation(self) -> Any:
        """How far a legal number may be from the value."""
        return self.rows[DEVIATION]

    @property
    def slopes(self) -> dict[str, Floats]:
        """Along each symbol."""
        return dict(zip(self.names, self.rows[SLOPES:], strict=True))

    @property
    def low(self) -> Any:
        """The least legal number."""
        return self.rows[VALUE] - self.rows[DEVIATION]

    @property
    def high(self) -> Any:
        """The largest."""
        return self.rows[VALUE] + self.rows[DEVIATION]

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the value."""
        return self.rows.shape[1:]

    def allows(self, found: Any) -> Bools:
        """Whether a port's number is legal; NaN never is, but where the value is."""
        found = np.asarray(found, np.float64)
        with np.errstate(invalid="ignore"):
            near = np.abs(found - self.value) <= self.deviation
        return np.asarray(near | (found == self.value) | (np.isnan(found) & np.isnan(self.value)), np.bool_)

    def each(self, f: Callable[[Any], Any], lane: Any) -> Number:
        """The same selection of value, error and slopes."""
        return Number.of_rows(self.do, np.stack([f(row) for row in self.rows]), self.names, lane)

    def off_by(self, more: Any) -> Number:
        """With a larger error."""
        rows = np.array(shaped(self.rows, together(self.shape, np.shape(more))))
        rows[ERROR] += more
        rows[DEVIATION] += more
        return Number.of_rows(self.do, rows, self.names, self.lane)

    def plus(self, other: Any, sign: float = 1.0) -> Number:
        """The sum or the difference, not rounded."""
        return self.do.combined(pairs.plus, self, self.do.of(other), sign, EXACT)

    def absorbed(self, keep: tuple[str, ...] = ()) -> Number:
        """With its symbols, but those to keep, in its error: what leaves a run, for symbols have names within one only."""
        kept = [k for k, name in enumerate(self.names, SLOPES) if name in keep]
        if len(kept) == len(self.names):
            return self
        rows = self.rows[[VALUE, ERROR, DEVIATION, *kept]]
        gone = [k for k in range(SLOPES, len(self.rows)) if k not in kept]
        rows[ERROR] += np.abs(self.rows[gone]).sum(axis=0)
        return Number.of_rows(self.do, rows, tuple(self.names[k - SLOPES] for k in kept), self.lane)

    # --- As NumPy's arrays are ---------------------------------------------------------------------------------------

    def __getitem__(self, index: Any) -> Number:
        """Rows; along other axes the lane stays."""
        rows = index[0] if isinstance(index, tuple) else index
        whole = (isinstance(rows, slice) and rows == slice(None)) or rows is Ellipsis
        lane = self.lane if self.lane is None or whole else self.lane[rows]
        if isinstance(index, tuple):
            return self.each(lambda x: x[index], lane)
        if isinstance(index, np.ndarray) and index.ndim == 1:  # in memory as the rows are, which indexing turns round
            at = np.flatnonzero(index) if index.dtype == np.bool_ else index
            return Number.of_rows(self.do, self.rows.take(at, axis=1), self.names, lane)
        return Number.of_rows(self.do, self.rows[:, index], self.names, lane)

    def __len__(self) -> int:
        return self.rows.shape[1]

    def __iter__(self) -> Iterator[Number]:
        return (self[i] for i in range(len(self)))

    @property
    def T(self) -> list[Number]:  # noqa: N802 as NumPy has it
        """Components of (n, c)."""
        return [self._component(c) for c in range(self.shape[-1])]

    def _component(self, c: int) -> Number:
        return Number.of_rows(self.do, self.rows[..., c], self.names, self.lane)

    def reshape(self, *shape: Any) -> Number:
        """Of numbers of the whole case."""
        return self.each(lambda x: x.reshape(*shape), self.lane)

    def swapaxes(self, first: int, second: int) -> Number:
        """Of numbers of the whole case."""
        return self.each(lambda x: x.swapaxes(first, second), self.lane)

    def astype(self, dtype: Any) -> Any:
        """Whole numbers are decided; another float type is a rounding that nowhere falls."""
        if np.dtype(dtype).kind == "i":
            return self.do.whole(self).astype(np.int64)
        return self.do.rising(lambda v: v.astype(dtype).astype(np.float64), self)

    def __float__(self) -> float:
        return float(self.value)

    def __bool__(self) -> bool:
        return bool(self != 0.0)

    def __neg__(self) -> Number:
        return self.do.negative(self)

    def __abs__(self) -> Number:
        return self.do.absolute(self)

    def __pow__(self, exponent: float) -> Any:
        return np.power(self, exponent)  # type: ignore[call-overload]

    def __add__(self, other: Any) -> Number:
        return self.do.add(self, other)

    def __sub__(self, other: Any) -> Number:
        return self.do.subtract(self, other)

    def __mul__(self, other: Any) -> Number:
        return self.do.multiply(self, other)

    def __truediv__(self, other: Any) -> Number:
        return self.do.divide(self, other)

    def __radd__(self, other: Any) -> Number:
        return self.do.add(other, self)

    def __rsub__(self, other: Any) -> Number:
        return self.do.subtract(other, self)

    def __rmul__(self, other: Any) -> Number:
        return self.do.multiply(other, self)

    def __rtruediv__(self, other: Any) -> Number:
        return self.do.divide(other, self)

    # --- Comparisons -------------------------------------------------------------------------------------------------

    def truth(self, other: Any, sign: float, strict: bool) -> Truth:
        """Whether sign (self - other) > 0, or >= 0."""
        gap = self.plus(other, -1.0)
        value, off = sign * gap.value, gap.deviation
        with np.errstate(invalid="ignore"):
            # Said the other way round: what is no number may be anything.
            may, must = (~(value + off <= 0), value - off > 0) if strict else (~(value + off < 0), value - off >= 0)
        return Truth(self.do, may, must, gap.lane, value, off)

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

    __slots__ = ("bound", "do", "lane", "margin", "may", "must", "outcome")
    dtype = np.dtype(np.bool_)

    def __init__(self, do: Any, may: Any, must: Any, lane: Any, margin: Any = None, bound: Any = None) -> None:
        self.do, self.may, self.must, self.lane = do, np.asarray(may), np.asarray(must), lane
        self.margin, self.bound = margin, bound
        self.outcome: Any = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the lanes."""
        return together(self.may.shape, self.must.shape)

    def decided(self) -> Bools:
        """The outcome of each lane on this path: the same however often it is asked for."""
        if self.outcome is None:
            self.outcome = self.do.decide(self)
        return np.asarray(self.outcome, np.bool_)

    def _with(self, other: Any, f: Callable[[Any, Any], Any]) -> Truth:
        if isinstance(other, Truth):
            return Truth(self.do, f(self._may, other._may), f(self._must, other._must), self.do.lane(self, other))
        margin = self.margin
        if margin is not None:  # what is known beside it decides alone, or not at all
            margin = np.where(other, margin, -np.inf) if f is np.logical_and else np.where(other, np.inf, margin)
        return Truth(self.do, f(self._may, other), f(self._must, other), self.lane, margin, self.bound)

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
        return Truth(self.do, ~self._must, ~self._may, self.lane, margin, self.bound)

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
