"""Small scenes to sweep over."""

from __future__ import annotations

import numpy as np

from ibr_ref import models
from ibr_ref.displacement import Scene
from ibr_ref.scene import BasePolygon, Camera, Light


def bumps(width: int = 24, height: int = 18, seed: int = 0) -> Scene:
    """Random blocks on a square, greys by height."""
    heights = np.zeros((16, 16))
    heights[2:-2, 2:-2] = np.random.RandomState(seed).random_sample((6, 6)).repeat(2, axis=0).repeat(2, axis=1)
    polygon = BasePolygon(
        corner=(-0.5, -0.5, 0.0),
        edge_u=(1.0, 0.0, 0.0),
        edge_v=(0.0, 1.0, 0.0),
        height_map=heights,
        color_map=heights[..., None].repeat(3, axis=2),
        height_scale=0.3,
    )
    camera = Camera.look_at(eye=(0.7, -1.0, 0.9), target=(0, 0, 0), near=0.1, far=9, width=width, height=height)
    return Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.5, -0.8, 1.0)))


def rig() -> tuple[list, Camera]:
    """Four references of the kettle, and a view."""
    camera = Camera.look_at(eye=(1.0, -1.15, 1.15), target=(0.1, 0, 0.4), near=0.05, far=10, width=48, height=36)
    return models.depth_rig(models.kettle(), 4, size=48), camera
