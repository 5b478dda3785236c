"""Reference images as the kernels see them, and what is made of each once: its points and its normals."""

from __future__ import annotations

from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ibr_ref.scene import Camera, DepthImage, Light
from ibr_ref.splatting.buffers import Lighting, Reference, View
from ibr_ref.splatting.normals import normals


class Prepared:
    """A reference image with its list of points; the normals follow where they are asked for."""

    def __init__(self, image: DepthImage) -> None:
        color, depth, mask = image.arrays
        counts = mask.sum(axis=1, dtype=np.int64)
        camera = image.camera
        self.reference = Reference(
            color=color.reshape(-1, 3),
            depth=depth.reshape(-1),
            pixels=np.flatnonzero(mask).astype(np.int32),
            row_starts=np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)]),
            columns=mask.shape[1],
            perspective=camera.perspective,
            intrinsics=camera.intrinsics.copy(),
            world_from_view=camera.world_from_view,
            eye=camera.eye.copy(),
        )

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.reference.columns, len(self.reference.row_starts) - 1

    @property
    def points(self) -> int:
        """Valid pixels."""
        return len(self.reference.pixels)

    @cached_property
    def normals(self) -> NDArray[np.uint8]:
        """(P, 3) 8-bit normals."""
        return normals(self.reference)


_PREPARED: WeakKeyDictionary[DepthImage, Prepared] = WeakKeyDictionary()
"""For as long as their images live: an image is frozen, and so is what follows from it."""


def prepare(image: DepthImage) -> Prepared:
    """The image as the kernels see it, made once."""
    if image not in _PREPARED:
        _PREPARED[image] = Prepared(image)
    return _PREPARED[image]


def view_of(camera: Camera) -> View:
    """The picture's camera as the kernels see it."""
    return View(
        view_from_world=camera.view_from_world.copy(),
        clip_from_view=camera.clip_from_view.copy(),
        eye=camera.eye.copy(),
        perspective=camera.perspective,
        width=float(camera.width),
        height=float(camera.height),
    )


def lighting_of(light: Light | None) -> Lighting:
    """The light, or none, as the kernels see it."""
    if light is None:
        return Lighting(False, np.zeros(4), np.zeros(3), 0)
    phong = np.array([light.ambient, light.diffuse, light.specular])
    return Lighting(True, light.homogeneous, phong, light.exponent)
