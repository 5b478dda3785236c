"""The cases of displacement mapping. Together they show every feature of the method that a port can get wrong.

Cameras are chosen so that float32 cannot turn many pixels: no corner of a face lies near the middle between two subpixels,
roofs lie between the lattice's heights, thresholds off it, and no background halfway between two bytes. Each test of a case
says how many pixels are left open.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from ibr_ref import models
from ibr_ref.array_types import Floats
from ibr_ref.displacement import Params, Scene
from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import BasePolygon, Camera, Light

WIDTH, HEIGHT = 112, 84


def _case(name: str, kind: str, about: str, scene: Scene, params: Params, profile: str = "ieee32") -> Case:
    return Case(
        name=f"displacement-{name}",
        method="displacement",
        kind=kind,
        about=about,
        profile=profile,
        scene=scene,
        params=params,
    )


def _looking(**view: Any) -> Camera:
    return Camera.look_at(**{"width": WIDTH, "height": HEIGHT, "near": 0.05, "far": 20.0, "vertical_fov": 40.0, **view})


def _params(**values: Any) -> Params:
    """A threshold that no lattice of these cases meets: where it does, as 0.1 does, whole rows of hits tie."""
    return Params(**{"steep_threshold": 0.123, **values})


def _noise(*shape: int, seed: int) -> Floats:
    return np.random.RandomState(seed).random_sample(shape)


def _hills(rows: int, columns: int) -> Floats:
    """Smooth heights in 0.05 ... 0.95, with a wall, a block and a needle in them."""
    v, u = (np.arange(rows)[:, np.newaxis] + 0.5) / rows, (np.arange(columns) + 0.5) / columns
    heights = 0.1 + 3.2 * u * (1.0 - u) * v * (1.0 - v)
    heights[rows // 2 :, : columns // 3] += 0.4
    heights[rows // 5 : rows // 3, columns // 2 : 3 * columns // 4] = 0.937
    heights[3 * rows // 4, 3 * columns // 4] = 0.9
    return heights


def _rolling() -> Floats:
    """Smooth hills in 0.15 ... 0.95, without an edge."""
    return _smooth((40, 56), 0.15, 0.95, 0.1)


def _sheared(**more: Any) -> BasePolygon:
    """A tilted parallelogram, longer than wide, away from the origin, with a map that is no square, and a facade."""
    values = {
        "corner": (0.3, -0.8, 0.1),
        "edge_u": (1.5, 0.2, 0.1),
        "edge_v": (0.5, 0.8, -0.1),
        "height_map": _hills(40, 56),
        "color_map": _noise(9, 13, 3, seed=1),
        "height_scale": 0.3,
        "facade_map": _noise(8, 6, 3, seed=2),
        "facade_tile": (0.4, 0.25),
    }
    return BasePolygon(**{**values, **more})


def _smooth(shape: tuple[int, int], low: float, high: float, phase: float) -> Floats:
    """A gentle wave over a map, by a parabola's arcs."""
    v, u = (np.arange(shape[0])[:, np.newaxis] + 0.5) / shape[0], (np.arange(shape[1]) + 0.5) / shape[1]
    x = np.abs((u + 0.7 * v + phase) % 1.0 - 0.5)
    return low + (high - low) * (16.0 * x * x * (0.5 - x) ** 2 * 16.0)


@cache
def _quarter() -> tuple[BasePolygon, ...]:
    """Two by two neighbouring blocks of the city, 256 x 256 texels each."""
    blocks = models.city_blocks(0, 4)
    return blocks[5], blocks[6], blocks[9], blocks[10]


def box() -> Case:
    """The paper's figure 6."""
    camera = _looking(eye=(1.0, -1.2, 0.9), target=(0.0, 0.0, 0.0), vertical_fov=32.0)
    scene = Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1.0)))
    return _case("box", "easy", "One box on the ground, the defaults, a facade on its walls.", scene, _params())


def slope() -> Case:
    """Everything at once on a parallelogram."""
    camera = _looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.2), vertical_fov=30.0)
    light = Light(position=(1.0, -1.4, 1.5), diffuse=1.3, specular=0.8, exponent=12)
    about = "A tilted parallelogram with a facade under a lamp: self-shadow, a highlight, colours beyond white."
    scene = Scene(polygons=[_sheared()], camera=camera, light=light, background=(0.11, 0.31, 0.2))
    return _case("slope", "typical", about, scene, _params(shadow_steps=7, steep_threshold=0.15))


def city() -> Case:
    """Facades and shadows."""
    camera = _looking(eye=(-0.1, -2.1, 1.21), target=(-0.5, -0.5, 0.1), vertical_fov=45.0)
    light = Light(direction=(-0.7, -0.6, 0.6), specular=0.3, exponent=31)
    scene = Scene(polygons=[_quarter()[0]], camera=camera, light=light, background=(0.4, 0.51, 0.6))
    about = "A block of a city: facades, self-shadow from a low sun, a faint highlight."
    return _case("city", "typical", about, scene, _params(linear_steps=40, binary_steps=3, shadow_steps=16))


def extended() -> Case:
    """Section 3.2.1."""
    camera = Camera.orthographic(
        eye=(2.0, -2.98, 1.8), target=(0.0, 0.0, 0.2), view_height=2.2, near=0.1, far=10.0, width=WIDTH, height=HEIGHT
    )
    light = Light(position=(0.0, 0.0, 1.2), specular=0.4, exponent=8)
    scene = Scene(polygons=_quarter(), camera=camera, light=light)
    about = "Four polygons that hide one another, without perspective, on extended bases."
    return _case("extended", "typical", about, scene, _params(linear_steps=25, binary_steps=2, faces="extended"))


def mapped() -> Case:
    """A normal map."""
    camera = _looking(eye=(0.2, -1.9, 1.2), target=(1.3, -0.3, 0.2), vertical_fov=32.0)
    polygon = _sheared(normal_map=0.5 + 0.5 * _noise(7, 5, 3, seed=3), facade_map=None)
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.4, -0.5, 1.0), specular=0.3))
    about = "A normal map on the parallelogram; steps without a binary search."
    return _case("mapped", "easy", about, scene, _params(linear_steps=12, binary_steps=0))


def tiles() -> Case:
    """A tiled plane."""
    camera = _looking(eye=(0.6, -1.7, 1.3), target=(1.3, -0.3, 0.1), vertical_fov=34.0)
    polygon = _sheared(
        height_map=_noise(11, 14, seed=0), normal_map=0.4 + 0.5 * _noise(7, 5, 3, seed=3), domain="repeat"
    )
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.9, 0.6, 0.5), specular=0.5))
    about = "Repeated maps on the base alone, the polygon's own depth, a normal map besides the facade, self-shadow."
    params = _params(
        linear_steps=15, binary_steps=3, steep_threshold=0.031, faces="base", depth="polygon", shadow_steps=3
    )
    return _case("tiles", "typical", about, scene, params)


def beside() -> Case:
    """The volume's own interval from outside."""
    camera = _looking(eye=(1.6, -1.9, 0.25), target=(1.3, -0.3, 0.2), vertical_fov=36.0)
    scene = Scene(polygons=[_sheared()], camera=camera, light=Light(direction=(-0.3, -0.9, 0.8)))
    about = "The ray's own stretch inside the volume, from an eye beside it and below its top: walls at the border."
    return _case("beside", "typical", about, scene, _params(linear_steps=20, binary_steps=4, interval="volume"))


def street() -> Case:
    """The volume's own interval from inside."""
    camera = _looking(eye=(-0.5, -0.9, 0.2), target=(-0.52, -0.3, 0.16), vertical_fov=75.0, near=0.08, far=4.0)
    scene = Scene(polygons=[_quarter()[0]], camera=camera, light=Light(direction=(1.0, -0.5, 1.0)))
    about = "The eye inside the volume above a street: faces behind it and through the near plane, rays that look up."
    params = _params(linear_steps=12, binary_steps=1, interval="volume")
    return _case("street", "adversarial", about, scene, params)


def planes() -> Case:
    """Clipping."""
    camera = _looking(eye=(2.2, -1.5, 0.9), target=(1.2, -0.3, 0.2), near=1.3, far=2.0)
    scene = Scene(polygons=[_sheared()], camera=camera, light=Light(direction=(0.3, -0.5, 1.0)))
    about = "The near and the far plane cut faces, and the near plane what stands on them."
    return _case("planes", "adversarial", about, scene, _params(linear_steps=16, binary_steps=0))


def low() -> Case:
    """The paper's interval from an eye inside the volume."""
    camera = _looking(eye=(-0.05, -0.49, 0.13), target=(0.0, 0.3, 0.02), vertical_fov=80.0, near=0.15)
    scene = Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1.0)))
    about = "The eye below the top of the volume: rays that look up are discarded, hits behind the eye are cut away."
    return _case("low", "adversarial", about, scene, _params(linear_steps=10, binary_steps=1))


def crossing() -> Case:
    """The depth test."""
    upright = _sheared(
        corner=(0.8, -0.9, -0.1), edge_u=(0.3, 1.2, 0.1), edge_v=(0.1, -0.05, 0.7), height_scale=0.15,
        color_map=_noise(9, 13, 3, seed=7),
    )  # fmt: skip
    camera = _looking(eye=(2.6, -1.4, 1.2), target=(1.2, -0.2, 0.2))
    light = Light(direction=(0.3, -0.5, 1.0))
    scene = Scene(polygons=[_sheared(), upright], camera=camera, light=light, background=(0.2, 0.31, 0.11))
    about = "One volume through another: which is in front changes from pixel to pixel."
    return _case("crossing", "adversarial", about, scene, _params(linear_steps=16, binary_steps=4))


def borders() -> Case:
    """Pixel centres on edges."""
    camera = Camera.orthographic(
        eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), up=(0.0, 1.0, 0.0), view_height=5.25, near=0.5, far=4.0,
        width=WIDTH, height=HEIGHT,
    )  # fmt: skip
    polygon = BasePolygon(
        corner=(-0.96875, -0.46875, 0.0), edge_u=(1.0, 0.0, 0.0), edge_v=(0.0, 1.0, 0.0), height_scale=0.25,
        height_map=_hills(16, 16), color_map=_noise(4, 4, 3, seed=5),
    )  # fmt: skip
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.3, 0.5, 1.0)))
    about = "Straight from above, without perspective: edges and a diagonal run through pixel centres."
    return _case("borders", "adversarial", about, scene, _params())


def lamp() -> Case:
    """A lamp inside the volume."""
    camera = _looking(eye=(0.8, -1.3, 1.0), target=(0.0, 0.0, 0.0), vertical_fov=36.0)
    light = Light(position=(-0.3, -0.1, 0.12), specular=0.5, exponent=9)
    scene = Scene(polygons=[models.box()], camera=camera, light=light)
    about = "A lamp inside the volume, beside the box: what is behind it throws no shadow."
    return _case("lamp", "typical", about, scene, _params(linear_steps=20, binary_steps=4, shadow_steps=12))


def dusk() -> Case:
    """A light below the horizon."""
    camera = _looking(eye=(1.0, -1.2, 0.9), target=(0.0, 0.0, 0.0), vertical_fov=32.0)
    scene = Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, -0.2)))
    about = "A sun below the polygon's horizon: nothing is lit, but walls face it."
    return _case("dusk", "easy", about, scene, _params(binary_steps=3, shadow_steps=8))


def _gentle(**more: Any) -> BasePolygon:
    """Low waves in pale colours: filters of eight bits move nothing by a step."""
    heights = _smooth((12, 16), 0.45, 0.6, 0.1)
    colors = np.stack([_smooth((4, 5), 0.4, 0.6, phase) for phase in (0.0, 0.3, 0.6)], axis=-1)
    values = {"height_map": heights, "color_map": colors, "facade_map": None}
    return _sheared(**{**values, **more})


def filtered() -> Case:
    """Eight-bit weights."""
    camera = _looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.2), vertical_fov=30.0)
    scene = Scene(
        polygons=[_gentle()], camera=camera, light=Light(direction=(0.3, -0.5, 1.0), specular=0.2, exponent=4)
    )
    about = "Gentle maps: a texture unit with eight bits of weight may draw them, and any rounding of positions."
    return _case("filtered", "typical", about, scene, _params(linear_steps=16, binary_steps=4), "vulkan")


def loose() -> Case:
    """The loosest device."""
    camera = _looking(eye=(0.2, -1.9, 1.2), target=(1.3, -0.3, 0.2), vertical_fov=32.0)
    scene = Scene(polygons=[_gentle(height_scale=0.2)], camera=camera, light=Light(position=(1.8, 1.4, 1.5)))
    about = "Gentle maps for OpenGL as it comes: varyings over unsnapped triangles, weights of eight bits."
    return _case(
        "loose",
        "typical",
        about,
        scene,
        _params(linear_steps=16, binary_steps=4, shadow_steps=2, shadow_bias=0.02),
        "gl",
    )


def sliver() -> Case:
    """Clipping at the picture's border."""
    camera = _looking(eye=(0.48, -2.03, 1.19), target=(1.0534, -0.42, 0.02), vertical_fov=32.0)
    scene = Scene(polygons=[_gentle(height_scale=0.2)], camera=camera, light=Light(position=(1.8, 1.4, 1.5)))
    about = (
        "A corner a thirtieth of a pixel beside the picture: faces that are cut there leave a sliver, with poor planes."
    )
    params = _params(linear_steps=16, binary_steps=4, shadow_steps=2, shadow_bias=0.02)
    return _case("sliver", "adversarial", about, scene, params, "gl")


def _rim() -> BasePolygon:
    """Low ground with a ridge along its far border and a bank along a side: what is high is at the very edge of the map."""
    heights = _smooth((40, 48), 0.08, 0.31, 0.2)
    heights[:, -3:] = 0.83
    heights[-4:, :] = 0.57
    return _sheared(height_map=heights)


def rim() -> Case:
    """Lines of sight that all but lie in the polygon's plane, and a shadow from the border."""
    camera = _looking(eye=(-0.1, -0.95, 0.25), target=(1.35, -0.3, 0.2), vertical_fov=28.0)
    light = Light(direction=(1.0, 0.25, 0.4), ambient=0.23, diffuse=0.7)
    scene = Scene(polygons=[_rim()], camera=camera, light=light, background=(0.31, 0.11, 0.2))
    about = (
        "A ridge along the border of the map, seen at a grazing angle and against the sun: its shadow is of the border."
    )
    return _case("rim", "adversarial", about, scene, _params(linear_steps=40, binary_steps=2, shadow_steps=2))


def relief() -> Case:
    """Policarpo et al. 2005."""
    camera = _looking(eye=(2.4, -1.6, 1.3), target=(1.25, -0.3, -0.05), vertical_fov=36.0)
    light = Light(position=(1.0, -1.4, 1.5), diffuse=1.2, specular=0.6, exponent=11)
    scene = Scene(polygons=[_sheared(height_map=_rolling())], camera=camera, light=light, background=(0.11, 0.31, 0.2))
    about = "Relief mapping: steep hills sunk below a tilted parallelogram, a binary search, self-shadow under a lamp."
    return _case(
        "relief", "typical", about, scene, _params(method="relief", linear_steps=24, binary_steps=4, shadow_steps=5)
    )


def parallax() -> Case:
    """Welsh 2004."""
    camera = _looking(eye=(0.2, -1.9, 1.2), target=(1.2, -0.35, 0.1), vertical_fov=42.0)
    polygon = _sheared(
        height_map=_noise(9, 12, seed=4), normal_map=0.4 + 0.5 * _noise(7, 5, 3, seed=3), domain="repeat"
    )
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.4, -0.5, 1.0), specular=0.4, exponent=6))
    about = "Parallax mapping with offset limiting: a normal map and repeated heights, one step along the polygon."
    return _case("parallax", "easy", about, scene, _params(method="welsh"))


def steep() -> Case:
    """McGuire & McGuire 2005."""
    camera = _looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.0), vertical_fov=30.0)
    scene = Scene(polygons=[_sheared()], camera=camera, light=Light(direction=(0.3, -0.5, 1.0)))
    about = "Steep parallax mapping: a wall, a block and a needle in equal steps, more of them at a grazing angle."
    return _case("steep", "typical", about, scene, _params(method="mcguire", linear_steps=20, lod_bias=0.0))


def occlusion() -> Case:
    """Tatarchuk 2005."""
    camera = _looking(eye=(0.6, -1.7, 1.3), target=(1.2, -0.35, 0.0), vertical_fov=48.0)
    scene = Scene(
        polygons=[_sheared(height_map=_rolling())], camera=camera, light=Light(direction=(0.9, 0.6, 0.8), specular=0.3)
    )
    about = "Parallax occlusion mapping: steps by the angle of view, a secant between the last two, self-shadow."
    params = _params(method="tatarchuk", min_steps=8, max_steps=32, shadow_steps=4, shadow_bias=0.01)
    return _case("occlusion", "typical", about, scene, params)


def cone() -> Case:
    """Dummer 2006."""
    camera = _looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.1), vertical_fov=30.0)
    scene = Scene(
        polygons=[_sheared(height_map=_rolling())],
        camera=camera,
        light=Light(direction=(0.3, -0.5, 1.0), specular=0.2, exponent=4),
    )
    about = "Cone step mapping over smooth hills: each step as far as the cone over the texel is empty."
    return _case("cone", "typical", about, scene, _params(method="cone", linear_steps=12))


def relaxed() -> Case:
    """Policarpo & Oliveira 2007."""
    camera = _looking(eye=(0.2, -1.9, 1.2), target=(1.2, -0.4, 0.1), vertical_fov=44.0)
    scene = Scene(polygons=[_sheared(height_map=_rolling())], camera=camera, light=Light(position=(1.8, 1.4, 1.5)))
    about = "Relaxed cones over smooth hills: steps that end below the surface, then halvings of the whole way."
    return _case("relaxed", "typical", about, scene, _params(method="relaxed_cone", linear_steps=8, binary_steps=6))


def distance() -> Case:
    """Donnelly 2005."""
    camera = _looking(eye=(0.2, -1.9, 1.2), target=(1.2, -0.4, 0.1), vertical_fov=44.0)
    scene = Scene(
        polygons=[_sheared(height_map=_rolling())], camera=camera, light=Light(direction=(0.5, -0.4, 1.0), specular=0.3)
    )
    about = "Sphere tracing in a distance map of three dimensions, over smooth hills: steps as far as a ball is empty."
    return _case("distance", "typical", about, scene, _params(method="donnelly", linear_steps=8, distance_layers=12))


def quadtree() -> Case:
    """Drobot 2009."""
    camera = _looking(eye=(2.3, -1.5, 1.8), target=(1.3, -0.35, 0.0), vertical_fov=30.0, width=64, height=48)
    heights = _smooth((9, 13), 0.45, 0.6, 0.1) + 0.15 * (np.arange(13) + 0.5) / 13
    colors = np.stack([_smooth((5, 7), 0.5, 0.7, phase) for phase in (0.1, 0.4, 0.7)], axis=-1)
    polygon = _sheared(height_map=heights, color_map=colors)
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.3, -0.5, 1.0)))
    about = (
        "A quadtree of maxima over few texels, highest where its levels have odd sizes: the first intersection with the "
        "bilinear surface itself, on a slope so gentle that filters with weights of 8 bits are judged too."
    )
    return _case("quadtree", "typical", about, scene, _params(method="maximum_mipmap"))


def metropolis() -> Case:
    """A picture of real size."""
    camera = _looking(eye=(2.6, -3.14, 2.02), target=(0.0, 0.0, 0.0), vertical_fov=52.0, width=640, height=480)
    light = Light(direction=(-0.6, -0.5, 0.7), specular=0.3, exponent=37)
    scene = Scene(polygons=[models.city()], camera=camera, light=light, background=(0.51, 0.71, 0.91))
    about = "The whole city at 640 x 480: facades, self-shadow, a highlight."
    params = _params(linear_steps=40, binary_steps=1, shadow_steps=8)
    return _case("metropolis", "real-sized", about, scene, params)


CASES: dict[str, Callable[[], Case]] = {
    f"displacement-{make.__name__}": make
    for make in (
        box, mapped, dusk, slope, city, extended, tiles, beside, lamp, filtered, loose, street, planes, low, crossing,
        borders, rim, sliver, relief, parallax, steep, occlusion, cone, relaxed, distance, quadtree,
        metropolis,
    )
}  # fmt: skip
"""By name."""
