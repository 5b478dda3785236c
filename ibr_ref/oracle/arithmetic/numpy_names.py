"""NumPy's names for the operations of `Bounds`: by NEP 13 and NEP 18 a program calls them on `Number`s as on arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic.number import Number, Truth
from ibr_ref.oracle.arithmetic.symbols import all_of, over_symbols


def _where(ops: Any, condition: Any, a: Any, b: Any) -> Any:
    lane = condition.lane if isinstance(condition, Truth) else None
    condition = np.asarray(condition)
    if isinstance(a, Truth) or isinstance(b, Truth):
        a, b = (x if isinstance(x, Truth) else Truth(ops, x, x, None) for x in (a, b))
        may, must = np.where(condition, a._may, b._may), np.where(condition, a._must, b._must)
        return Truth(ops, may, must, ops.lane(a, b) if lane is None else lane)
    if isinstance(a, Number) or isinstance(b, Number):
        found = ops.where(condition, a, b)
        found.lane = found.lane if found.lane is not None else lane
        return found
    chosen = np.where(condition, a, b)
    return chosen if chosen.dtype.kind in "ib" else Number(ops, chosen, np.zeros(chosen.shape), {}, lane)


def _stack(ops: Any, parts: Any, axis: int = 0) -> Any:
    return _column(parts, np.stack, axis)


def _column(parts: Any, put: Callable[..., Any], axis: int) -> Number:
    """Several numbers in one, side by side or one after the other."""
    ops = next(x.ops for x in parts if isinstance(x, Number))
    numbers = [ops.of(x) for x in parts]
    names = all_of(*(x.names for x in numbers))
    rows = [over_symbols(x.rows, x.names, names) for x in numbers]
    found = put(rows, axis=axis + 1 if axis >= 0 else axis)
    return Number.of_rows(ops, found, names, ops.lane(*numbers))


def _concatenate(ops: Any, parts: Any, axis: int = 0) -> Number:
    """One after the other: each row belongs to the run that it came from."""
    found = _column(parts, np.concatenate, axis)
    lanes: list[Any] = [getattr(x, "lane", None) for x in parts]
    if axis == 0 and all(lane is not None for lane in lanes):
        found.lane = np.concatenate(lanes)
    return found


def _roll(ops: Any, x: Any, shift: int, axis: int = 0) -> Any:
    return x.each(lambda v: np.roll(v, shift, axis), x.lane)


def _any(ops: Any, x: Any, **named: Any) -> Any:
    return np.any(np.asarray(x), **named)


FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: _where,
    np.clip: lambda ops, x, low, high: ops.rising(lambda v: np.clip(v, low, high), x),
    np.stack: _stack,
    np.concatenate: _concatenate,
    np.broadcast_to: lambda ops, x, shape: x.each(lambda v: np.broadcast_to(v, shape), x.lane),
    np.broadcast_arrays: lambda ops, *parts: parts,
    np.shape: lambda ops, x: x.shape,
    np.ndim: lambda ops, x: len(x.shape),
    np.roll: _roll,
    np.zeros_like: lambda ops, x: np.zeros(x.shape),
    np.ones_like: lambda ops, x: np.ones(x.shape),
    np.flatnonzero: lambda ops, x: np.flatnonzero(np.asarray(x)),
    np.any: _any,
}


def _power(ops: Any, a: Any, b: float) -> Any:
    """A power that is no whole one, of a number >= 0: 16 units, as exp2 and log2 are granted."""
    return ops.rounded(ops.rising(lambda v: np.maximum(v, 0.0) ** b, a), 16.0)


UFUNCS: dict[Any, Callable[..., Any]] = {
    np.add: lambda ops, a, b: ops.add(a, b),
    np.subtract: lambda ops, a, b: ops.subtract(a, b),
    np.multiply: lambda ops, a, b: ops.multiply(a, b),
    np.divide: lambda ops, a, b: ops.divide(a, b),
    np.negative: lambda ops, a: ops.negative(a),
    np.absolute: lambda ops, a: ops.absolute(a),
    np.maximum: lambda ops, a, b: ops.greatest(a, b),
    np.minimum: lambda ops, a, b: ops.least(a, b),
    np.sqrt: lambda ops, a: ops.root(a),
    np.floor: lambda ops, a: ops.rising(np.floor, a),
    np.ceil: lambda ops, a: ops.rising(np.ceil, a),
    np.rint: lambda ops, a: ops.rising(np.rint, a),
    np.power: _power,
    np.isfinite: lambda ops, a: np.isfinite(a.value),
    np.less: lambda ops, a, b: ops.of(a) < b,
    np.greater: lambda ops, a, b: ops.of(a) > b,
    np.less_equal: lambda ops, a, b: ops.of(a) <= b,
    np.greater_equal: lambda ops, a, b: ops.of(a) >= b,
    np.equal: lambda ops, a, b: ops.of(a) == b,
    np.not_equal: lambda ops, a, b: ops.of(a) != b,
    np.bitwise_and: lambda ops, a, b: a & b if isinstance(a, Truth) else b & a,
    np.bitwise_or: lambda ops, a, b: a | b if isinstance(a, Truth) else b | a,
    np.invert: lambda ops, a: ~a,
    np.logical_not: lambda ops, a: ~a,
}
