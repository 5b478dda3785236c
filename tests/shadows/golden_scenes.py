"""The golden scenes of shadows. `tests/golden.py` renders them. Maps are three quarters of the picture's width."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref import shadows
from ibr_ref.io import Frame
from ibr_ref.scene import Camera, Mesh
from ibr_ref.shadows import AreaLight, Caster, Ensemble, Maps, Params, Scene, prepare, prepare_ensemble
from tests.shadows.scenes import ball, box, plate

__all__ = ["SCENES", "TINY", "render"]

TINY = ("soft", "nearest", "direct", "grid", "wavelets")


def prepared(scene: Scene, params: Params) -> Maps | None:
    """Maps with controls by their bounding boxes, for the method that has any."""
    return prepare(scene, params, controls="bounds") if params.method == "warp" else None


def prepared_for_all(ensemble: Ensemble, params: Params) -> list[list[Maps]] | None:
    """The same for each caster and light."""
    return prepare_ensemble(ensemble, params, controls="bounds") if params.method == "warp" else None


def render(scene: Scene | Ensemble, params: Params) -> Frame:
    """Whatever the default placement is."""
    if isinstance(scene, Ensemble):
        return shadows.render_ensemble(scene, params, maps=prepared_for_all(scene, params))
    return shadows.render(scene, params, maps=prepared(scene, params))


def sizes(width: int) -> int:
    """Of a map."""
    return max(8, 3 * width // 4)


def looking(width: int, height: int, **view: Any) -> Camera:
    return Camera.look_at(width=width, height=height, near=0.1, far=20.0, target=(0.0, 0.0, -0.6), **view)


def lamp(**changes: Any) -> AreaLight:
    values: dict[str, Any] = {
        "position": (0.2, -0.3, 3.5), "target": (0.1, 0.0, -1.0), "vertical_fov": 65.0, "near": 0.5, "far": 9.0,
        "half_edges": ((0.35, 0.0, 0.0), (0.05, 0.25, 0.0)),
    }  # fmt: skip
    return AreaLight(**{**values, **changes})


def painted(mesh: Mesh, seed: int) -> Mesh:
    """With a random colour for every vertex."""
    vertices: NDArray[np.float64] = np.asarray(mesh.vertices)
    return Mesh(
        vertices=vertices, triangles=mesh.triangles, color=np.random.RandomState(seed).random_sample(vertices.shape)
    )


def soft(width: int, height: int) -> tuple[Scene, Params]:
    """A cube over a floor, nine samples of the light, six warps each, four samples a texel."""
    scene = Scene(
        receivers=[plate(5.0, -1.0, color=(0.6, 0.7, 0.5))],
        caster=painted(box(0.45), 1),
        offset_range=((-0.8, 0.9), (-0.7, 0.8)),
        offset=(0.35, -0.2),
        light=lamp(),
        camera=looking(width, height, eye=(1.5, -3.5, 2.5)),
        background=(0.2, 0.3, 0.5),
    )
    return scene, Params(map_size=sizes(width), rows=7, columns=5, map_samples=2, light_samples=9)


def nearest(width: int, height: int) -> tuple[Scene, Params]:
    """Depths of a ball, three warps each, four comparisons in 8 bits, an 8-bit frame buffer, axes not at right angles."""
    scene = Scene(
        receivers=[painted(plate(5.0, -1.0), 2), plate(0.4, -0.8, color=(0.9, 0.2, 0.2))],
        caster=ball(0.5, 12),
        offset_axes=((1.0, 0.2, 0.0), (0.3, 0.8, 0.0)),
        offset_range=((-0.5, 0.5), (-0.6, 0.7)),
        offset=(-0.2, 0.3),
        light=lamp(),
        camera=looking(width, height, eye=(-1.0, -3.5, 2.0)),
    )
    params = Params(
        map_size=sizes(width), rows=5, columns=6, content="depth", policy="nearest", light_samples=5, quantize=8, pcf=True,
        bias=0.01, accumulation="unorm8",
    )  # fmt: skip
    return scene, params


def direct(width: int, height: int) -> tuple[Scene, Params]:
    """A cube that shadows itself, from three places, without perspective."""
    camera = Camera.orthographic(
        eye=(-2.0, -3.0, 2.0), target=(0.0, 0.0, -0.3), view_height=3.0, near=0.1, far=12.0, width=width, height=height
    )
    scene = Scene(
        receivers=[plate(1.5, -1.0)],
        caster=box(0.6, color=(0.3, 0.5, 0.9)),
        offset_range=((-0.5, 0.5), (-0.5, 0.5)),
        offset=(0.0, 0.25),
        light=lamp(position=(-1.5, -2.5, 3.0)),
        camera=camera,
        ambient=0.1,
    )
    places = [(-1.5, -2.5, 3.0), (-1.2, -2.6, 3.0), (-1.6, -2.1, 3.0)]
    return scene, Params(map_size=sizes(width), content="depth", method="direct", light_samples=places, bias=2e-3)


def grid(width: int, height: int) -> tuple[Scene, Params]:
    """The mix of four of 4 x 4 maps."""
    scene, _ = soft(width, height)
    return scene, Params(map_size=sizes(width), method="grid", grid_size=4, light_samples=5)


def wavelets(width: int, height: int) -> tuple[Scene, Params]:
    """The same with compressed maps."""
    scene, _ = soft(width, height)
    return scene, Params(
        map_size=sizes(width), method="grid", grid_size=4, grid_storage="haar", grid_threshold=0.05, map_samples=3
    )


def ensemble(width: int, height: int) -> tuple[Ensemble, Params]:
    """A cube and a ball, on axes of their own, under two lights, the second one at half its power."""
    cube = Caster(mesh=painted(box(0.4), 1), offset_range=((-0.9, 0.9), (-0.7, 0.8)), offset=(-0.5, -0.2))
    globe = Caster(
        mesh=ball(0.4, 12), offset_axes=((1.0, 0.2, 0.0), (0.3, 0.8, 0.0)), offset_range=((-0.5, 0.7), (-0.6, 0.7)),
        offset=(0.45, 0.3),
    )  # fmt: skip
    both = Ensemble(
        receivers=[plate(5.0, -1.0, color=(0.6, 0.7, 0.5))],
        casters=[cube, globe],
        lights=[lamp(), lamp(position=(-1.2, 0.6, 3.0), half_edges=((0.2, 0.0, 0.0), (0.0, 0.2, 0.0)))],
        powers=(1.0, 0.5),
        camera=looking(width, height, eye=(1.5, -3.5, 2.5)),
        ambient=0.1,
        background=(0.2, 0.3, 0.5),
    )
    return both, Params(map_size=sizes(width), rows=4, columns=3, light_samples=5)


SCENES: dict[str, Callable[[int, int], tuple[Scene | Ensemble, Params]]] = {
    scene.__name__: scene for scene in (soft, nearest, direct, grid, wavelets, ensemble)
}
