"""Where a camera stands that is given by its eye and what it looks at."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Floats
from ibr_ref.scene import checks
from ibr_ref.scene.vectors import cross, dot, length

_FARTHEST = 1e50


def view_from_world(eye: ArrayLike, target: ArrayLike, up: ArrayLike) -> NDArray[np.float64]:
    """(4, 4) for a camera at `eye` that looks at `target`."""
    eye, target, up = _moderate("eye", eye), _moderate("target", target), _moderate("up", up)
    forward = target - eye
    if dot(forward, forward) == 0.0:
        raise checks.reject("target", target.tolist(), "a point other than the eye")
    right = cross(forward, up)
    if dot(right, right) <= 1e-24 * dot(forward, forward) * dot(up, up):
        raise checks.reject("up", up.tolist(), "a direction that is not parallel to the line of sight")
    forward, right = forward / length(forward), right / length(right)
    top = cross(right, forward)
    view = np.eye(4)
    for row, axis in enumerate((right, top, -forward)):
        view[row, :3] = axis
        view[row, 3] = -dot(axis, eye)
    return view


def _moderate(field: str, value: ArrayLike) -> Floats:
    """A vector whose products of four components do not overflow."""
    result = checks.vector(field, value)
    if not abs(result).max() <= _FARTHEST:
        raise checks.reject(field, result.tolist(), f"numbers between {-_FARTHEST:g} and {_FARTHEST:g}")
    return result
