"""The cases of shadows by image warping. Together they show every feature of the method that a port can get wrong.

Control points are off the lattice of window positions, receivers never lie on each other, and biases are well away from
what separates the surfaces: so that float32 cannot turn many decisions. Each case's own test says how many pixels are open.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref import models
from ibr_ref.models.staged import shadow_stage
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.cases.shadow_meshes import block, grid, moved, painted, plate, rack, stool, wall
from ibr_ref.scene import AreaLight, Camera
from ibr_ref.shadows import Params, Scene, prepare

WIDTH, HEIGHT, SIZE = 96, 72, 48

FLOOR = 2.2
"""Half the floor's side where it is all in front of the eye; 6 where it reaches behind it."""


def _case(
    name: str,
    kind: str,
    about: str,
    scene: Scene,
    params: Params,
    *,
    profile: str = "ieee32",
    controls: str | ArrayLike = "bounds",
) -> Case:
    warps = params.method == "warp"
    return Case(
        name=f"shadows-{name}",
        method="shadows",
        kind=kind,
        about=about,
        profile=profile,
        scene=scene,
        params=params,
        inputs={"maps": prepare(scene, params, controls=controls)} if warps else {},
    )


def _light(**changes: Any) -> AreaLight:
    """Above the caster, off the middle of its range."""
    values: dict[str, Any] = {
        "position": (0.2, -0.15, 4.0),
        "target": (0.1, 0.0, -1.0),
        "vertical_fov": 50.0,
        "near": 0.5,
        "far": 9.0,
        "half_edges": ((0.4, 0.0, 0.0), (0.1, 0.25, 0.0)),
    }
    return AreaLight(**{**values, **changes})


def _camera(**changes: Any) -> Camera:
    values: dict[str, Any] = {
        "eye": (0.6, -3.2, 1.8),
        "target": (0.0, 0.0, -0.6),
        "near": 0.2,
        "far": 20.0,
        "width": WIDTH,
        "height": HEIGHT,
    }
    return Camera.look_at(**{**values, **changes})


def _scene(**changes: Any) -> Scene:
    """A painted floor, a block and a wall; the caster off centre."""
    values: dict[str, Any] = {
        "receivers": [
            painted(plate(FLOOR, -1.0), 1),
            moved(block(0.25), (-0.9, 0.5, -0.7), color=(0.3, 0.7, 0.5)),
            wall(1.1),
        ],
        "caster": stool(),
        "offset_range": ((-0.5, 0.6), (-0.6, 0.4)),
        "offset": (0.35, -0.4),
        "light": _light(),
        "camera": _camera(),
        "ambient": 0.23,
        "background": (0.61, 0.703, 0.91),
    }
    return Scene(**{**values, **changes})


def _params(**changes: Any) -> Params:
    return Params(**{"map_size": SIZE, "rows": 6, "columns": 5, **changes})


def box() -> Case:
    """One sample of the light, one sample a texel."""
    scene = _scene(caster=block(0.45, color=(0.8, 0.3, 0.1)), receivers=[plate(FLOOR, -1.0, color=(0.5, 0.6, 0.7))])
    about = "A box over a floor, one light sample, masks: six warps and a projection."
    return _case("box", "easy", about, scene, _params(), profile="gl")


def soft() -> Case:
    """Nine samples."""
    about = "A stool, nine light samples, masks of 4 x 4 samples a texel, painted surfaces."
    return _case("soft", "typical", about, _scene(), _params(light_samples=9, map_samples=4), profile="gl")


def nearest() -> Case:
    """Three warps."""
    about = 'Policy "nearest", five light samples, the 8-bit frame buffer.'
    params = _params(policy="nearest", light_samples=5, accumulation="unorm8", map_samples=2)
    return _case("nearest", "typical", about, _scene(), params, profile="gl")


def depths() -> Case:
    """Warped depths."""
    about = "Maps of depths, warped: nearest comparisons, the caster's own fragments too."
    return _case("depths", "typical", about, _scene(), _params(content="depth", bias=4e-3), profile="gl")


def bent() -> Case:
    """Any grids."""
    about = "Control grids that no affine map joins, and the object in the upper right cell; a floor behind the eye."
    scene = _scene(offset=(0.1, 0.2), receivers=[painted(plate(6.0, -1.0), 1), wall(1.1)])
    return _case("bent", "adversarial", about, scene, _params(), profile="webgpu", controls=grid(5, 6, 5))


def oblique() -> Case:
    """Oblique axes."""
    about = "Axes that are neither unit vectors nor at right angles, a light beside the range, an orthographic view."
    axes = np.array([(2.0, 0.2, 0.0), (-0.1, 0.5, 0.0)])
    view = Camera.orthographic(
        eye=(1.5, -3.0, 2.5),
        target=(0.0, 0.0, -0.6),
        view_height=4.0,
        near=0.2,
        far=20.0,
        width=WIDTH,
        height=HEIGHT,
    )
    scene = _scene(
        offset_axes=axes,
        offset_range=((-0.3, 0.3), (-0.8, 0.8)),
        offset=(0.1, 0.5),
        light=_light(position=(1.4, -0.2, 4.0), half_edges=(0.1 * axes[0], 0.3 * axes[1])),
        camera=view,
    )
    return _case("oblique", "adversarial", about, scene, _params(light_samples=5), profile="gl")


def _narrow() -> Scene:
    return _scene(
        light=_light(vertical_fov=14.0, half_edges=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))),
        offset_range=((-0.3, 0.4), (-0.4, 0.3)),
        offset=(0.25, -0.2),
    )


def beside() -> Case:
    """The border of the map."""
    about = "A narrow light: the mask crosses the map's border; square cells whose diagonals run through texel centres."
    return _case(
        "beside", "adversarial", about, _narrow(), _params(rows=3, columns=3), profile="gl", controls="identity"
    )


def border() -> Case:
    """The border of the map, and grids."""
    about = "The same narrow light, and grids that no affine map joins: fetches beyond the map."
    return _case(
        "border", "adversarial", about, _narrow(), _params(rows=4, columns=4), profile="gl", controls=grid(7, 4, 4)
    )


def _low() -> Scene:
    """A light between floor and ceiling: the ceiling is behind it, the floor reaches beyond its far plane."""
    return _scene(
        caster=plate(0.6, 0.0, color=(0.8, 0.8, 0.2)),
        receivers=[plate(6.0, -1.0), wall(1.6), plate(0.9, 2.4, color=(0.9, 0.9, 0.6))],
        light=_light(position=(0.0, 0.0, 0.9), target=(0.3, 0.0, -1.0), vertical_fov=100.0, near=0.2, far=1.8),
        camera=_camera(eye=(-1.5, -4.0, 2.0), target=(0.3, 0.0, 0.9), vertical_fov=60.0),
    )


def behind() -> Case:
    """What the light does not see."""
    return _case(
        "behind", "adversarial", "Masks under a low light: a ceiling is behind it.", _low(), _params(), profile="webgpu"
    )


def far() -> Case:
    """Beyond the light's planes."""
    about = "Depths under a low light, rendered anew: the floor reaches beyond its far plane and behind the eye."
    return _case("far", "adversarial", about, _low(), _params(method="direct", content="depth", bias=2e-3))


def direct() -> Case:
    """Rendered for each sample."""
    about = "Maps of depths rendered for each of five light samples: the caster shadows itself."
    return _case(
        "direct",
        "typical",
        about,
        _scene(),
        _params(method="direct", content="depth", light_samples=5, bias=2e-3),
        profile="vulkan",
    )


def masks() -> Case:
    """Rendered masks."""
    about = "Masks rendered for each of five light samples."
    return _case("masks", "typical", about, _scene(), _params(method="direct", light_samples=5), profile="gl")


def filtered() -> Case:
    """Four comparisons."""
    about = "Depths rendered anew, the mix of four comparisons; grazing views of two walls."
    scene = _scene(
        camera=_camera(eye=(0.9, -1.6, 0.6), target=(0.9, 0.5, -0.6), vertical_fov=75.0),
        receivers=[
            painted(plate(6.0, -1.0), 1),
            wall(0.9),
            moved(wall(0.9), (-1.6, 0.0, 0.0), color=(0.4, 0.9, 0.4)),
        ],
    )
    return _case(
        "filtered",
        "adversarial",
        about,
        scene,
        _params(method="direct", content="depth", pcf=True, bias=2e-3),
        profile="vulkan",
    )


def coarse() -> Case:
    """Comparisons of bytes."""
    about = "Depths rendered anew and compared in 8 bits: many are equal."
    params = _params(method="direct", content="depth", quantize=8, bias=3e-3)
    return _case("coarse", "adversarial", about, _scene(), params, profile="gl")


def pace() -> Case:
    """Projective fractions."""
    about = "A light aside and near: maps are passed through at the projective pace; five light samples."
    light = _light(position=(-1.6, -1.3, 1.9), target=(0.0, 0.0, 0.0), vertical_fov=75.0, near=0.3)
    scene = _scene(light=light, offset_range=((-0.6, 0.7), (-0.7, 0.5)), offset=(0.3, -0.35))
    params = _params(interpolation="projective", light_samples=5, map_samples=2)
    return _case("pace", "adversarial", about, scene, params, profile="gl")


def thin() -> Case:
    """Thin things."""
    about = "A rack of thin bars under five light samples, the 8-bit frame buffer."
    params = _params(light_samples=5, map_samples=2, accumulation="unorm8")
    return _case("thin", "adversarial", about, _scene(caster=rack()), params, profile="webgpu")


def listed() -> Case:
    """Samples of its own."""
    light = _light()
    moves = np.array([(0.7, -0.5), (-0.3, 0.6), (0.0, 0.0), (-0.8, -0.4)])
    samples = light.arrays[0] + moves @ light.arrays[1]
    about = "Four light samples that the case lists itself, in no order: the light's centre is the third."
    return _case("listed", "typical", about, _scene(light=light), _params(light_samples=samples), profile="gl")


def verge() -> Case:
    """Four comparisons on the border of the map."""
    about = "A narrow light: depths rendered anew cross the map's border; the mix of four comparisons of bytes, often equal."
    params = _params(method="direct", content="depth", pcf=True, quantize=8, bias=3e-3)
    return _case("verge", "adversarial", about, _narrow(), params, profile="gl")


def beyond() -> Case:
    """No bias."""
    about = (
        "Depths rendered anew and compared without a bias: beyond the light's far plane both sides are 1, and equal."
    )
    camera = _camera(eye=(-0.9, -0.7, -0.35), target=(0.9, 0.6, -1.0), vertical_fov=60.0)
    scene = replace(_low(), camera=camera)
    return _case("beyond", "adversarial", about, scene, _params(method="direct", content="depth", bias=0.0))


def many() -> Case:
    """Many maps."""
    about = "The mix of the four around of 5 x 5 maps made beforehand, five light samples, masks: nothing is warped."
    params = _params(method="grid", grid_size=5, light_samples=5, map_samples=2)
    return _case("many", "typical", about, _scene(), params, profile="gl")


def penumbra() -> Case:
    """The whole light."""
    about = "Percentage-closer soft shadows: 12 points for blockers, 16 for the filter; a table that the caster cuts."
    light = _light(half_edges=((0.5, 0.0, 0.0), (0.15, 0.4, 0.0)))
    table = painted(plate(0.6, 0.05), 2)
    scene = _scene(light=light, receivers=[painted(plate(FLOOR, -1.0), 1), table, wall(1.1)])
    params = _params(method="pcss", bias=0.55, search_points=12, filter_points=16)
    return _case("penumbra", "typical", about, scene, params, profile="gl")


def stage() -> Case:
    """Of real size."""
    about = "A chair on a stage, 640 x 480, five light samples, maps of 128 x 128, grids of 15 x 5 as in the paper."
    scene = shadow_stage(models.chair(), offset=(0.23, -0.17), near=0.1, far=30.0)
    params = Params(map_size=128, light_samples=5)
    return _case("stage", "real-sized", about, scene, params, profile="webgpu")


_MAKERS = (
    box, soft, nearest, depths, direct, masks, bent, oblique, beside, border, behind, far, filtered, coarse, pace, thin,
    listed, verge, beyond, many, penumbra, stage,
)  # fmt: skip

CASES: dict[str, Callable[[], Case]] = {f"shadows-{make.__name__}": cache(make) for make in _MAKERS}
"""By name: a builder, which makes its case once."""
