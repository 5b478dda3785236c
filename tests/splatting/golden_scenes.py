"""The golden scenes of splatting. `tests/golden.py` renders them. References are about a third of the picture's size."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ibr_ref import Camera, DepthImage, Light, models
from ibr_ref.models.surface_depths import ball_depths, plane_depths
from ibr_ref.splatting import Params, Scene, render
from tests.splatting.scenes import image_of, looking, measured, noise, parallel

__all__ = ["SCENES", "TINY", "render"]

TINY = ("balls", "discs", "ellipses", "pages", "sheared", "within")
"""All but the one whose references are rasterized."""

rig = cache(lambda size: models.depth_rig(models.kettle(), 4, size=size))


def side(width: int) -> int:
    """Of a square reference image."""
    return max(6, 3 * width // 10)


def balls(width: int, height: int) -> tuple[Scene, Params]:
    """Two views of a sphere with masks, in the light of a lamp, with a law of all four parameters."""
    n = side(width)
    cameras = [looking((3.0, -1.5, 1.0), size=(n, n)), looking((-0.5, -3.5, 0.5), size=(n, n - 1))]
    view = looking((1.2, -2.6, 0.9), size=(width, height), vertical_fov=50.0)
    light = Light(position=(1.0, -4.0, 3.0), specular=0.4, exponent=21)
    images = [image_of(camera, ball_depths(camera)) for camera in cameras]
    law = Params(alpha=1.3 * height / n, beta=0.05, gamma=0.1, delta=0.2, min_width=0.0)
    return Scene(images=images, camera=view, light=light), law


def discs(width: int, height: int) -> tuple[Scene, Params]:
    """A plane and a ball without perspective on either side, as discs, in the light of the sun."""
    n = side(width)
    camera = parallel((0.0, -4.0, 3.0), size=(n, n))
    depth = np.fmin(ball_depths(camera, 0.7), plane_depths(camera, (0.0, 0.1, 1.0), -0.5))
    view = parallel((1.0, -4.0, 2.0), size=(width, height), view_height=2.0)
    light = Light(direction=(0.5, -0.8, 1.0), ambient=0.1, specular=0.2)
    scene = Scene(images=[image_of(camera, depth)], camera=view, light=light, background=(0.5, 0.7, 0.9))
    return scene, Params(alpha=height / (0.8 * n), max_width=height / (0.8 * n), shape="disc")


def ellipses(width: int, height: int) -> tuple[Scene, Params]:
    """The balls as elliptical weighted averages, before a plane that a measured camera sees."""
    scene, _ = balls(width, height)
    camera = measured((-1.0, -3.5, 0.5), size=(side(width), side(width)))
    wall = image_of(camera, plane_depths(camera, (0.2, 1.0, 0.1), 1.5))
    scene = Scene(images=[*scene.images, wall], camera=scene.camera, light=scene.light)
    return scene, Params(shape="ellipse", footprint=0.6, low_pass=0.4, cutoff=2.2, depth_tolerance=0.03)


def pages(width: int, height: int) -> tuple[Scene, Params]:
    """Five images, one of them twice so that all its points tie, on three pages, with their own colours."""
    n = side(width)
    sizes = [(n, n), (n, n // 2), (n // 2, n), (n - 1, n - 1)]
    cameras = [
        looking(eye, size=size)
        for eye, size in zip([(3, 0, 1), (0, -3, 1), (-3, 0, 1), (0.5, 0.5, 4)], sizes, strict=True)
    ]
    depths = [3.0 + 0.2 * noise(camera.height, camera.width, seed=i) for i, camera in enumerate(cameras)]
    images = [image_of(camera, depth) for camera, depth in zip(cameras, depths, strict=True)]
    view = looking((2.0, -2.0, 2.0), size=(width, height), vertical_fov=50.0)
    return Scene(images=[*images, images[0]], camera=view, light=None), Params(alpha=3.3, max_atlas_size=n + n // 2)


def sheared(width: int, height: int) -> tuple[Scene, Params]:
    """Measured cameras on either side, splats below and above a pixel, depths with jumps, holes in the mask."""
    n = side(width)
    camera = measured((0.2, -3.0, 0.4), size=(n, n - 1), skew=0.8)
    depth = 3.0 + np.floor(3.0 * noise(n - 1, n, seed=5)) * 0.25 + 0.05 * noise(n - 1, n, seed=6)
    depth[noise(n - 1, n, seed=7) < 0.2] = np.nan
    view = measured((0.6, -2.2, 0.7), size=(width, height), skew=-1.7)
    law = Params(alpha=1.6 * height / n, gamma=1.0, delta=-1.0, min_width=0.8, max_width=1.4 * height / n)
    return Scene(images=[image_of(camera, depth)], camera=view, light=Light(direction=(0, -1, 1))), law


def within(width: int, height: int) -> tuple[Scene, Params]:
    """An eye among the points: some are behind it, some fill the picture."""
    n = side(width)
    camera = looking((0.0, 0.0, 4.0), size=(n, n), up=(0, 1, 0), vertical_fov=60.0)
    image = DepthImage(color=noise(n, n, 3, seed=1), depth=2.5 + 3.0 * noise(n, n, seed=2), camera=camera)
    view = Camera.axis_angle(
        position=(0.1, 0.0, 0.3), orientation=(1.0, 0.2, 0.0, 1.1), field_of_view=(1.6, 1.3), near=0.05, far=3.0,
        width=width, height=height,
    )  # fmt: skip
    light = Light(position=(0.0, 0.0, 2.0), diffuse=0.8, specular=0.2, exponent=0)
    return Scene(images=[image], camera=view, light=light), Params(
        alpha=60.0 * height / n, beta=9.0, delta=0.1, max_width=900
    )


def kettle(width: int, height: int) -> tuple[Scene, Params]:
    """A rig of four pictures of the kettle, packed side by side."""
    view = looking((1.6, -1.3, 1.3), (0.15, 0.0, 0.45), size=(width, height))
    scene = Scene(images=rig(side(width)), camera=view, light=Light(direction=(1.0, -1.0, 1.5), specular=0.5))
    return scene, Params(alpha=5.0 * height / side(width), gamma=1.0, max_atlas_size=2 * side(width))


SCENES: dict[str, Callable[[int, int], tuple[Scene, Params]]] = {
    scene.__name__: scene for scene in (balls, discs, ellipses, pages, sheared, within, kettle)
}
