"""Scenes of splatting on which every bug of the ports can show, each for some of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ibr_ref import Camera, DepthImage, Light
from ibr_ref.models.surface_depths import ball_depths, plane_depths
from ibr_ref.oracle.cases.splatting import CASES
from ibr_ref.splatting import Params, Scene
from tests.splatting.scenes import Array, image_of, looking, measured, noise, parallel

VIEW = (96, 72)
"""Columns and rows of the pictures."""


def painted(camera: Camera, depth: Array) -> DepthImage:
    """A reference image with smooth colours, off its mask too."""
    row, column = np.indices(depth.shape)
    red, green = column / camera.width, row / camera.height
    color = np.stack([0.2 + 0.7 * red, 0.9 - 0.8 * green, 0.3 + 0.2 * red * green], axis=2)
    return DepthImage(color=color, depth=depth, camera=camera, mask=~np.isnan(depth))


def lamp() -> tuple[Scene, Params]:
    """Measured cameras of two balls and the ground: skew, true masks, a highlight, a law of all parameters, a background."""
    sizes = [(44, 30), (40, 34)]
    cameras = [
        measured(eye, size=size, skew=2.0, error=3e-4)
        for eye, size in zip([(2.6, -2.2, 1.4), (-0.8, -3.2, 1.0)], sizes, strict=True)
    ]
    view = measured((1.2, -2.6, 0.9), size=VIEW, skew=-1.5, error=3e-4)
    light = Light(position=(1.0, -2.5, 2.0), ambient=0.2, diffuse=0.8, specular=0.6, exponent=60)
    images = []
    for camera in cameras:
        balls = np.fmin(ball_depths(camera, 0.7), ball_depths(camera, 0.3, (0.9, 0.2, 0.4)))
        ground = plane_depths(camera, (0.0, 0.1, 1.0), -0.6)
        images.append(painted(camera, np.fmin(balls, np.where(ground < 6.0, ground, np.nan))))
    law = Params(alpha=3.4, beta=0.07, gamma=0.15, delta=0.2, min_width=2.7, max_width=3.4)
    return Scene(images=images, camera=view, light=light, background=(0.2, 0.4, 0.7)), law


def sun() -> tuple[Scene, Params]:
    """Without perspective on either side: discs whose width falls with the depth, overbright in the sun."""
    camera = parallel((0.5, -4.0, 3.0), size=(40, 32))
    depth = np.fmin(ball_depths(camera, 0.7), plane_depths(camera, (0.0, 0.1, 1.0), -0.5))
    view = parallel((1.0, -4.0, 2.0), size=VIEW, view_height=2.0)
    light = Light(direction=(0.8, 0.9, 0.5), ambient=0.2, diffuse=1.0, specular=0.5, exponent=40)
    scene = Scene(images=[painted(camera, depth)], camera=view, light=light, background=(0.5, 0.7, 0.9))
    return scene, Params(alpha=12.0, gamma=0.5, max_width=12.0, shape="disc")


def shelves() -> tuple[Scene, Params]:
    """Images of unequal heights on three pages, two of which they just fill, in their own colours: noisy depths."""
    sizes = [(12, 20), (20, 12), (20, 12), (12, 12), (32, 32), (24, 10)]
    eyes = [(3.0, 0.1, 1.0), (0.1, -3.0, 1.0), (-3.0, 0.0, 1.2), (0.5, 0.5, 4.0), (2.2, -2.2, 0.5), (0.0, 3.0, 0.5)]
    cameras = [looking(eye, size=size) for eye, size in zip(eyes, sizes, strict=True)]
    images = [image_of(c, 3.0 + 0.3 * noise(c.height, c.width, seed=i)) for i, c in enumerate(cameras)]
    view = looking((2.0, -2.0, 2.0), size=VIEW, vertical_fov=50.0)
    return Scene(images=images, camera=view, light=None), Params(alpha=3.3, max_atlas_size=32)


def among() -> tuple[Scene, Params]:
    """An eye among the points: some behind it, some before the near plane and beyond the far one, some fill the picture."""
    camera = looking((0.0, 0.0, 4.0), size=(30, 24), up=(0, 1, 0), vertical_fov=60.0)
    image = DepthImage(color=noise(24, 30, 3, seed=1), depth=2.5 + 3.0 * noise(24, 30, seed=2), camera=camera)
    view = Camera.axis_angle(
        position=(0.1, 0.0, 0.3), orientation=(1.0, 0.2, 0.0, 1.1), field_of_view=(1.6, 1.3), near=0.3, far=1.2,
        width=VIEW[0], height=VIEW[1],
    )  # fmt: skip
    light = Light(position=(0.0, 0.3, -0.5), specular=0.2, exponent=0)
    return Scene(images=[image], camera=view, light=light), Params(alpha=7.0, beta=2.0, delta=0.1, max_width=40.0)


def terraces(shift: float = 0.0) -> tuple[Scene, Params]:
    """Seen straight from above, without rounding: splats end on the pixels' centres, and those of one terrace tie."""
    camera = parallel((0.0, 0.0, 8.0), size=(48, 32), up=(0, 1, 0), view_height=2.0)
    view = parallel((shift, shift, 8.0), (shift, shift, 0.0), size=(64, 64), up=(0, 1, 0), view_height=4.0)
    levels = np.kron(np.floor(4.0 * noise(8, 12, seed=3)), np.ones((4, 4)))
    depth = 6.0 + 0.125 * levels + 0.03125 * np.floor(3.0 * noise(32, 48, seed=4))
    return Scene(images=[painted(camera, depth)], camera=view, light=None, background=(0.1, 0.2, 0.3)), Params(
        alpha=2.0
    )


def ties() -> tuple[Scene, Params]:
    """The same, 1/512 pixel beside it: every centre lies in the middle between two subpixels."""
    return terraces(1.0 / 16.0 / 512.0)


def dust() -> tuple[Scene, Params]:
    """A ball of splats smaller than a pixel, by a law that reaches both of its limits."""
    camera = looking((0.3, -3.0, 0.6), size=(60, 48))
    image = painted(camera, ball_depths(camera))
    view = looking((1.0, -1.9, 0.8), size=VIEW)
    light = Light(direction=(1.0, -2.0, 1.0), ambient=0.1, specular=0.3, exponent=32)
    law = Params(alpha=1.0, beta=0.25, gamma=0.1, delta=0.3, min_width=0.25, max_width=1.5)
    return Scene(images=[image], camera=view, light=light, background=(0.3, 0.3, 0.3)), law


def ellipses() -> tuple[Scene, Params]:
    """Those of the case."""
    case = CASES["splatting-ellipses"]()
    return case.scene, case.params


def ovals() -> tuple[Scene, Params]:
    """Orthographic ones, of the case; some are dropped."""
    case = CASES["splatting-ovals"]()
    return case.scene, case.params


SCENES: dict[str, Callable[[], tuple[Scene, Params]]] = {
    scene.__name__: scene for scene in (lamp, sun, shelves, among, terraces, ties, dust, ellipses, ovals)
}
