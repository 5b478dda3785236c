"""Depths of surfaces along a camera's lines of sight, in closed form. The same bits on every machine: no BLAS, no sine."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.scene import Camera


def ball_depths(camera: Camera, radius: float = 1.0, middle: ArrayLike = (0, 0, 0)) -> Floats:
    """(H, W) depths where a sphere is met first; NaN beside it."""
    start, way = rays(camera)
    start = start - np.asarray(middle, np.float64)
    a, b, c = dots(way, way), dots(start, way), dots(start, start) - radius * radius
    root = b * b - a * c
    return np.asarray((-b - np.sqrt(np.where(root >= 0.0, root, np.nan))) / a, np.float64)


def plane_depths(camera: Camera, normal: ArrayLike, offset: float) -> Floats:
    """(H, W) depths of the plane normal . p = offset; NaN where it is not before the camera."""
    start, way = rays(camera)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (offset - dots(start, normal)) / dots(way, normal)
    return np.where(depth > 0.0, depth, np.nan)


def rays(camera: Camera) -> tuple[Floats, Floats]:
    """(H, W, 3) twice: where the lines of sight through the pixels' centres have depth 0, and the way for a depth of 1."""
    (f_x, s, c_x), (_, f_y, c_y), _ = camera.intrinsics
    column, row = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    y = (row - c_y) / f_y
    x = (column - c_x - s * y) / f_x
    zero, one = np.zeros_like(x), np.ones_like(x)
    m = camera.world_from_view

    def world(p: tuple[Floats, Floats, Floats], w: float) -> Floats:
        return np.stack([a[0] * p[0] + a[1] * p[1] + a[2] * p[2] + a[3] * w for a in m[:3]], axis=2)

    if camera.perspective:
        return world((zero, zero, zero), 1.0), world((x, -y, -one), 0.0)
    return world((x, -y, zero), 1.0), world((zero, zero, -one), 0.0)


def dots(a: Floats, b: ArrayLike) -> Floats:
    """Dot products of vectors (..., 3), summed from left to right."""
    b = np.asarray(b, np.float64)
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2], np.float64)
