"""Affine numbers one at a time, by the definitions: (value, error, {symbol: slope}), and what operations make of two."""

from __future__ import annotations

import math

Affine = tuple[float, float, dict[str, float]]


def deviation(x: Affine) -> float:
    """How far it may be from its value."""
    off = x[1]
    for slope in x[2].values():
        off += abs(slope)
    return math.inf if x[2] and math.isnan(off) else off


def rounded(x: Affine, units: float) -> Affine:
    """After a rounding to float32 of so many units in the last place."""
    size = abs(x[0]) + deviation(x)
    added = units * 2.0**-24 * size + (2.0**-126 if size > 0.0 else 0.0)
    return x[0], x[1] + added, x[2]


def plus(a: Affine, b: Affine, sign: float = 1.0) -> Affine:
    """A + b, or a - b."""
    slopes = {k: a[2].get(k, 0.0) + sign * b[2].get(k, 0.0) for k in {**a[2], **b[2]}}
    return a[0] + sign * b[0], a[1] + b[1], slopes


def times(a: Affine, b: Affine) -> Affine:
    """A b; what both deviate belongs to no symbol."""
    slopes = {k: a[2].get(k, 0.0) * b[0] + a[0] * b[2].get(k, 0.0) for k in {**a[2], **b[2]}}
    error = abs(a[0]) * b[1] + a[1] * abs(b[0]) + deviation(a) * deviation(b)
    return a[0] * b[0], error, slopes


def over(a: Affine, b: Affine) -> Affine:
    """A / b = q + (a - q b) / b, to first order; anything where b may be 0."""
    q, off = a[0] / b[0], deviation(b)
    if abs(b[0]) <= off:
        return q, math.inf, dict.fromkeys({**a[2], **b[2]}, 0.0)
    slopes = {k: (a[2].get(k, 0.0) - q * b[2].get(k, 0.0)) / b[0] for k in {**a[2], **b[2]}}
    linear = (a[1] + abs(q) * b[1]) / abs(b[0])
    return q, linear + (linear + sum(map(abs, slopes.values()))) * off / (abs(b[0]) - off), slopes


def either(a: Affine, b: Affine) -> Affine:
    """Two forms of one thing: the first one's value and slopes, an error that covers both."""
    away = plus(b, a, -1.0)
    spread = abs(away[0]) + b[1] + sum(map(abs, away[2].values()))
    return a[0], max(a[1], spread), a[2]


def total(terms: list[Affine], units: float) -> Affine:
    """A sum in any order: as many roundings of the sum of the sizes."""
    found = terms[0]
    for term in terms[1:]:
        found = plus(found, term)
    size = sum(abs(t[0]) + deviation(t) for t in terms)
    return found[0], found[1] + (len(terms) * units * 2.0**-24 * size if len(terms) > 1 else 0.0), found[2]
