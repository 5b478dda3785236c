"""Where a page looks from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.scene import Camera, checks, look_at

_LEVEL = 1e-9
"""How far a level axis may be off, as rounding leaves it."""


@dataclass(frozen=True)
class Pose:
    """The eye, what it looks at, and how near the picture is drawn."""

    eye: tuple[float, ...]
    target: tuple[float, ...]
    up: tuple[float, ...]
    zoom: float
    """The picture is so many times as large as the camera's own."""

    @classmethod
    def read(cls, fields: object) -> Pose:
        """Of a page. Raises ValueError for what is none."""
        if not isinstance(fields, dict) or set(fields) != {"eye", "target", "up", "zoom"}:
            raise checks.reject("camera", fields, "eye, target, up and zoom")
        eye, target, up = (tuple(checks.vector(name, fields[name]).tolist()) for name in ("eye", "target", "up"))
        return cls(eye, target, up, checks.number("zoom", fields["zoom"], low=1e-3, high=1e3))

    @classmethod
    def of(cls, camera: Camera, points: Floats) -> Pose:
        """A camera's own; the target is the point on its axis beside the middle of points (N, 3): it is turned about."""
        world = camera.world_from_view
        eye, forward = world[:3, 3], -world[:3, 2] / np.linalg.norm(world[:3, 2])
        middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
        reach = float(np.abs(points - middle).max()) or 1.0
        distance = max(float((middle - eye) @ forward), 0.1 * reach)
        return cls(tuple(eye.tolist()), tuple((eye + distance * forward).tolist()), _up(world), 1.0)

    def fields(self) -> Mapping[str, Any]:
        """For the page."""
        return vars(self)

    def seen(self, camera: Camera) -> Camera:
        """The camera there, with its own projection. Raises ValueError for an eye that sees nothing."""
        clip = camera.clip_from_view.copy()
        clip[:2] *= self.zoom
        found: dict[str, Any] = {
            "view_from_world": look_at.view_from_world(self.eye, self.target, self.up),
            "clip_from_view": clip,
            "eye": np.array([*self.eye, 1.0]) if camera.perspective else None,
            "intrinsics": camera.intrinsics if self.zoom == 1.0 else None,
        }
        return replace(camera, **found)


def _up(world_from_view: Floats) -> tuple[float, ...]:
    """The world's axis about which a level camera turns, z before y; else the camera's own."""
    right, above = world_from_view[:3, 0], world_from_view[:3, 1]
    for axis in (2, 1):
        if abs(right[axis]) <= _LEVEL < abs(above[axis]):
            return tuple((np.eye(3)[axis] * np.copysign(1.0, above[axis])).tolist())
    return tuple(above.tolist())
