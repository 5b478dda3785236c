"""The light that shadow maps are rendered from: a spot light, and the rectangle around it that softens its shadow."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import checks
from ibr_ref.scene.camera import Camera
from ibr_ref.scene.vectors import dot


@dataclass(frozen=True, kw_only=True, eq=False)
class AreaLight:
    """A light that sees what it lights through a square frustum (Kang & Ihm 2002, section 2.2.1).

    Raises ValueError for what is no camera either: target at the position, `up` along the line of sight, a field of
    view that is not between 0 and 180 degrees, near and far out of order.
    """

    position: ArrayLike
    """(3,) the centre, in world space."""
    target: ArrayLike
    """(3,) the point in the middle of the maps."""
    up: ArrayLike = (0.0, 1.0, 0.0)
    """(3,) upwards in the maps."""
    vertical_fov: float = 45.0
    """Degrees, both ways."""
    near: float = 0.1
    far: float = 100.0
    half_edges: ArrayLike = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    """(2, 3) a and b: the light is the parallelogram position +- a +- b. Zero: a point."""

    def __post_init__(self) -> None:
        for name in ("position", "target", "up"):
            object.__setattr__(self, name, checks.vector(name, getattr(self, name)))
        object.__setattr__(self, "half_edges", checks.matrix("half_edges", self.half_edges, 2, 3))
        for name in ("near", "far"):
            object.__setattr__(self, name, getattr(self._centre, name))
        object.__setattr__(self, "vertical_fov", float(self.vertical_fov))

    @cached_property
    def _centre(self) -> Camera:
        """The camera of the centre, for a picture of one pixel: its focal length is the same in x and y, to the last bit."""
        return Camera.look_at(
            eye=self.position,
            target=self.target,
            up=self.up,
            vertical_fov=self.vertical_fov,
            near=self.near,
            far=self.far,
            width=1,
            height=1,
        )

    def camera(self, size: int, position: ArrayLike | None = None) -> Camera:
        """What the light sees in a map of `size` x `size`; from another position it looks the same way, bit for bit."""
        eye = self.arrays[0] if position is None else checks.vector("position", position)
        view = self._centre.view_from_world.copy()
        view[:3, 3] = [-dot(axis, eye) for axis in view[:3, :3]]
        return Camera(
            view_from_world=view,
            clip_from_view=self._centre.clip_from_view,
            near=self.near,
            far=self.far,
            width=size,
            height=size,
            eye=np.append(eye, 1.0),
        )

    @property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """position and half_edges as arrays."""
        return np.asarray(self.position), np.asarray(self.half_edges)
