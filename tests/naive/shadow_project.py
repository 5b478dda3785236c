"""shadows/method.md, "Stage project": a map on the visible surface, and how close each pixel came to another outcome."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .raster import Texture, float_floor, lerp, texel_index, wrap
from .shadow_light import BIAS, LightCamera, transform
from .shadow_surface import Fragment, Surface
from .vectors import Vec3


class Projected(NamedTuple):
    """The stage "project" of one light sample."""

    coord: np.ndarray
    shadow: np.ndarray
    margin: np.ndarray
    texel_margin: np.ndarray


class Lookup(NamedTuple):
    """What the map says of one point; `margin` is infinite where nothing is compared."""

    shadow: float
    margin: float


LIT = Lookup(0.0, math.inf)


# --- Coordinates -----------------------------------------------------------------------------------------------------


def quotient(a: float, b: float) -> float:
    """a / b as IEEE has it."""
    if b == 0.0:
        return math.nan if a == 0.0 or math.isnan(a) else math.copysign(math.inf, a) * math.copysign(1.0, b)
    return a / b


def map_coordinate(world: Vec3, camera: LightCamera) -> tuple[Vec3, float]:
    """((s, t, r), q_w): V, P and the bias matrix applied in turn, divided by q_w, r clamped to [0, 1]."""
    view = transform(camera.view_from_world, (*world, 1.0))
    q = transform(BIAS, transform(camera.clip_from_view, view))
    s, t, r = (quotient(component, q[3]) for component in q[:3])
    return (s, t, min(max(r, 0.0), 1.0)), q[3]


def falls_on_map(coord: Vec3, q_w: float) -> bool:
    """In front of the light, and in the map, its border included; elsewhere everything is lit."""
    return q_w > 0.0 and 0.0 <= coord[0] <= 1.0 and 0.0 <= coord[1] <= 1.0


def texel_margin(coord: Vec3, q_w: float, size: int) -> float:
    """Distance from (s, t) to the next texel's edge in texels, on the nearer axis; no texel behind the light."""
    if not q_w > 0.0:
        return math.inf
    margin = math.inf
    for value in coord[:2]:
        x = value * size
        f = x - float_floor(x)
        margin = min(margin, f, 1.0 - f)
    return margin


# --- Comparisons -----------------------------------------------------------------------------------------------------


def to_8_bits(x: float) -> int:
    """floor(255 x + 0.5)."""
    return math.floor(255.0 * x + 0.5)


def rounding_margin(x: float) -> float:
    """Distance, in units of x, to where floor(255 x + 0.5) changes."""
    y = 255.0 * x + 0.5
    f = y - float_floor(y)
    return min(f, 1.0 - f) / 255.0


def compare(r: float, texel: float, params: Any) -> Lookup:
    """In shadow where r - bias > texel, both rounded to 8 bits first with quantize=8."""
    side = r - float(params.bias)
    if params.quantize is None:
        return Lookup(1.0 if side > texel else 0.0, abs(side - texel))
    if int(params.quantize) != 8:
        raise ValueError(f"quantize: {params.quantize!r} is neither None nor 8")
    shadow = 1.0 if to_8_bits(side) > to_8_bits(texel) else 0.0
    return Lookup(shadow, min(rounding_margin(side), rounding_margin(texel)))


def nearest_texel(texture: Texture, s: float, t: float) -> float:
    """Texel floor(s S), floor(t S), clamped."""
    column = wrap(texel_index(float_floor(s * texture.width)), texture.width, False)
    row = wrap(texel_index(float_floor(t * texture.height)), texture.height, False)
    return texture.rows[row][column][0]


def four_comparisons(texture: Texture, coord: Vec3, params: Any) -> Lookup:
    """pcf: the bilinear mix of the four comparisons, and the smallest of their margins."""
    s, t, r = coord
    x = s * texture.width - 0.5
    y = t * texture.height - 0.5
    x0, y0 = math.floor(x), math.floor(y)
    looks = []
    for row in (y0, y0 + 1):
        for column in (x0, x0 + 1):
            texels = texture.rows[wrap(row, texture.height, False)]
            looks.append(compare(r, texels[wrap(column, texture.width, False)][0], params))
    c00, c10, c01, c11 = (look.shadow for look in looks)
    fx, fy = x - x0, y - y0
    return Lookup(lerp(lerp(c00, c10, fx), lerp(c01, c11, fx), fy), min(look.margin for look in looks))


def look_up(fragment: Fragment, coord: Vec3, q_w: float, texture: Texture, params: Any) -> Lookup:
    """The shadow on one visible fragment."""
    if not falls_on_map(coord, q_w):
        return LIT
    s, t, r = coord
    if params.content == "mask":
        return LIT if fragment.caster else Lookup(texture.value(s, t), math.inf)
    if params.pcf:
        return four_comparisons(texture, coord, params)
    return compare(r, nearest_texel(texture, s, t), params)


# --- The stage -------------------------------------------------------------------------------------------------------


def project(surface: Surface, image: np.ndarray, camera: LightCamera, params: Any) -> Projected:
    """All pixels of one light sample; where no surface is: 0, 0, infinity, infinity."""
    height, width = len(surface), len(surface[0])
    result = Projected(
        coord=np.zeros((height, width, 3)),
        shadow=np.zeros((height, width)),
        margin=np.full((height, width), math.inf),
        texel_margin=np.full((height, width), math.inf),
    )
    texture = Texture(image, False)
    for row, line in enumerate(surface):
        for column, fragment in enumerate(line):
            if fragment is None:
                continue
            coord, q_w = map_coordinate(fragment.world, camera)
            look = look_up(fragment, coord, q_w, texture, params)
            result.coord[row, column] = coord
            result.shadow[row, column] = look.shadow
            result.margin[row, column] = look.margin
            result.texel_margin[row, column] = texel_margin(coord, q_w, texture.width)
    return result
