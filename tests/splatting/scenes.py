"""Reference images of surfaces whose depths are known in closed form. The same bits on every machine: no BLAS, no sine."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref import Camera, DepthImage, Light
from ibr_ref.io import Frame
from ibr_ref.models.surface_depths import rays
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
