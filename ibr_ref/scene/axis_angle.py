"""A camera as MPEG-4 AFX has it (ISO/IEC 14496-16): position, axis and angle, fields of view."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Floats
from ibr_ref.scene import checks
from ibr_ref.scene.projection import depth_row
from ibr_ref.scene.trigonometry import sine_cosine
from ibr_ref.scene.vectors import dot, unit


class AxisAngle(NamedTuple):
    """What `Camera.axis_angle` was given. Files keep these numbers, not the matrices made of them."""

    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    field_of_view: tuple[float, float]


def axis_angle(position: ArrayLike, orientation: ArrayLike, field_of_view: ArrayLike) -> AxisAngle:
    """The fields as numbers, finite ones."""
    x, y, z = checks.vector("position", position).tolist()
    axis_x, axis_y, axis_z, angle = checks.vector("orientation", orientation, 4).tolist()
    horizontal, vertical = checks.vector("field_of_view", field_of_view, 2).tolist()
    return AxisAngle((x, y, z), (axis_x, axis_y, axis_z, angle), (horizontal, vertical))


def view_from_world(fields: AxisAngle) -> NDArray[np.float64]:
    """(4, 4) for a camera at `position`, turned by `orientation` from looking down -z."""
    view = np.eye(4)
    # The rotation is world from view; it is orthogonal to the last bit or two, so its transpose is its inverse.
    view[:3, :3] = _rotation(np.array(fields.orientation)).T
    view[:3, 3] = [-dot(row, np.array(fields.position)) for row in view[:3, :3]]
    return view


def clip_from_view(fields: AxisAngle, near: float, far: float, *, perspective: bool) -> NDArray[np.float64]:
    """(4, 4) by the fields of view; they are the picture's shape as well, whatever its size in pixels."""
    clip = np.eye(4)
    for axis, size in enumerate(fields.field_of_view):
        above, below = sine_cosine(size / 2.0) if perspective else (size / 2.0, 1.0)
        scale = below / above if above > 0.0 and (size < math.pi or not perspective) else math.inf
        if not 0.0 < scale < math.inf:
            allowed = "angles in radians above 0 and below pi" if perspective else "a width and a height > 0"
            raise checks.reject("field_of_view", list(fields.field_of_view), allowed)
        clip[axis, axis] = scale
    clip[2, 2:] = depth_row(near, far, perspective)
    if perspective:
        clip[3, 2:] = -1.0, 0.0
    return clip


def _rotation(orientation: Floats) -> Floats:
    """(3, 3) by Rodrigues' formula, from (x, y, z, angle)."""
    longest = float(np.abs(orientation[:3]).max())
    if longest == 0.0 or not abs(orientation[3]) <= 1e6:
        raise checks.reject("orientation", orientation.tolist(), "an axis that is not zero, an angle from -1e6 to 1e6")
    x, y, z = unit(orientation[:3]).tolist()
    s, c = sine_cosine(float(orientation[3]))
    t = 1.0 - c
    return np.array(
        [
            (t * x * x + c, t * x * y - s * z, t * x * z + s * y),
            (t * x * y + s * z, t * y * y + c, t * y * z - s * x),
            (t * x * z - s * y, t * y * z + s * x, t * z * z + c),
        ]
    )
