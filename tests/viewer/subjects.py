"""Small things to look at, one of each method."""

from __future__ import annotations

import numpy as np

from ibr_ref import Camera, DepthImage, models, shadows, splatting
from ibr_ref.displacement import Params
from ibr_ref.viewer import Subject
from tests.displacement import scenes


def block() -> Subject:
    """A block on a square."""
    polygon = scenes.square(scenes.block(12, 12, 4, 8, 0.75))
    scene = scenes.Scene(polygons=[polygon], camera=scenes.camera(), light=scenes.LIGHT)
    return Subject(scene=scene, params=Params(), title="block")


def wall() -> Subject:
    """A wall that one depth image has seen, without a light."""
    camera = Camera.orthographic(
        eye=(0, 0, 1), target=(0, 0, 0), up=(0, 1, 0), view_height=2, near=0.5, far=2, width=24, height=18
    )
    seen = DepthImage(color=np.full((18, 24, 3), 0.5), depth=np.ones((18, 24)), camera=camera)
    return Subject(scene=splatting.Scene(images=[seen], camera=camera, light=None), params=splatting.Params())


def sphere() -> Subject:
    """The shadow of a sphere."""
    scene = models.shadow_stage(models.sphere(), width=40, height=30)
    return Subject(scene=scene, params=shadows.Params(map_size=32, rows=3, columns=3))


SUBJECTS = {"displacement": block, "splatting": wall, "shadows": sphere}

MOVED = {"eye": [1.5, -0.4, 0.9], "target": [0.5, 0.5, 0.0], "up": [0, 0, 1], "zoom": 1.0}
"""A camera of a page."""
