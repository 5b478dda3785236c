"""displacement/method.md, "Stage shade": normal, albedo, self-shadow and colour of one hit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from .patch import Camera, Light, Patch
from .raster import Texture
from .vectors import ZERO, Vec3, add, cross, dot, negate, normalize, scale, towards

SMALLEST_DIFFERENCE = 2.0**-16


@dataclass
class Shade:
    """The shade stage of one kept hit, and its colour."""

    albedo: Vec3
    normal: Vec3
    lit: bool
    lit_margin: float
    axis_margin: float
    facing_margin: float
    color: Vec3


def shade_hit(hit: Vec3, steep: bool, patch: Patch, camera: Camera, light: Light, params: Any) -> Shade:
    """All of the stage for the patch hit (u, v, h)."""
    world = patch.to_world(hit)
    axis_margin = math.inf
    if steep and patch.facade_map is not None:
        normal, albedo, axis_margin = facade_surface(hit, patch, patch.facade_map)
    else:
        normal = mapped_normal(hit, patch) if patch.normal_map is not None else height_normal(hit, patch)
        albedo = fetch_color(patch.color_map, hit[0], hit[1])
    lit, lit_margin = self_shadow(hit, patch, params)
    to_light = light.direction(world)
    facing = dot(normal, to_light)
    color = illuminate(albedo, normal, to_light, camera.direction_to_eye(world), facing, lit, light)
    return Shade(albedo, normal, lit, lit_margin, axis_margin, abs(facing), color)


def fetch_color(texture: Texture, u: float, v: float) -> Vec3:
    texel = texture.fetch(u, v)
    return texel[0], texel[1], texel[2]


# --- Normals and the facade ------------------------------------------------------------------------------------------


def slope(hit: Vec3, patch: Patch) -> tuple[float, float]:
    """(g_u, g_v): central differences of the height map; a difference below 2^-16 counts as 0."""
    u, v, _h = hit
    heights = patch.height_map
    step_u, step_v = 1.0 / heights.width, 1.0 / heights.height
    difference_u = heights.value(u + step_u, v) - heights.value(u - step_u, v)
    difference_v = heights.value(u, v + step_v) - heights.value(u, v - step_v)
    if abs(difference_u) < SMALLEST_DIFFERENCE:
        difference_u = 0.0
    if abs(difference_v) < SMALLEST_DIFFERENCE:
        difference_v = 0.0
    return difference_u * heights.width / 2.0, difference_v * heights.height / 2.0


def world_gradient(g_u: float, g_v: float, patch: Patch) -> Vec3:
    """g_u U* + g_v V*."""
    return add(scale(g_u, patch.u_row), scale(g_v, patch.v_row))


def height_normal(hit: Vec3, patch: Patch) -> Vec3:
    """normalize(n - s (g_u U* + g_v V*))."""
    g_u, g_v = slope(hit, patch)
    gradient = world_gradient(g_u, g_v, patch)
    n, s = patch.n, patch.s
    return normalize((n[0] - s * gradient[0], n[1] - s * gradient[1], n[2] - s * gradient[2]))


def mapped_normal(hit: Vec3, patch: Patch) -> Vec3:
    """The normal map at the hit, in the frame x = U / |U|, y = n x x, z = n; a zero vector gives n."""
    assert patch.normal_map is not None
    color = fetch_color(patch.normal_map, hit[0], hit[1])
    m = (2.0 * color[0] - 1.0, 2.0 * color[1] - 1.0, 2.0 * color[2] - 1.0)
    if m == ZERO:
        return patch.n
    x = normalize(patch.u_edge)
    y = cross(patch.n, x)
    return normalize(add(add(scale(m[0], x), scale(m[1], y)), scale(m[2], patch.n)))


def facade_surface(hit: Vec3, patch: Patch, facade: Texture) -> tuple[Vec3, Vec3, float]:
    """(normal, albedo, axis margin) of a steep hit with a facade map."""
    g_u, g_v = slope(hit, patch)
    if g_u != 0.0 or g_v != 0.0:
        normal = normalize(negate(world_gradient(g_u, g_v, patch)))
        side_u = abs(g_u) / patch.u_length
        side_v = abs(g_v) / patch.v_length
    else:
        d = towards(patch.eye, hit)
        normal = normalize(add(scale(d[0], patch.u_edge), scale(d[1], patch.v_edge)))
        if normal == ZERO:
            normal = patch.n
        side_u = abs(d[0]) * patch.u_length
        side_v = abs(d[1]) * patch.v_length
    distance = hit[1] * patch.v_length if side_u >= side_v else hit[0] * patch.u_length
    albedo = fetch_color(facade, distance / patch.tile_width, (-hit[2] * patch.s) / patch.tile_height)
    return normal, albedo, abs(side_u - side_v)


# --- Self-shadow -----------------------------------------------------------------------------------------------------


def self_shadow(hit: Vec3, patch: Patch, params: Any) -> tuple[bool, float]:
    """(lit, lit_margin); without samples everything is lit."""
    samples = params.shadow_steps
    if samples < 1:
        return True, math.inf
    if patch.light[2] <= 0.0:
        return False, math.inf
    floor = -1.0 if params.method == "relief" else 0.0
    direction = towards(patch.light, hit)
    tau = shadow_stretch(hit, direction, floor, patch)
    if tau <= 0.0:
        return True, math.inf
    q = (direction[0] * tau, direction[1] * tau, direction[2] * tau)
    lit, margin = True, math.inf
    for j in range(1, samples + 1):
        fraction = j / (samples + 1)
        height = patch.height_map.value(hit[0] + q[0] * fraction, hit[1] + q[1] * fraction)
        above = ((hit[2] + q[2] * fraction) - floor) + params.shadow_bias
        margin = min(margin, abs(above - height))
        if above < height:
            lit = False
    return lit, margin


def shadow_stretch(hit: Vec3, direction: Vec3, floor: float, patch: Patch) -> float:
    """How far (in units of the direction) the ray to the light stays in the solid's box, or until it is there."""
    if direction == ZERO:
        return 0.0
    stretches = []
    for axis in (0, 1, 2):
        low, high = (floor, floor + 1.0) if axis == 2 else (0.0, 1.0)
        if axis != 2 and patch.repeat:
            continue
        if direction[axis] > 0.0:
            stretches.append((high - hit[axis]) / direction[axis])
        elif direction[axis] < 0.0:
            stretches.append((low - hit[axis]) / direction[axis])
    if patch.light[3] == 1.0:
        stretches.append(1.0)
    return min(stretches)


# --- Colour ----------------------------------------------------------------------------------------------------------


def integer_power(base: float, exponent: int) -> float:
    """Repeated squaring, lowest bit first."""
    result = 1.0
    while exponent > 0:
        if exponent % 2 == 1:
            result *= base
        base *= base
        exponent //= 2
    return result


def illuminate(
    albedo: Vec3, normal: Vec3, to_light: Vec3, to_eye: Vec3, facing: float, lit: bool, light: Light
) -> Vec3:
    """clamp(albedo (ambient + diffuse lit max(0, n.l)) + specular lit max(0, r.v)^e)."""
    lit_factor = 1.0 if lit else 0.0
    power = 0.0
    if facing > 0.0:
        factor = 2.0 * facing
        reflected = (
            factor * normal[0] - to_light[0],
            factor * normal[1] - to_light[1],
            factor * normal[2] - to_light[2],
        )
        power = integer_power(max(0.0, dot(reflected, to_eye)), light.exponent)
    from_all_sides = light.ambient + (light.diffuse * lit_factor) * max(0.0, facing)
    highlight = (light.specular * lit_factor) * power
    r, g, b = (min(max(a * from_all_sides + highlight, 0.0), 1.0) for a in albedo)
    return r, g, b
