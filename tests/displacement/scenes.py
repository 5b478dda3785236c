"""Small scenes whose patch space is known without any arithmetic: the unit square at the origin, scale a power of two."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref import BasePolygon, Camera, Light
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.io import Frame

Array = NDArray[np.float64]

SCALE = 0.25
"""World units of h = 1: (u, v, h) is (x, y, 4 z), exactly."""

LIGHT = Light(direction=(0.3, 0.5, 1.0))


def noise(rows: int, columns: int, *channels: int, seed: int = 0) -> Array:
    """Random texels in [0, 1)."""
    return np.random.RandomState(seed).uniform(0, 1, (rows, columns, *channels))


def square(heights: ArrayLike, **more: Any) -> BasePolygon:
    """The unit square at the origin, z up."""
    values: dict[str, Any] = {"corner": (0, 0, 0), "edge_u": (1, 0, 0), "edge_v": (0, 1, 0), "height_scale": SCALE,
                              "height_map": heights, "color_map": noise(7, 5, 3)}  # fmt: skip
    return BasePolygon(**{**values, **more})


def spike(rows: int, columns: int, row: int, column: int, height: float) -> Array:
    """Heights that are 0 but for one texel."""
    heights = np.zeros((rows, columns))
    heights[row, column] = height
    return heights


def block(rows: int, columns: int, begin: int, end: int, height: float) -> Array:
    """A box on texels [begin, end) in both directions; its walls are one texel thick."""
    heights = np.zeros((rows, columns))
    heights[begin:end, begin:end] = height
    return heights


def camera(
    eye: ArrayLike = (1.3, -0.9, 0.6),
    target: ArrayLike = (0.45, 0.5, 0.1),
    width: int = 48,
    height: int = 36,
    **more: Any,
) -> Camera:
    """A perspective camera that sees the square and its surroundings."""
    return Camera.look_at(
        **{"eye": eye, "target": target, "width": width, "height": height, "near": 0.01, "far": 20.0, **more}
    )


def parallel_camera(eye: ArrayLike = (1.3, -0.9, 0.6), target: ArrayLike = (0.45, 0.5, 0.1), **more: Any) -> Camera:
    """An orthographic camera."""
    values = {"eye": eye, "target": target, "view_height": 1.1, "width": 48, "height": 36, "near": 0.01, "far": 20.0}
    return Camera.orthographic(**{**values, **more})


def frame(polygon: BasePolygon, view: Camera, *, light: Light = LIGHT, **params: Any) -> Frame:
    """Render one polygon with all its stages."""
    return render(Scene(polygons=[polygon], camera=view, light=light, background=(0.1, 0.2, 0.3)), Params(**params))


def patch_eye(view: Camera) -> Array:
    """(4,) the eye in the patch space of `square`."""
    return view.eye * (1.0, 1.0, 1.0 / SCALE, 1.0)


def same(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """Equal, bit for bit but for the sign of a zero; NaN equals NaN."""
    return a.shape == b.shape and a.dtype == b.dtype and bool(((a == b) | ((a != a) & (b != b))).all())
