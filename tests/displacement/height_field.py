"""Where a ray enters the solid piecewise-bilinear height field, in rational numbers: no lattice, no rounding."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = tuple[Fraction, Fraction, Fraction]
Polynomial = tuple[Fraction, Fraction, Fraction]
"""c, b, a of a t^2 + b t + c."""

HALF = Fraction(1, 2)


class Ray(NamedTuple):
    """(u, v, h)(t) = start + t (end - start) for t in [first, last]."""

    start: Point
    end: Point
    first: Fraction
    last: Fraction

    def at(self, t: Fraction) -> Point:
        return tuple(a + t * (b - a) for a, b in zip(self.start, self.end, strict=True))  # type: ignore[return-value]


def rational(values: Array) -> Point:
    u, v, h = (Fraction(x) for x in values)
    return u, v, h


def towards(eye: Array, c: Array) -> Point:
    """The view ray's direction at c, up to the eye: homogeneous, as rulings have it."""
    w = Fraction(eye[3])
    u, v, h = (Fraction(e) - w * Fraction(x) for e, x in zip(eye[:3], c, strict=True))
    return u, v, h


def paper_ray(eye: Array, c: Array, bounded: bool) -> Ray | None:
    """From the plane h = 1 to h = 0 through c; `bounded`: only where (u, v) is in the unit square. None: nothing left."""
    p, v = rational(c), towards(eye, c)
    if v[2] <= 0:
        return None
    start = tuple(x + d * ((1 - p[2]) / v[2]) for x, d in zip(p, v, strict=True))
    end = tuple(x - d * (p[2] / v[2]) for x, d in zip(p, v, strict=True))
    first, last = Fraction(0), Fraction(1)
    for a, b in zip(start[:2], end[:2], strict=True):
        if not bounded:
            break
        if a == b:
            if not 0 <= a <= 1:
                return None
            continue
        crossings = sorted(((0 - a) / (b - a), (1 - a) / (b - a)))
        first, last = max(first, crossings[0]), min(last, crossings[1])
    return Ray(start, end, first, last) if first <= last else None  # type: ignore[arg-type]


def volume_ray(eye: Array, c: Array) -> Ray:
    """From where the ray enters the unit cube, or from the eye inside it, to c."""
    end, v = rational(c), towards(eye, c)
    taus = [((1 if d > 0 else 0) - x) / d for x, d in zip(end, v, strict=True) if d != 0]
    tau = min([*taus, Fraction(1)] if eye[3] == 1 else taus)
    start = tuple(x + tau * d for x, d in zip(end, v, strict=True))
    return Ray(start, end, Fraction(0), Fraction(1))  # type: ignore[arg-type]


def texel(heights: Array, column: int, row: int, repeat: bool) -> Fraction:
    rows, columns = heights.shape
    if repeat:
        return Fraction(heights[row % rows, column % columns])
    return Fraction(heights[min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)])


def breaks(ray: Ray, shape: tuple[int, ...]) -> list[Fraction]:
    """Where the ray crosses a line through texel centres; the ray's own ends too."""
    rows, columns = shape
    result = {ray.first, ray.last}
    for axis, size in ((0, columns), (1, rows)):
        a, b = (p[axis] * size - HALF for p in (ray.start, ray.end))
        ends = sorted(a + (b - a) * t for t in (ray.first, ray.last))
        if a != b:
            result |= {(k - a) / (b - a) for k in range(math.ceil(ends[0]), math.floor(ends[1]) + 1)}
    return sorted(result)


def product(p: tuple[Fraction, Fraction], q: tuple[Fraction, Fraction]) -> Polynomial:
    """(p0 + p1 t)(q0 + q1 t)."""
    return p[0] * q[0], p[0] * q[1] + p[1] * q[0], p[1] * q[1]


def depth_inside(heights: Array, ray: Ray, first: Fraction, last: Fraction, repeat: bool) -> Polynomial | None:
    """H - h along the ray, as a polynomial in t, valid between two breaks; None where the ray is above all four texels."""
    rows, columns = heights.shape
    middle = (first + last) / 2
    lines = []
    for axis, size in ((0, columns), (1, rows)):
        a, b = (p[axis] * size - HALF for p in (ray.start, ray.end))
        cell = math.floor(a + (b - a) * middle)
        lines.append((cell, (a - cell, b - a)))
    (column, x), (row, y) = lines
    t00, t10 = texel(heights, column, row, repeat), texel(heights, column + 1, row, repeat)
    t01, t11 = texel(heights, column, row + 1, repeat), texel(heights, column + 1, row + 1, repeat)
    xy = product(x, y)
    if max(t00, t10, t01, t11) < min(ray.at(first)[2], ray.at(last)[2]):
        return None
    across, along, twist = t10 - t00, t01 - t00, t11 - t10 - t01 + t00
    return (
        t00 + across * x[0] + along * y[0] + twist * xy[0] - ray.start[2],
        across * x[1] + along * y[1] + twist * xy[1] - (ray.end[2] - ray.start[2]),
        twist * xy[2],
    )


def root(x: Fraction) -> Fraction:
    """Square root, to 100 bits behind the point or better."""
    shift = 2**100
    return Fraction(math.isqrt(x.numerator * x.denominator * shift**2), x.denominator * shift)


def value(p: Polynomial, t: Fraction) -> Fraction:
    return p[0] + t * (p[1] + t * p[2])


def becomes_positive(p: Polynomial, first: Fraction, last: Fraction) -> Fraction | None:
    """The smallest t in [first, last] behind which p > 0 (or at which, if that is `first`)."""
    c, b, a = p
    if value(p, first) > 0:
        return first
    if a == 0:
        roots = [-c / b] if b != 0 else []
    else:
        discriminant = b * b - 4 * a * c
        roots = sorted((-b + sign * root(discriminant)) / (2 * a) for sign in (-1, 1)) if discriminant > 0 else []
    rising = [t for t in roots if first <= t < last and b + 2 * a * t > 0]
    return rising[0] if rising else None


def first_inside(heights: Array, ray: Ray | None, repeat: bool = False) -> Fraction | None:
    """The smallest t at which the ray is inside the solid or enters it; None: it stays outside."""
    if ray is None:
        return None
    for first, last in pairwise(breaks(ray, heights.shape)):
        inside = depth_inside(heights, ray, first, last, repeat)
        t = None if inside is None else becomes_positive(inside, first, last)
        if t is not None:
            return t
    return None
