"""Operations on two numbers.

a, b: (3 + K', n) rows, or (3 + K', 1) of a number that is the same everywhere. at_a, at_b: (K,) for each symbol of the
result the row of its slope in a and in b, -1 where it has none. units: of the rounding, or EXACT. result, and what is
returned: (3 + K, n). total: (3 + K, n) a sum, of terms whose sizes are added up in size (n,).
"""

from __future__ import annotations

import numpy as np

from ibr_ref.affine.rows import DEVIATION, ERROR, SLOPES, VALUE, deviate, finish
from ibr_ref.array_types import Floats, Ints
from ibr_ref.jit import device, routine


@device
def _blank(a: Floats, b: Floats, symbols: int) -> Floats:
    n = b.shape[1] if a.shape[1] == 1 else a.shape[1]
    return np.empty((SLOPES + symbols, n))


@device
def _step(a: Floats, n: int) -> int:
    """From one element to the next: 0 of what is the same everywhere."""
    return 0 if a.shape[1] == 1 and n != 1 else 1


@routine
def plus(a: Floats, b: Floats, at_a: Ints, at_b: Ints, sign: float, units: float) -> Floats:
    """A + b, or a - b."""
    result = _blank(a, b, len(at_a))
    n = result.shape[1]
    p, q = _step(a, n), _step(b, n)
    for i in range(n):
        result[VALUE, i] = a[VALUE, p * i] + sign * b[VALUE, q * i]
        result[ERROR, i] = a[ERROR, p * i] + b[ERROR, q * i]
    for k in range(len(at_a)):
        row, s, t = SLOPES + k, at_a[k], at_b[k]
        for i in range(n):
            along = a[s, p * i] if s >= 0 else 0.0
            result[row, i] = along + sign * b[t, q * i] if t >= 0 else along
    finish(result, units)
    return result


@device
def _multiply(a: Floats, b: Floats, at_a: Ints, at_b: Ints, units: float, result: Floats) -> None:
    """(a + d) (b + e) = a b + a e + d b + d e; of deviations d e no symbol says anything."""
    n = result.shape[1]
    p, q = _step(a, n), _step(b, n)
    for i in range(n):
        x, y = a[VALUE, p * i], b[VALUE, q * i]
        error = abs(x) * b[ERROR, q * i] + a[ERROR, p * i] * abs(y) + a[DEVIATION, p * i] * b[DEVIATION, q * i]
        result[VALUE, i] = x * y
        result[ERROR, i] = np.inf if np.isnan(error) else error  # nothing, times what has no end
    for k in range(len(at_a)):
        row, s, t = SLOPES + k, at_a[k], at_b[k]
        if s >= 0 and t >= 0:
            for i in range(n):
                result[row, i] = a[s, p * i] * b[VALUE, q * i] + a[VALUE, p * i] * b[t, q * i]
        elif s >= 0:
            for i in range(n):
                result[row, i] = a[s, p * i] * b[VALUE, q * i]
        elif t >= 0:
            for i in range(n):
                result[row, i] = a[VALUE, p * i] * b[t, q * i]
        else:
            for i in range(n):
                result[row, i] = 0.0
    finish(result, units)


@routine
def times(a: Floats, b: Floats, at_a: Ints, at_b: Ints, units: float) -> Floats:
    """A b."""
    result = _blank(a, b, len(at_a))
    _multiply(a, b, at_a, at_b, units, result)
    return result


@routine
def over(a: Floats, b: Floats, at_a: Ints, at_b: Ints, units: float) -> Floats:
    """A / b: (a - q b) / b with q = the quotient of the values, to first order over b's value."""
    result = _blank(a, b, len(at_a))
    n = result.shape[1]
    p, q = _step(a, n), _step(b, n)
    along = np.empty(n)
    for i in range(n):
        value = a[VALUE, p * i] / b[VALUE, q * i]
        result[VALUE, i] = value
        result[ERROR, i] = (a[ERROR, p * i] + abs(value) * b[ERROR, q * i]) / abs(b[VALUE, q * i])
        along[i] = result[ERROR, i]
    for k in range(len(at_a)):
        row, s, t = SLOPES + k, at_a[k], at_b[k]
        for i in range(n):
            up = a[s, p * i] if s >= 0 else 0.0
            down = b[t, q * i] if t >= 0 else 0.0
            result[row, i] = (up - result[VALUE, i] * down) / b[VALUE, q * i]
            along[i] += abs(result[row, i])
    for i in range(n):
        off = b[DEVIATION, q * i]
        room = abs(b[VALUE, q * i]) - off
        error = result[ERROR, i] + along[i] * off / room if room > 0.0 else np.inf
        if not np.isfinite(error):
            for k in range(len(at_a)):
                result[SLOPES + k, i] = 0.0
        result[ERROR, i] = np.inf if np.isnan(error) else error
    finish(result, units)
    return result


@routine
def either(a: Floats, b: Floats, at_a: Ints, at_b: Ints) -> Floats:
    """Two legal forms of one thing: the first one's value and slopes, and an error that covers both.

    at_a: of all symbols, those of a first and in its order.
    """
    result = _blank(a, b, len(a) - SLOPES)
    n = result.shape[1]
    p, q = _step(a, n), _step(b, n)
    spread = np.empty(n)
    for i in range(n):
        result[VALUE, i] = a[VALUE, p * i]
        spread[i] = abs(b[VALUE, q * i] - a[VALUE, p * i]) + b[ERROR, q * i]
    for k in range(len(at_a)):
        s, t = at_a[k], at_b[k]
        for i in range(n):
            mine = a[s, p * i] if s >= 0 else 0.0
            other = b[t, q * i] if t >= 0 else 0.0
            if s >= 0:
                result[s, i] = mine
            spread[i] += abs(other - mine)
    for i in range(n):
        wide = np.inf if np.isnan(spread[i]) else spread[i]
        result[ERROR, i] = max(a[ERROR, p * i], wide)
    deviate(result)
    return result


@routine
def add_product(
    total: Floats, size: Floats, a: Floats, b: Floats, at_a: Ints, at_b: Ints, units: float, term: Floats
) -> None:
    """A b more in a sum. term: (3 + K, n) room."""
    _multiply(a, b, at_a, at_b, units, term)
    _gather(total, size, term, np.arange(SLOPES, len(term)))


@routine
def add_number(total: Floats, size: Floats, a: Floats, at_a: Ints) -> None:
    """A number more in a sum."""
    _gather(total, size, a, at_a)


@device
def _gather(total: Floats, size: Floats, a: Floats, at_a: Ints) -> None:
    n = total.shape[1]
    p = _step(a, n)
    for i in range(n):
        size[i] += abs(a[VALUE, p * i]) + a[DEVIATION, p * i]
        total[VALUE, i] += a[VALUE, p * i]
        total[ERROR, i] += a[ERROR, p * i]
    for k in range(len(at_a)):
        if at_a[k] >= 0:
            for i in range(n):
                total[SLOPES + k, i] += a[at_a[k], p * i]


@routine
def sum_up(total: Floats, size: Floats, roundings: float) -> None:
    """The deviation of a sum of sizes, after so many roundings of it, relative."""
    for i in range(total.shape[1]):
        if roundings > 0.0:
            total[ERROR, i] += roundings * size[i]
    deviate(total)
