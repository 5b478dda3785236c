"""The vertex stage: transforms, Phong lighting and the splat law of one point (splatting/method.md, "Stage vertex")."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from .depth_image import affine, rows4
from .vectors import Vec3, Vec4, dot, normalize, sub, towards, vec3, vec4


class Placed(NamedTuple):
    """Where a point lands: window x, y, window depth and splat width; a dropped point has NaN and width 0."""

    x: float
    y: float
    depth: float
    width: float


DROPPED = Placed(math.nan, math.nan, math.nan, 0.0)


def view_of(camera: Any, p: Vec3) -> Vec4:
    """T_W->C: world point to view space, all four rows (stage vertex)."""
    m = rows4(camera.view_from_world)
    return affine(m[0], p), affine(m[1], p), affine(m[2], p), affine(m[3], p)


def clip_of(camera: Any, q: Vec4) -> Vec4:
    """T_P: view space to clip space, each row with all four components (stage vertex)."""
    m = rows4(camera.clip_from_view)
    return (
        m[0][0] * q[0] + m[0][1] * q[1] + m[0][2] * q[2] + m[0][3] * q[3],
        m[1][0] * q[0] + m[1][1] * q[1] + m[1][2] * q[2] + m[1][3] * q[3],
        m[2][0] * q[0] + m[2][1] * q[1] + m[2][2] * q[2] + m[2][3] * q[3],
        m[3][0] * q[0] + m[3][1] * q[1] + m[3][2] * q[2] + m[3][3] * q[3],
    )


def eye_distance(camera: Any, p: Vec3, view: Vec4) -> float:
    """d of the law: Euclidean from the eye to the point; orthographic: the depth along the view axis (stage vertex)."""
    if not camera.perspective:
        return -view[2]
    q = sub(p, vec3(camera.eye))
    return math.sqrt(dot(q, q))


def splat_width(params: Any, d: float, vertex: int) -> float:
    """W_s = alpha / (beta d^2 + gamma d + delta), clamped to [min_width, max_width] (stage vertex)."""
    denominator = float(params.beta) * (d * d) + float(params.gamma) * d + float(params.delta)
    if not denominator > 0.0:
        raise ValueError(f"params.beta, gamma, delta: denominator {denominator} at vertex {vertex} is not positive")
    width = float(params.alpha) / denominator
    return max(float(params.min_width), min(float(params.max_width), width))


def place(camera: Any, params: Any, p: Vec3, vertex: int) -> Placed:
    """Window position, depth and width of a world point, or DROPPED outside 0 <= z <= w, w > 0 (stage vertex)."""
    view = view_of(camera, p)
    x, y, z, w = clip_of(camera, view)
    if not (w > 0.0 and 0.0 <= z <= w):
        return DROPPED
    window_x = ((x / w + 1.0) / 2.0) * float(camera.width)
    window_y = ((1.0 - y / w) / 2.0) * float(camera.height)
    return Placed(window_x, window_y, z / w, splat_width(params, eye_distance(camera, p, view), vertex))


def power(base: float, exponent: int) -> float:
    """Integer power by repeated squaring (conventions.md, "Numbers")."""
    result = 1.0
    while exponent:
        if exponent % 2 == 1:
            result *= base
        base *= base
        exponent //= 2
    return result


def light_source(light: Any) -> Vec4:
    """The light as a homogeneous source: a position (w = 1) or a direction towards it, normalized (w = 0)."""
    position = getattr(light, "position", None)
    if position is not None:
        p = vec3(position)
        return p[0], p[1], p[2], 1.0
    d = normalize(vec3(light.direction))
    return d[0], d[1], d[2], 0.0


def unit_towards(source: Vec4, p: Vec3) -> Vec3:
    """The unit vector from the point towards a light or an eye (stage vertex); a direction, w = 0, is one already."""
    if source[3] == 0.0:
        return source[0], source[1], source[2]
    return normalize(towards(source, p))


def per_channel(value: Any) -> Vec3:
    """A light's coefficient for each channel: three numbers, or one number for all."""
    if hasattr(value, "__len__"):
        return vec3(value)
    return float(value), float(value), float(value)


def highlight(n: Vec3, l: Vec3, v: Vec3, n_dot_l: float, exponent: int) -> float:
    """max(0, r.v)^e where n.l > 0, else 0; r = 2(n.l)n - l (stage vertex)."""
    if not n_dot_l > 0.0:
        return 0.0
    twice = 2.0 * n_dot_l
    r = (twice * n[0] - l[0], twice * n[1] - l[1], twice * n[2] - l[2])
    return power(max(0.0, dot(r, v)), exponent)


def lit_color(albedo: Vec3, n: Vec3, p: Vec3, light: Any, camera: Any) -> Vec3:
    """The stored colour without a light, else Phong clamped to [0, 1] (stage vertex)."""
    if light is None:
        return albedo
    l = unit_towards(light_source(light), p)
    v = unit_towards(vec4(camera.eye), p)
    n_dot_l = dot(n, l)
    shine = highlight(n, l, v, n_dot_l, int(light.exponent))
    ambient, diffuse, specular = per_channel(light.ambient), per_channel(light.diffuse), per_channel(light.specular)
    lit = [0.0, 0.0, 0.0]
    for i in range(3):
        value = albedo[i] * (ambient[i] + diffuse[i] * max(0.0, n_dot_l)) + specular[i] * shine
        lit[i] = max(0.0, min(1.0, value))
    return lit[0], lit[1], lit[2]
