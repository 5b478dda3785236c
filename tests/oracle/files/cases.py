"""Small cases of all methods, between them with every kind of camera, light, map and mesh."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ibr_ref import Camera, DepthImage, Light, displacement, shadows, splatting
from ibr_ref.models.surface_depths import ball_depths, plane_depths
from ibr_ref.oracle.cases import Case
from ibr_ref.scene import Mesh
from tests.displacement import scenes as polygons
from tests.shadows import scenes as stages
from tests.splatting import scenes as points


def case(name: str, method: str, scene: Any, params: Any, **inputs: Any) -> Case:
    """With what the tests do not care about."""
    about = f"{name}, for the tests of files"
    return Case(
        name=name, method=method, kind="easy", about=about, profile="vulkan", scene=scene, params=params, inputs=inputs
    )


def displacement_maps() -> Case:
    """Two polygons with all maps, one of them in bytes; a light at a point."""
    whole = np.rint(255 * polygons.noise(5, 4)) / 255.0
    facade = {"facade_map": polygons.noise(3, 3, 3), "facade_tile": (0.3, 0.2)}
    scene = displacement.Scene(
        polygons=[
            polygons.square(polygons.block(6, 5, 1, 4, 0.8), normal_map=0.5 + 0.5 * polygons.noise(4, 4, 3), **facade),
            polygons.square(whole, corner=(1.1, 0.1, 0.0), edge_v=(0.3, 0.9, 0.1)),
        ],
        camera=polygons.camera(width=24, height=18),
        light=Light(position=(0.3, 0.5, 2.0), specular=0.3, exponent=5),
        background=(0.1, 0.2, 0.3),
    )
    return case("maps", "displacement", scene, displacement.Params(linear_steps=7, binary_steps=3, shadow_steps=4))


def displacement_parallel() -> Case:
    """An orthographic camera and a light without a place; a map that repeats."""
    scene = displacement.Scene(
        polygons=[polygons.square(polygons.noise(6, 7), domain="repeat")],
        camera=polygons.parallel_camera(width=24, height=18),
        light=Light(direction=(0.1, 0.7, 3.0)),
    )
    return case("parallel", "displacement", scene, displacement.Params(faces="base", depth="polygon"))


def _axis_angle(width: int, height: int) -> Camera:
    return Camera.axis_angle(
        position=(0.1, -4.0, 0.3), orientation=(1.0, 0.02, 0.01, 1.5), field_of_view=(0.7, 0.55),
        near=0.5, far=20.0, width=width, height=height,
    )  # fmt: skip


def splatting_cameras() -> Case:
    """References of a measured, an orthographic and an axis-angle camera, on two pages."""
    cameras = [points.measured((0.3, -4.0, 1.0), size=(16, 12)), points.parallel((3.0, -2.0, 1.0), size=(16, 12)),
               _axis_angle(15, 11)]  # fmt: skip
    images = [points.image_of(camera, ball_depths(camera)) for camera in cameras]
    codes = np.rint(255 * points.noise(12, 16, 3)) / 255.0
    images[1] = DepthImage(color=codes, depth=images[1].depth, camera=cameras[1], mask=images[1].mask)
    scene = splatting.Scene(images=images, camera=points.looking((1.0, -4.0, 1.0)), light=Light(position=(2, -3, 4)))
    return case("cameras", "splatting", scene, splatting.Params(alpha=2.5, beta=0.01, max_atlas_size=20))


def splatting_colors() -> Case:
    """Stored colours, every pixel a point, normals given by the case; the picture's camera is a measured one."""
    camera = points.looking((0.0, -4.0, 0.5), size=(10, 8))
    images = [points.image_of(camera, plane_depths(camera, (0.0, 1.0, 0.1), 0.3))]
    scene = splatting.Scene(images=images, camera=points.measured((0.2, -4.1, 0.4), size=(20, 16)), light=None)
    normals = splatting.render(scene).stages["atlas.normal"][0]
    return case("colors", "splatting", scene, splatting.Params(alpha=2.0, shape="disc"), normals=[normals])


def shadows_warped() -> Case:
    """Five samples of the light, a caster with a colour at each vertex."""
    box = stages.box()
    caster = Mesh(vertices=box.vertices, triangles=box.triangles, color=points.noise(8, 3))
    scene = stages.scene(caster=caster, background=(0.2, 0.1, 0.3), camera=_floor_camera())
    params = stages.params(map_size=24, light_samples=5, map_samples=2)
    return case("warped", "shadows", scene, params, maps=shadows.prepare(scene, params, controls="bounds"))


def shadows_depths() -> Case:
    """Depth maps, compared in 8 bits; two receivers, axes that are not at right angles, an orthographic camera."""
    receivers = [stages.plate(6.0, -1.0), stages.plate(0.7, -0.8, color=(0.2, 0.4, 0.6))]
    camera = Camera.orthographic(eye=(0.5, -4.0, 2.5), target=(0, 0, -0.7), view_height=4.0, width=24, height=18)
    scene = stages.scene(receivers=receivers, offset_axes=((1.0, 0.0, 0.0), (0.3, 0.9, 0.0)), camera=camera)
    params = stages.params(map_size=24, content="depth", quantize=8, pcf=True, policy="nearest")
    return case("depths", "shadows", scene, params, maps=shadows.prepare(scene, params, controls="identity"))


def shadows_direct() -> Case:
    """No prepared maps; samples of the light by their positions."""
    scene = stages.scene(camera=_floor_camera())
    params = stages.params(map_size=24, method="direct", light_samples=[(0.0, 0.0, 4.0), (0.1, -0.05, 4.0)])
    return case("direct", "shadows", scene, params)


def _floor_camera() -> Camera:
    return Camera.look_at(eye=(0.5, -4.0, 2.5), target=(0, 0, -0.7), near=0.1, far=20, width=24, height=18)


CASES: dict[str, Callable[[], Case]] = {
    "maps": displacement_maps,
    "parallel": displacement_parallel,
    "cameras": splatting_cameras,
    "colors": splatting_colors,
    "warped": shadows_warped,
    "depths": shadows_depths,
    "direct": shadows_direct,
}
FULL = ("maps", "cameras", "warped")
"""The case of each method with the most files."""
