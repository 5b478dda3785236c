"""Three-vectors as tuples of Python floats; every sum from left to right (conventions.md, "Triangles")."""

from __future__ import annotations

import math
from typing import Any

Vec3 = tuple[float, float, float]
Vec4 = tuple[float, float, float, float]

ZERO: Vec3 = (0.0, 0.0, 0.0)


def vec3(values: Any) -> Vec3:
    """Three plain Python floats from any sequence."""
    return float(values[0]), float(values[1]), float(values[2])


def vec4(values: Any) -> Vec4:
    """Four plain Python floats from any sequence."""
    return float(values[0]), float(values[1]), float(values[2]), float(values[3])


def add(a: Vec3, b: Vec3) -> Vec3:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def sub(a: Vec3, b: Vec3) -> Vec3:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scale(s: float, a: Vec3) -> Vec3:
    return s * a[0], s * a[1], s * a[2]


def divide(a: Vec3, s: float) -> Vec3:
    return a[0] / s, a[1] / s, a[2] / s


def negate(a: Vec3) -> Vec3:
    return -a[0], -a[1], -a[2]


def cross(a: Vec3, b: Vec3) -> Vec3:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vec3, b: Vec3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length(a: Vec3) -> float:
    return math.sqrt(dot(a, a))


def normalize(a: Vec3) -> Vec3:
    """Each component divided by the length; the zero vector stays the zero vector."""
    size = length(a)
    if size == 0.0:
        return a
    return divide(a, size)


def towards(source: Vec4, p: Vec3) -> Vec3:
    """The vector from the point p towards a homogeneous source (w = 1 a point, 0 a direction): xyz - w p."""
    w = source[3]
    return source[0] - w * p[0], source[1] - w * p[1], source[2] - w * p[2]
