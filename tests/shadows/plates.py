"""Scenes with closed forms: a plate over a floor, under a light that looks straight down."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from ibr_ref.scene import Camera

HEIGHT = 4.0  # of the light, over the floor z = 0
PLATE_HEIGHT = 1.5
HALF_PLATE = 0.3

CLOSE_UP = Camera.look_at(
    eye=(0.4, -1.0, 5), target=(0.4, 0.4, 0), up=(0, 0, 1), vertical_fov=22, near=1, far=20, width=24, height=18
)


def mesh(vertices: Any, triangles: Any, color: Any) -> SimpleNamespace:
    return SimpleNamespace(vertices=np.array(vertices), triangles=np.array(triangles), color=np.array(color))


def square(half: float, z: float, color: Any) -> SimpleNamespace:
    vertices = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
    return mesh(vertices, [(0, 1, 2), (0, 2, 3)], color)


def example(**changes: Any) -> SimpleNamespace:
    """A plate over a floor, both facing the light and the camera, all axis-aligned."""
    light = SimpleNamespace(
        position=(0.1, -0.2, HEIGHT),
        target=(0.1, -0.2, 0.0),
        up=(0.0, 1.0, 0.0),
        vertical_fov=60.0,
        near=1.0,
        far=10.0,
        half_edges=((0.2, 0.0, 0.0), (0.0, 0.1, 0.0)),
    )
    scene = {
        "receivers": [square(3.0, 0.0, (0.5, 0.6, 0.7))],
        "caster": square(HALF_PLATE, PLATE_HEIGHT, (0.9, 0.2, 0.1)),
        "offset_axes": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
        "offset_range": ((-0.5, 0.6), (-0.4, 0.5)),
        "offset": (0.3, 0.2),
        "light": light,
        "camera": Camera.look_at(
            eye=(0, -3, 5), target=(0, 0, 0), up=(0, 0, 1), vertical_fov=40, near=1, far=20, width=24, height=18
        ),
        "ambient": 0.25,
        "background": (0.0, 0.0, 0.1),
    }
    return SimpleNamespace(**{**scene, **changes})


def parameters(**changes: Any) -> SimpleNamespace:
    values = {
        "map_size": 32,
        "content": "mask",
        "map_samples": 1,
        "quantize": None,
        "pcf": False,
        "bias": 1e-3,
        "policy": "dissolve",
        "light_samples": 1,
        "accumulation": "float",
        "method": "warp",
    }
    return SimpleNamespace(**{**values, **changes})


def regular_grid(rows: int, columns: int) -> np.ndarray:
    v, u = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    return np.stack([u, v], axis=-1)


def same_controls(rows: int = 3, columns: int = 4) -> np.ndarray:
    return np.broadcast_to(regular_grid(rows, columns), (3, 3, rows, columns, 2))


def moved_controls(seed: int, rows: int = 3, columns: int = 4) -> np.ndarray:
    """Nine grids with inner points moved by up to 0.08: none folds."""
    controls = same_controls(rows, columns).copy()
    random = np.random.default_rng(seed)
    controls[:, :, 1:-1, 1:-1] += random.uniform(-0.08, 0.08, controls[:, :, 1:-1, 1:-1].shape)
    return controls


def rigid_controls(scene: Any, positions: np.ndarray) -> np.ndarray:
    """Controls whose inner 2 x 2 points are the corners of a square well around the plate, in every map."""
    focal = 1.0 / math.tan(math.radians(30.0))
    scale = focal / (HEIGHT - PLATE_HEIGHT) / 2
    controls = same_controls(4, 4).copy()
    for j in range(3):
        for i in range(3):
            u = 0.5 + (positions[j, i, 0] - scene.light.position[0]) * scale
            v = 0.5 - (positions[j, i, 1] - scene.light.position[1]) * scale
            reach = (HALF_PLATE + 0.2) * scale
            controls[j, i, 1:3, 1:3, 0] = [u - reach, u + reach]
            controls[j, i, 1:3, 1:3, 1] = [[v - reach], [v + reach]]
    return controls


def soft_scene(half_edge: float) -> SimpleNamespace:
    """A light of a size, and the camera on the shadow's edge."""
    scene = example(camera=CLOSE_UP)
    scene.light.half_edges = ((half_edge, 0.0, 0.0), (0.0, half_edge, 0.0))
    return scene
