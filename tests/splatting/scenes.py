"""Reference images of surfaces whose depths are known in closed form. The same bits on every machine: no BLAS, no sine."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref import Camera, DepthImage, Light
from ibr_ref.io import Frame
from ibr_ref.splatting import Params, Scene, render

Array = NDArray[np.float64]


def noise(*shape: int, seed: int = 0) -> Array:
    """Random numbers in [0, 1)."""
    return np.random.RandomState(seed).random_sample(shape)


def looking(eye: ArrayLike, target: ArrayLike = (0, 0, 0), *, size: tuple[int, int] = (32, 24), **more: Any) -> Camera:
    """A perspective camera for pictures of that size, width and height."""
    view = {"vertical_fov": 40.0, "near": 0.5, "far": 20.0, "width": size[0], "height": size[1]}
    return Camera.look_at(eye=eye, target=target, **{**view, **more})


def parallel(eye: ArrayLike, target: ArrayLike = (0, 0, 0), *, size: tuple[int, int] = (32, 24), **more: Any) -> Camera:
    """An orthographic camera for pictures of that size."""
    view = {"view_height": 2.5, "near": 0.5, "far": 20.0, "width": size[0], "height": size[1]}
    return Camera.orthographic(eye=eye, target=target, **{**view, **more})


def measured(eye: ArrayLike, target: ArrayLike = (0, 0, 0), *, size: tuple[int, int] = (32, 24), skew: float = 0.4,
             error: float = 1e-4) -> Camera:  # fmt: skip
    """A calibrated camera: sheared pixels that are not square, the centre off the middle, not quite a rotation."""
    plain = looking(eye, target, size=size)
    k = plain.intrinsics * np.array([[1.0, 1.0, 1.0], [1.0, 0.97, 1.0], [1.0, 1.0, 1.0]])
    k = k + np.array([[0.0, skew, 0.3], [0.0, 0.0, -0.2], [0.0, 0.0, 0.0]])
    off = error * np.array([[0.1, -0.2, 0.3], [0.2, 0.1, -0.1], [-0.3, 0.2, 0.1]])
    view = plain.view_from_world
    return Camera.calibrated(intrinsics=k, rotation=view[:3, :3] + off, translation=view[:3, 3], near=0.5, far=20.0,
                             width=size[0], height=size[1])  # fmt: skip


def rays(camera: Camera) -> tuple[Array, Array]:
    """(H, W, 3) twice: where the lines of sight through the pixels' centres have depth 0, and the way for a depth of 1."""
    (f_x, s, c_x), (_, f_y, c_y), _ = camera.intrinsics
    column, row = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    y = (row - c_y) / f_y
    x = (column - c_x - s * y) / f_x
    zero, one = np.zeros_like(x), np.ones_like(x)
    m = camera.world_from_view

    def world(p: tuple[Array, Array, Array], w: float) -> Array:
        return np.stack([a[0] * p[0] + a[1] * p[1] + a[2] * p[2] + a[3] * w for a in m[:3]], axis=2)

    if camera.perspective:
        return world((zero, zero, zero), 1.0), world((x, -y, -one), 0.0)
    return world((x, -y, zero), 1.0), world((zero, zero, -one), 0.0)


def dots(a: Array, b: ArrayLike) -> Array:
    """Dot products of vectors (..., 3), summed from left to right."""
    b = np.asarray(b, np.float64)
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def plane_depths(camera: Camera, normal: ArrayLike, offset: float) -> Array:
    """(H, W) depths of the plane normal . p = offset; NaN where it is not before the camera."""
    start, way = rays(camera)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (offset - dots(start, normal)) / dots(way, normal)
    return np.where(depth > 0.0, depth, np.nan)


def ball_depths(camera: Camera, radius: float = 1.0, middle: ArrayLike = (0, 0, 0)) -> Array:
    """(H, W) depths where a sphere is met first; NaN beside it."""
    start, way = rays(camera)
    start = start - np.asarray(middle, np.float64)
    a, b, c = dots(way, way), dots(start, way), dots(start, start) - radius * radius
    root = b * b - a * c
    return (-b - np.sqrt(np.where(root >= 0.0, root, np.nan))) / a


def box_depths(camera: Camera, half: float = 1.0) -> Array:
    """(H, W) depths where the cube [-half, half]^3 is met first; NaN beside it."""
    start, way = rays(camera)
    with np.errstate(divide="ignore"):
        one, other = (-half - start) / way, (half - start) / way
    enter, leave = np.minimum(one, other).max(axis=2), np.maximum(one, other).min(axis=2)
    return np.where((enter < leave) & (enter > 0.0), enter, np.nan)


def image_of(camera: Camera, depth: Array, color: Array | None = None) -> DepthImage:
    """A reference image, its mask where the depth is not NaN; random colours unless some are given."""
    color = noise(*depth.shape, 3, seed=depth.size) if color is None else color
    return DepthImage(color=color, depth=depth, camera=camera, mask=~np.isnan(depth))


def frame(images: list[DepthImage], camera: Camera, light: Light | None = None, **params: Any) -> Frame:
    """Render with all stages."""
    return render(Scene(images=images, camera=camera, light=light, background=(0.1, 0.2, 0.3)), Params(**params))


def points(image: DepthImage) -> Array:
    """(H, W, 3) the world positions of its pixels; NaN off the mask."""
    start, way = rays(image.camera)
    _, depth, mask = image.arrays
    return np.where(mask[..., None], start + way * depth[..., None], np.nan)
