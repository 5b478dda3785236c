"""NumPy's names for the operations of `Bounds`: by NEP 13 and NEP 18 a program calls them on `Number`s as on arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic.number import Number, Truth
from ibr_ref.oracle.arithmetic.symbols import all_of, over_symbols


def _where(do: Any, condition: Any, a: Any, b: Any) -> Any:
    lane = condition.lane if isinstance(condition, Truth) else None
    condition = np.asarray(condition)
    if isinstance(a, Truth) or isinstance(b, Truth):
        a, b = (x if isinstance(x, Truth) else Truth(do, x, x, None) for x in (a, b))
        may, must = np.where(condition, a._may, b._may), np.where(condition, a._must, b._must)
        return Truth(do, may, must, do.lane(a, b) if lane is None else lane)
    if isinstance(a, Number) or isinstance(b, Number):
        found = do.where(condition, a, b)
        found.lane = found.lane if found.lane is not None else lane
        return found
    chosen = np.where(condition, a, b)
    return chosen if chosen.dtype.kind in "ib" else Number(do, chosen, np.zeros(chosen.shape), {}, lane)


def _stack(do: Any, parts: Any, axis: int = 0) -> Any:
    return _column(parts, np.stack, axis)


def _column(parts: Any, put: Callable[..., Any], axis: int) -> Number:
    """Several numbers in one, side by side or one after the other."""
    do = next(x.do for x in parts if isinstance(x, Number))
    numbers = [do.of(x) for x in parts]
    names = all_of(*(x.names for x in numbers))
    rows = [over_symbols(x.rows, x.names, names) for x in numbers]
    found = put(rows, axis=axis + 1 if axis >= 0 else axis)
    return Number.of_rows(do, found, names, do.lane(*numbers))


def _concatenate(do: Any, parts: Any, axis: int = 0) -> Number:
    """One after the other: each row belongs to the run that it came from."""
    found = _column(parts, np.concatenate, axis)
    lanes: list[Any] = [getattr(x, "lane", None) for x in parts]
    if axis == 0 and all(lane is not None for lane in lanes):
        found.lane = np.concatenate(lanes)
    return found


def _roll(do: Any, x: Any, shift: int, axis: int = 0) -> Any:
    return x.each(lambda v: np.roll(v, shift, axis), x.lane)


def _any(do: Any, x: Any, **named: Any) -> Any:
    return np.any(np.asarray(x), **named)


FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: _where,
    np.clip: lambda do, x, low, high: do.rising(lambda v: np.clip(v, low, high), x),
    np.stack: _stack,
    np.concatenate: _concatenate,
    np.broadcast_to: lambda do, x, shape: x.each(lambda v: np.broadcast_to(v, shape), x.lane),
    np.broadcast_arrays: lambda do, *parts: parts,
    np.shape: lambda do, x: x.shape,
    np.ndim: lambda do, x: len(x.shape),
    np.roll: _roll,
    np.zeros_like: lambda do, x: np.zeros(x.shape),
    np.ones_like: lambda do, x: np.ones(x.shape),
    np.flatnonzero: lambda do, x: np.flatnonzero(np.asarray(x)),
    np.any: _any,
}


def _power(do: Any, a: Any, b: float) -> Any:
    """A power that is no whole one, of a number >= 0: 16 units, as exp2 and log2 are granted."""
    return do.rounded(do.rising(lambda v: np.maximum(v, 0.0) ** b, a), 16.0)


UFUNCS: dict[Any, Callable[..., Any]] = {
    np.add: lambda do, a, b: do.add(a, b),
    np.subtract: lambda do, a, b: do.subtract(a, b),
    np.multiply: lambda do, a, b: do.multiply(a, b),
    np.divide: lambda do, a, b: do.divide(a, b),
    np.negative: lambda do, a: do.negative(a),
    np.absolute: lambda do, a: do.absolute(a),
    np.maximum: lambda do, a, b: do.greatest(a, b),
    np.minimum: lambda do, a, b: do.least(a, b),
    np.sqrt: lambda do, a: do.root(a),
    np.floor: lambda do, a: do.rising(np.floor, a),
    np.ceil: lambda do, a: do.rising(np.ceil, a),
    np.rint: lambda do, a: do.rising(np.rint, a),
    np.power: _power,
    np.isfinite: lambda do, a: np.isfinite(a.value),
    np.less: lambda do, a, b: do.of(a) < b,
    np.greater: lambda do, a, b: do.of(a) > b,
    np.less_equal: lambda do, a, b: do.of(a) <= b,
    np.greater_equal: lambda do, a, b: do.of(a) >= b,
    np.equal: lambda do, a, b: do.of(a) == b,
    np.not_equal: lambda do, a, b: do.of(a) != b,
    np.bitwise_and: lambda do, a, b: a & b if isinstance(a, Truth) else b & a,
    np.bitwise_or: lambda do, a, b: a | b if isinstance(a, Truth) else b | a,
    np.invert: lambda do, a: ~a,
    np.logical_not: lambda do, a: ~a,
}
