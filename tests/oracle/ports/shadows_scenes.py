"""Scenes for the plain port of shadows: each has what some of its mutants need to show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref import shadows
from ibr_ref.oracle.faults.shadows.grid import GRID
from ibr_ref.oracle.faults.shadows.soft import SOFT
from ibr_ref.scene import Camera, Mesh
from ibr_ref.shadows import AreaLight, Maps, Params, Scene
from ibr_ref.testing.shadows import unfolded_controls
from tests.shadows.golden_scenes import painted
from tests.shadows.scenes import ball, box, plate

WIDTH, HEIGHT, SIZE = 96, 72, 64


@dataclass(frozen=True)
class Case:
    """What one frame is rendered of."""

    scene: Scene
    params: Params
    maps: Maps | None

    @property
    def inputs(self) -> dict[str, Any]:
        """As a port is given them."""
        return {"maps": self.maps}


def light(**changes: Any) -> AreaLight:
    """Above the caster, off the middle of its range."""
    values: dict[str, Any] = {
        "position": (0.2, -0.15, 4.0), "target": (0.1, 0.0, -1.0), "vertical_fov": 50.0, "near": 0.5, "far": 9.0,
        "half_edges": ((0.4, 0.0, 0.0), (0.1, 0.25, 0.0)),
    }  # fmt: skip
    return AreaLight(**{**values, **changes})


def camera(**changes: Any) -> Camera:
    values: dict[str, Any] = {
        "eye": (0.6, -3.2, 1.8), "target": (0.0, 0.0, -0.6), "near": 0.2, "far": 20.0, "width": WIDTH, "height": HEIGHT,
    }  # fmt: skip
    return Camera.look_at(**{**values, **changes})


def stool() -> Mesh:
    """A painted box with a ball on it: closed, not convex, not symmetric."""
    parts = [(box(0.3), np.array([0.1, 0.0, -0.2])), (ball(0.35, 12), np.array([-0.1, 0.05, 0.3]))]
    vertices = np.concatenate([np.asarray(mesh.vertices) + at for mesh, at in parts])
    triangles = np.concatenate(
        [np.asarray(parts[0][0].triangles), np.asarray(parts[1][0].triangles) + len(np.asarray(parts[0][0].vertices))]
    )
    return painted(Mesh(vertices=vertices, triangles=triangles), 3)


def wall(x: float = 1.1) -> Mesh:
    """Beside the caster, wound away from it."""
    corners = [(x, -1.5, -1.0), (x, 1.5, -1.0), (x + 0.3, 1.5, 1.5), (x + 0.3, -1.5, 1.5)]
    return Mesh(vertices=corners, triangles=[(0, 1, 2), (0, 2, 3)], color=(0.9, 0.5, 0.4))


def moved(mesh: Mesh, by: ArrayLike, **changes: Any) -> Mesh:
    return Mesh(vertices=np.asarray(mesh.vertices) + np.asarray(by), triangles=mesh.triangles, **changes)


def scene(**changes: Any) -> Scene:
    """A floor that reaches behind the eye, painted by vertex, a box and a wall; the caster off centre."""
    block = moved(box(0.25), (-0.9, 0.5, -0.75), color=(0.3, 0.7, 0.5))
    values: dict[str, Any] = {
        "receivers": [painted(plate(6.0, -1.0), 1), block, wall()],
        "caster": stool(),
        "offset_range": ((-0.5, 0.6), (-0.6, 0.4)),
        "offset": (0.35, -0.4),
        "light": light(),
        "camera": camera(),
        "ambient": 0.2,
        "background": (0.61, 0.703, 0.9),
    }
    return Scene(**{**values, **changes})


def params(**changes: Any) -> Params:
    return Params(**{"map_size": SIZE, "rows": 6, "columns": 5, **changes})


def case(scene: Scene, params: Params, controls: str | ArrayLike = "bounds") -> Case:
    warps = params.method == "warp"
    return Case(scene, params, shadows.prepare(scene, params, controls=controls) if warps else None)


def soft() -> Case:
    """Nine samples of the light, masks of 4 x 4 samples."""
    return case(scene(), params(light_samples=9, map_samples=4))


def bent() -> Case:
    """Grids that no affine map joins; masks of one sample."""
    return case(scene(offset=(0.1, 0.2)), params(), unfolded_controls(5, 6, 5))


def nearest() -> Case:
    """Policy "nearest"; five samples; the 8-bit frame buffer."""
    return case(scene(), params(policy="nearest", light_samples=5, accumulation="unorm8", map_samples=2))


def deep() -> Case:
    """Depth maps, warped."""
    return case(scene(), params(content="depth", bias=4e-3))


def oblique() -> Case:
    """Axes neither of unit length nor at right angles, a light beside the range, an orthographic view."""
    ground = np.array([(2.0, 0.2, 0.0), (-0.1, 0.5, 0.0)])
    view = Camera.orthographic(
        eye=(1.5, -3.0, 2.5), target=(0.0, 0.0, -0.6), view_height=4.0, near=0.2, far=20.0, width=WIDTH, height=HEIGHT
    )
    lamp = light(position=(1.4, -0.2, 4.0), half_edges=(0.1 * ground[0], 0.3 * ground[1]))
    around = scene(
        offset_axes=ground, offset_range=((-0.3, 0.3), (-0.8, 0.8)), offset=(0.1, 0.5), light=lamp, camera=view
    )
    return case(around, params(light_samples=5))


def beside() -> Case:
    """A narrow light: the mask crosses the map's border, and coarse square cells whose diagonals cross pixel centres."""
    narrow = light(vertical_fov=14.0, half_edges=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    around = scene(light=narrow, offset_range=((-0.3, 0.4), (-0.4, 0.3)), offset=(0.25, -0.2))
    return case(around, params(rows=3, columns=3), "identity")


def border() -> Case:
    """The same narrow light, and grids that no affine map joins."""
    around = beside()
    return case(around.scene, params(rows=4, columns=4), unfolded_controls(7, 4, 4))


def low_light() -> Scene:
    """A light between floor and ceiling: the ceiling is behind it, the floor reaches beyond its far plane."""
    return scene(
        caster=plate(0.6, 0.0, color=(0.8, 0.8, 0.2)),
        receivers=[plate(6.0, -1.0), wall(1.6), plate(0.9, 2.4, color=(0.9, 0.9, 0.6))],
        light=light(position=(0.0, 0.0, 0.9), target=(0.3, 0.0, -1.0), vertical_fov=100.0, near=0.2, far=1.8),
        camera=camera(eye=(-1.5, -4.0, 2.0), target=(0.3, 0.0, 0.9), vertical_fov=60.0),
    )


def paced() -> Case:
    """A light aside and near, the projective pace."""
    lamp = light(position=(-1.6, -1.3, 1.9), target=(0.0, 0.0, 0.0), vertical_fov=75.0, near=0.3)
    around = scene(light=lamp, offset_range=((-0.6, 0.7), (-0.7, 0.5)), offset=(0.3, -0.35))
    return case(around, params(interpolation="projective", light_samples=5, map_samples=2))


def behind() -> Case:
    """Masks, a ceiling behind the light."""
    return case(low_light(), params())


def far() -> Case:
    """Depths, a floor beyond the far plane."""
    return case(low_light(), params(method="direct", content="depth", bias=2e-3))


def direct() -> Case:
    """Depth maps rendered for each of five samples: the caster shadows itself."""
    return case(scene(), params(method="direct", content="depth", light_samples=5, bias=2e-3))


def filtered() -> Case:
    """Depths, four comparisons."""
    return case(scene(), params(method="direct", content="depth", pcf=True, bias=2e-3))


def coarse() -> Case:
    """Depths of 8 bits: many are equal."""
    return case(scene(), params(method="direct", content="depth", quantize=8, bias=6e-3))


def twice() -> Case:
    """The floor twice, in two colours."""
    first = painted(plate(6.0, -1.0), 1)
    return case(scene(receivers=[first, moved(first, (0.0, 0.0, 0.0), color=(0.1, 0.1, 0.9)), wall()]), params())


def listed() -> Case:
    """Four samples that the scene lists itself, in no order, the light's centre third; ambient between two bytes."""
    lamp = light()
    moves = np.array([(0.7, -0.5), (-0.3, 0.6), (0.0, 0.0), (-0.8, -0.4)])
    return case(scene(light=lamp, ambient=0.23), params(light_samples=lamp.arrays[0] + moves @ lamp.arrays[1]))


def verge() -> Case:
    """The narrow light of `beside`: depths of 8 bits cross the map's border; four comparisons, often of equals."""
    return case(beside().scene, params(method="direct", content="depth", pcf=True, quantize=8, bias=4e-3))


def beyond() -> Case:
    """Depths without a bias, a view of the floor of which a corner is beyond the light's far plane: both sides are 1."""
    view = camera(eye=(-0.9, -0.7, -0.35), target=(0.9, 0.6, -1.0), vertical_fov=60.0)
    around = low_light()
    around = replace(around, camera=view, light=replace(around.light, far=2.15))
    return case(around, params(method="direct", content="depth", bias=0.0))


def grazing() -> Case:
    """A wide view: walls that the view axis and the line of sight see from different sides."""
    view = camera(eye=(0.9, -1.6, 0.6), target=(0.9, 0.5, -0.6), vertical_fov=75.0)
    walls = [wall(0.9), moved(wall(0.9), (-1.6, 0.0, 0.0), color=(0.4, 0.9, 0.4))]
    return case(scene(camera=view, receivers=[painted(plate(6.0, -1.0), 1), *walls]), params())


def many() -> Case:
    """Masks, five of 5 x 5 maps."""
    return case(scene(), params(method="grid", grid_size=5, light_samples=5, map_samples=2))


def penumbra() -> Case:
    """Percentage-closer soft shadows of a caster that cuts a table."""
    lamp = light(half_edges=((0.5, 0.0, 0.0), (0.15, 0.4, 0.0)))
    meshes = [painted(plate(6.0, -1.0), 1), plate(0.6, 0.05), wall()]
    around = scene(light=lamp, receivers=meshes)
    return case(around, params(method="pcss", bias=0.4, search_points=12, filter_points=16))


CASES: dict[str, Callable[[], Case]] = {
    make.__name__: cache(make)
    for make in (
        soft,
        bent,
        nearest,
        deep,
        oblique,
        beside,
        border,
        paced,
        behind,
        far,
        direct,
        filtered,
        coarse,
        twice,
        listed,
        verge,
        beyond,
        grazing,
        many,
        penumbra,
    )
}


ELSEWHERE = {
    "maps-listed-first-is-centre": "listed",
    "maps-middle-not-clamped": "oblique",
    "maps-any-sample": "nearest",
    "maps-coverage-over-k2-1": "nearest",
    "maps-farthest-depth": "deep",
    "maps-depth-half-floats": "deep",
    "maps-linear-depth": "deep",
    "maps-unit-axes": "oblique",
    "warp-listed-by-distance": "listed",
    "warp-pace-even": "paced",
    "warp-pace-reversed": "paced",
    "warp-pace-of-the-upper-row": "paced",
    "warp-farther-image": "nearest",
    "warp-other-diagonal": "bent",
    "warp-last-column-left-out": "beside",
    "warp-no-fill-rule": "beside",
    "warp-repeat": "border",
    "warp-clamp-one-early": "border",
    "warp-world-xy": "oblique",
    "warp-direct-from-centre": "direct",
    "warp-direct-back-faces": "direct",
    "warp-direct-depth-truncated": "coarse",
    **{mutant.name: "many" for mutant in GRID.mutants},
    **{mutant.name: "penumbra" for mutant in SOFT.mutants},
    "project-gl-depth": "deep",
    "project-r-not-divided": "deep",
    "project-r-not-clamped": "far",
    "project-outside-clamped": "beside",
    "project-behind-light": "behind",
    "project-caster-exempt-from-depths": "deep",
    "project-texel-rounded": "deep",
    "project-repeat": "beside",
    "project-bias-sign": "deep",
    "project-no-bias": "deep",
    "project-bias-doubled": "deep",
    "project-or-equal": "coarse",
    "project-quantize-truncates": "coarse",
    "project-bias-after-quantize": "coarse",
    "project-weights-exchanged": "filtered",
    "project-pcf-of-depths": "filtered",
    "project-pcf-three-taps": "filtered",
    "project-pcf-last-texel": "verge",
    "project-pcf-or-equal": "verge",
    "project-compare-ge": "beyond",
    "project-r-linear": "deep",
    "project-r-reversed": "deep",
    "project-shadow-beside-the-map": "beside",
    "project-border-texels-lit": "beside",
    "project-beyond-far-lit": "far",
    "project-comparison-reversed": "deep",
    "project-texels-of-bytes": "deep",
    "project-bias-before-division": "deep",
    "project-pcf-equal-weights": "filtered",
    "project-pcf-one-tap": "filtered",
    "maps-16-bits": "deep",
    "resolve-ambient-byte": "listed",
    "resolve-turned-by-view-axis": "grazing",
    "resolve-lequal": "twice",
}
"""Which scene shows a mutant, where `soft` does not, or hardly."""


def shows(mutant: str) -> Case:
    """The scene that shows a mutant."""
    return CASES[ELSEWHERE.get(mutant, "soft")]()
