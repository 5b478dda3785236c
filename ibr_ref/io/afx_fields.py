"""The AFX fields of a camera that was made otherwise: what `Camera.axis_angle` would have to be given."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ibr_ref.scene import Camera, checks
from ibr_ref.scene.axis_angle import AxisAngle
from ibr_ref.scene.rotations import quaternion
from ibr_ref.scene.trigonometry import arctangent

_TOLERANCE = 1e-12
"""By which a camera may miss what the fields express: more than rounding, far less than any measurement."""


def fields_of(camera: Camera) -> AxisAngle:
    """Position, orientation and fieldOfView of any camera, to rounding.

    Raises ValueError for what they cannot express: a skew, a centre off the picture's, a measured rotation.
    """
    (f_x, s, c_x), (_, f_y, c_y), _ = camera.intrinsics.tolist()
    half_width, half_height = camera.width / 2.0, camera.height / 2.0
    off = max(abs(s) / abs(f_x), abs(c_x - half_width) / half_width, abs(c_y - half_height) / half_height)
    if off > _TOLERANCE or f_x < 0.0 or f_y < 0.0:
        allowed = f"in AFX fields: no skew, no mirroring, the picture's centre [{half_width}, {half_height}]"
        raise checks.reject("camera.intrinsics", camera.intrinsics.tolist(), allowed)
    r = camera.view_from_world[:3, :3]
    defect = float(np.abs(r.T @ r - np.eye(3)).max())
    if defect > _TOLERANCE or np.linalg.det(r) < 0.0:
        allowed = f"in AFX fields: a rotation, R^T R - I within {_TOLERANCE:g} (here {defect:.3g}): no measured one"
        raise checks.reject("camera.view_from_world", r.tolist(), allowed)
    if camera.perspective:
        position, sizes = camera.eye[:3], [2.0 * arctangent(half_width, f_x), 2.0 * arctangent(half_height, f_y)]
    else:
        position, sizes = camera.world_from_view[:3, 3], [camera.width / f_x, camera.height / f_y]
    x, y, z = position.tolist()
    return AxisAngle((x, y, z), _orientation(r.T), (sizes[0], sizes[1]))


def _orientation(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Axis and angle of a rotation (3, 3)."""
    x, y, z, w = quaternion(rotation)
    length = math.sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return 0.0, 0.0, 1.0, 0.0
    return x / length, y / length, z / length, 2.0 * arctangent(length, w)
