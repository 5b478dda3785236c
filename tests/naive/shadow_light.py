"""The light of shadows/method.md, "Light samples": its camera, its samples, and coordinates on the two offset axes."""

from __future__ import annotations

from decimal import Decimal, localcontext
from typing import Any, NamedTuple

from .vectors import Vec3, Vec4, add, cross, dot, negate, normalize, scale, sub, vec3

Pair = tuple[float, float]
Rows = tuple[Vec4, Vec4, Vec4, Vec4]

DIGITS = 60
TWO_THIRDS = 2.0 / 3.0
BIAS: Rows = ((0.5, 0.0, 0.0, 0.5), (0.0, -0.5, 0.0, 0.5), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
"""NDC to (s, t, r): [0, 1]^2 of the map, t downwards (stage project)."""


class LightCamera(NamedTuple):
    """The two matrices of the light, seen from one of its samples, as rows."""

    view_from_world: Rows
    clip_from_view: Rows


class Sample(NamedTuple):
    """One light sample: where it is, and how far that is from the centre along the two offset axes."""

    position: Vec3
    displacement: Pair


# --- Tangent ---------------------------------------------------------------------------------------------------------


def alternating_series(first: Decimal, step: Decimal, start: int) -> Decimal:
    """first - first step / (n (n + 1)) + ..., n = start, start + 2, ...: sine and cosine, by the power of `first`."""
    total, term, n = first, first, start
    while abs(term) > Decimal(10) ** -DIGITS:
        term = -term * step / (n * (n + 1))
        total += term
        n += 2
    return total


def inverse_tangent_of_one_over(n: int) -> Decimal:
    """atan(1/n) by its power series."""
    power, total, k = Decimal(1) / n, Decimal(0), 1
    while power > Decimal(10) ** -DIGITS:
        total += power / k if k % 4 == 1 else -power / k
        power /= n * n
        k += 2
    return total


def tangent(degrees: float) -> float:
    """tan of an angle from 0 to 90 degrees, in 60 decimal digits and rounded once; pi by Machin's formula."""
    with localcontext() as context:
        context.prec = DIGITS + 15
        pi = 16 * inverse_tangent_of_one_over(5) - 4 * inverse_tangent_of_one_over(239)
        x = Decimal(degrees) * pi / 180
        sine = alternating_series(x, x * x, 2)
        cosine = alternating_series(Decimal(1), x * x, 1)
        return float(sine / cosine)


# --- Camera ----------------------------------------------------------------------------------------------------------


def view_axes(light: Any) -> tuple[Vec3, Vec3, Vec3]:
    """The view's +x, +y and +z in world space: right-handed, looking down -z (conventions.md, "In short")."""
    forward = sub(vec3(light.target), vec3(light.position))
    right = normalize(cross(forward, vec3(light.up)))
    forward = normalize(forward)
    return right, cross(right, forward), negate(forward)


def view_from_world(axes: tuple[Vec3, Vec3, Vec3], position: Vec3) -> Rows:
    """The view matrix of a light at `position`."""
    x, y, z = ((*axis, -dot(axis, position)) for axis in axes)
    return x, y, z, (0.0, 0.0, 0.0, 1.0)


def clip_from_view(light: Any) -> Rows:
    """Square perspective projection, NDC z in [0, 1] and 0 at the near plane (conventions.md, "In short")."""
    near, far = float(light.near), float(light.far)
    focal = 1.0 / tangent(float(light.vertical_fov) / 2.0)
    return (
        (focal, 0.0, 0.0, 0.0),
        (0.0, focal, 0.0, 0.0),
        (0.0, 0.0, far / (near - far), (near * far) / (near - far)),
        (0.0, 0.0, -1.0, 0.0),
    )


def camera_at(light: Any, position: Vec3) -> LightCamera:
    """The light's camera at one of its samples: it looks the same way as at the centre (stage accumulate)."""
    return LightCamera(view_from_world(view_axes(light), position), clip_from_view(light))


def transform(rows: Rows, p: Vec4) -> Vec4:
    """Matrix times column, each row summed from left to right (conventions.md, "Triangles")."""
    x, y, z, w = (row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3] * p[3] for row in rows)
    return x, y, z, w


# --- Samples ---------------------------------------------------------------------------------------------------------


def on_axes(v: Vec3, axes: Any) -> Pair:
    """The (x, y) with x a + y b nearest to v; for orthonormal axes simply (v.a, v.b)."""
    a, b = vec3(axes[0]), vec3(axes[1])
    aa, ab, bb = dot(a, a), dot(a, b), dot(b, b)
    va, vb = dot(v, a), dot(v, b)
    determinant = aa * bb - ab * ab
    return (bb * va - ab * vb) / determinant, (aa * vb - ab * va) / determinant


def sample_factors(count: int) -> list[Pair]:
    """(g_i, g_j) of the built-in sample patterns, the centre first ("Inputs", Light)."""
    if count == 1:
        return [(0.0, 0.0)]
    if count == 5:
        steps = [-TWO_THIRDS, TWO_THIRDS]
    elif count == 9:
        steps = [-TWO_THIRDS, 0.0, TWO_THIRDS]
    else:
        raise ValueError(f"light_samples: found {count}, allowed: 1, 5, 9 or a list of positions")
    around = [(g_i, g_j) for g_j in steps for g_i in steps]
    return [(0.0, 0.0), *(pair for pair in around if pair != (0.0, 0.0))]


def sample_positions(light: Any, light_samples: Any) -> list[Vec3]:
    """World positions of the light samples ("Inputs", Light)."""
    if hasattr(light_samples, "__len__"):
        return [vec3(position) for position in light_samples]
    centre = vec3(light.position)
    positions = []
    for g_i, g_j in sample_factors(int(light_samples)):
        if (g_i, g_j) == (0.0, 0.0):
            positions.append(centre)
        else:
            a, b = vec3(light.half_edges[0]), vec3(light.half_edges[1])
            positions.append(add(centre, add(scale(g_i, a), scale(g_j, b))))
    return positions


def light_samples_of(scene: Any, params: Any) -> list[Sample]:
    """The samples in use, in order."""
    centre = vec3(scene.light.position)
    positions = sample_positions(scene.light, params.light_samples)
    return [Sample(p, on_axes(sub(p, centre), scene.offset_axes)) for p in positions]
