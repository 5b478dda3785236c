"""Cases of a few hundred pixels, one for each way through the methods: a verdict takes some hundredths of a second."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from ibr_ref import displacement
from ibr_ref.contract import is_margin
from ibr_ref.models.surface_depths import ball_depths
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.cases.shadow_meshes import block, grid, painted, plate
from ibr_ref.oracle.cases.splatting import case as splatting_case
from ibr_ref.oracle.cases.splatting import looking, parallel
from ibr_ref.oracle.cases.splatting import painted as picture
from ibr_ref.scene import AreaLight, BasePolygon, Camera, Light
from ibr_ref.shadows import Params as ShadowParams
from ibr_ref.shadows import Scene as ShadowScene
from ibr_ref.shadows import prepare
from ibr_ref.splatting import Params as SplatParams
from ibr_ref.splatting import Scene as SplatScene

WIDTH, HEIGHT = 19, 14


def _noise(*shape: int, seed: int) -> Any:
    return np.random.RandomState(seed).random_sample(shape)


def _polygon(**more: Any) -> BasePolygon:
    v, u = (np.arange(9)[:, np.newaxis] + 0.5) / 9, (np.arange(11) + 0.5) / 11
    heights = 0.1 + 3.0 * u * (1.0 - u) * v * (1.0 - v)
    heights[2:4, 5:8] = 0.937
    values = {
        "corner": (0.3, -0.8, 0.1),
        "edge_u": (1.5, 0.2, 0.1),
        "edge_v": (0.5, 0.8, -0.1),
        "height_map": heights,
        "color_map": _noise(5, 7, 3, seed=1),
        "height_scale": 0.3,
        "facade_map": _noise(4, 3, 3, seed=2),
        "facade_tile": (0.4, 0.25),
    }
    return BasePolygon(**{**values, **more})


def _displacement(name: str, polygons: list[BasePolygon], params: displacement.Params, **view: Any) -> Case:
    looks = {"eye": (2.4, -1.6, 1.3), "target": (1.3, -0.35, 0.2), "vertical_fov": 30.0, "near": 0.05, "far": 20.0}
    camera = Camera.look_at(**{**looks, "width": WIDTH, "height": HEIGHT, **view})
    light = Light(position=(1.0, -1.4, 1.5), diffuse=1.1, specular=0.4, exponent=5)
    scene = displacement.Scene(polygons=polygons, camera=camera, light=light, background=(0.2, 0.3, 0.1))
    return Case(name=f"displacement-{name}", method="displacement", kind="easy", about="Tiny.", profile="ieee32",
                scene=scene, params=params)  # fmt: skip


def hill() -> Case:
    """Facades and self-shadow."""
    return _displacement("hill", [_polygon()], displacement.Params(linear_steps=6, binary_steps=2, shadow_steps=3))


def pair() -> Case:
    """Two polygons through each other, in the volume's interval."""
    upright = _polygon(corner=(0.8, -0.9, -0.1), edge_u=(0.3, 1.2, 0.1), edge_v=(0.1, -0.05, 0.7), facade_map=None)
    params = displacement.Params(linear_steps=6, binary_steps=1, interval="volume", steep_threshold=0.13)
    return _displacement("pair", [_polygon(), upright], params, eye=(2.6, -1.4, 1.2))


def tile() -> Case:
    """The base alone, repeated, with a normal map and the polygon's depth."""
    polygon = _polygon(domain="repeat", normal_map=0.4 + 0.5 * _noise(4, 5, 3, seed=3), facade_map=None)
    return _displacement("tile", [polygon], displacement.Params(linear_steps=5, faces="base", depth="polygon"))


def cut() -> Case:
    """The near plane through the volume."""
    params = displacement.Params(linear_steps=6, binary_steps=2)
    return _displacement("cut", [_polygon()], params, near=1.7, far=2.6)


def _below(method: str, **params: Any) -> Case:
    """A system whose shapes sink below the polygon."""
    polygon = _polygon(facade_map=None)
    chosen = displacement.Params(method=method, **params)
    return _displacement(method.replace("_", "-"), [polygon], chosen)


def relief() -> Case:
    """Linear and binary steps down from the polygon."""
    return _below("relief", linear_steps=6, binary_steps=2)


def relaxed_cone() -> Case:
    """Steps of relaxed cones, and halvings."""
    return _below("relaxed_cone", linear_steps=4, binary_steps=2)


def maximum_mipmap() -> Case:
    """A walk in a quadtree."""
    return _below("maximum_mipmap")


def _splatting(name: str, params: SplatParams, light: Light | None, **more: Any) -> Case:
    cameras = [looking((0.4, -3.0, 0.7), size=(9, 7)), looking((1.8, -2.2, 1.0), size=(8, 8))]
    view = more.pop("view", looking((0.9, -2.7, 0.9), size=(WIDTH, HEIGHT)))
    images = [picture(camera, ball_depths(camera)) for camera in cameras]
    scene = SplatScene(images=images, camera=view, light=light, background=(0.11, 0.2, 0.31))
    return splatting_case(name, "easy", "Tiny.", "ieee32", scene, replace(params, **more))


def dots() -> Case:
    """Two images on two pages, unlit squares."""
    return _splatting("dots", SplatParams(alpha=2.5), None, max_atlas_size=12)


def round_dots() -> Case:
    """Discs by a law, in a lamp's light, without perspective."""
    view = parallel((0.9, -2.7, 0.9), size=(WIDTH, HEIGHT))
    light = Light(position=(1.0, -2.5, 2.0), specular=0.3, exponent=5)
    return _splatting("round-dots", SplatParams(alpha=8.0, gamma=0.5, max_width=5.5, shape="disc"), light, view=view)


def ovals() -> Case:
    """Ellipses that are averaged, unlit."""
    return _splatting("ovals", SplatParams(shape="ellipse", footprint=0.9, max_width=6.0, depth_tolerance=0.1), None)


def _shadows(name: str, controls: Any = "bounds", **params: Any) -> Case:
    light = AreaLight(position=(0.2, -0.15, 4.0), target=(0.1, 0.0, -1.0), vertical_fov=50.0, near=0.5, far=9.0,
                      half_edges=((0.4, 0.0, 0.0), (0.1, 0.25, 0.0)))  # fmt: skip
    camera = Camera.look_at(eye=(0.6, -3.2, 1.8), target=(0.0, 0.0, -0.6), near=0.2, far=20.0, width=WIDTH,
                            height=HEIGHT)  # fmt: skip
    scene = ShadowScene(
        receivers=[painted(plate(2.2, -1.0), 1)],
        caster=block(0.45, color=(0.8, 0.3, 0.1)),
        offset_range=((-0.5, 0.6), (-0.6, 0.4)),
        offset=(0.35, -0.4),
        light=light,
        camera=camera,
        ambient=0.2,
        background=(0.61, 0.703, 0.91),
    )
    chosen = ShadowParams(**{"map_size": 12, "rows": 3, "columns": 4, **params})
    inputs = {"maps": prepare(scene, chosen, controls=controls)} if chosen.method == "warp" else {}
    return Case(name=f"shadows-{name}", method="shadows", kind="easy", about="Tiny.", profile="gl", scene=scene,
                params=chosen, inputs=inputs)  # fmt: skip


def warp() -> Case:
    """Masks, one sample, grids that no affine map joins."""
    return _shadows("warp", grid(5, 3, 4))


def many() -> Case:
    """Five samples in 8 bits, the nearer maps."""
    return _shadows("many", policy="nearest", light_samples=5, accumulation="unorm8", map_samples=2)


def deep() -> Case:
    """Warped depths."""
    return _shadows("deep", content="depth", bias=4e-3)


def drawn() -> Case:
    """Maps that are rendered: five samples, depths, four comparisons, in 8 bits."""
    return _shadows("drawn", method="direct", content="depth", pcf=True, light_samples=5, accumulation="unorm8")


def masks() -> Case:
    """Masks that are rendered."""
    return _shadows("masks", method="direct", map_samples=2)


def soft() -> Case:
    """Percentage-closer soft shadows."""
    return _shadows("soft", method="pcss", bias=4e-3, search_points=4, filter_points=5)


TINY: dict[str, Callable[[], Case]] = {
    f"{method}-{build.__name__}": cache(build)
    for method, builds in (
        ("displacement", (hill, pair, tile, cut, relief, relaxed_cone, maximum_mipmap)),
        ("splatting", (dots, round_dots, ovals)),
        ("shadows", (warp, many, deep, drawn, masks, soft)),
    )
    for build in builds
}


def handed_of(case: Case) -> dict[str, Any]:
    """The reference's own arrays as a port hands them in, the picture as floats; without what ports need not have."""
    stages = {name: array for name, array in case.frame.stages.items() if not is_margin(name)}
    copied = {n: tuple(p.copy() for p in a) if isinstance(a, tuple) else a.copy() for n, a in stages.items()}
    return {**copied, "color": case.frame.color.copy(), "depth": case.frame.depth.copy()}
