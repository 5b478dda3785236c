"""The way from one camera to another."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.scene import checks
from ibr_ref.scene.projection import clip_from_intrinsics
from ibr_ref.scene.rotations import (
    Quaternion,
    nearest_rotation,
    normalized,
    quaternion,
    rotation_matrix,
    rotation_of,
)
from ibr_ref.scene.vectors import dot


class End(NamedTuple):
    """A camera, as far as the way to another one depends on it. Fields as `Camera`'s."""

    perspective: bool
    width: int
    height: int
    near: float
    far: float
    intrinsics: NDArray[np.float64]
    view_from_world: NDArray[np.float64]
    position: NDArray[np.float64]
    """(3,) where view space has its origin."""


def check_path(first: End, second: End) -> None:
    """Raise ValueError, naming the field, for two cameras that none lies between. `Camera.between` lists them."""
    if second.perspective != first.perspective:
        raise checks.reject("second.perspective", second.perspective, f"{first.perspective}, as of the first camera")
    for name in ("width", "height"):
        if getattr(second, name) != getattr(first, name):
            allowed = f"{getattr(first, name)}, as of the first camera"
            raise checks.reject(f"second.{name}", getattr(second, name), allowed)
    mirrored = [second.intrinsics[i, i] * first.intrinsics[i, i] < 0.0 for i in range(2)]
    if any(mirrored):
        allowed = f"f_x and f_y with the signs of the first camera's, {first.intrinsics.tolist()}"
        raise checks.reject("second.intrinsics", second.intrinsics.tolist(), allowed)
    for name, camera in (("first", first), ("second", second)):
        rotation_matrix(f"{name}.view_from_world", camera.view_from_world[:3, :3])


def fields_between(first: End, second: End, fraction: float) -> dict[str, Any]:
    """What the constructor is given for the camera at a fraction, 0 < fraction < 1, of the way between two checked ones."""

    def lerp(a: Any, b: Any) -> Any:
        return a * (1.0 - fraction) + b * fraction

    k = lerp(first.intrinsics, second.intrinsics)
    near, far = lerp(first.near, second.near), lerp(first.far, second.far)
    at = lerp(first.position, second.position)
    r = rotation_of(_quaternion_between(_orientation(first), _orientation(second), fraction))
    view = np.eye(4)
    view[:3, :3] = r
    view[:3, 3] = [-dot(row, at) for row in r]
    return {
        "view_from_world": view,
        "clip_from_view": clip_from_intrinsics(k, near, far, first.width, first.height, perspective=first.perspective),
        "near": near,
        "far": far,
        "width": first.width,
        "height": first.height,
        "eye": np.append(at, 1.0) if first.perspective else None,
        "intrinsics": k,
    }


def _orientation(camera: End) -> Quaternion:
    """The true rotation nearest to view_from_world's."""
    return normalized(quaternion(nearest_rotation(camera.view_from_world[:3, :3])))


def _quaternion_between(a: Quaternion, b: Quaternion, fraction: float) -> Quaternion:
    """Linear interpolation, normalized. On the shorter arc the sum is never shorter than sqrt(1/2)."""
    cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    weight = fraction if cosine >= 0.0 else -fraction  # q and -q are the same rotation
    x, y, z, w = (p * (1.0 - fraction) + q * weight for p, q in zip(a, b, strict=True))
    return normalized((x, y, z, w))
