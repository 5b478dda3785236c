"""Near and far planes around what a camera is to show."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.transform import transformed
from ibr_ref.scene import checks

_LEAST = 1e-6
"""Of the far plane's distance: where the nearest near plane lies, for an eye among the points."""
_ROOM = 0.01
"""Between what is seen and the planes, as a share of the distance: rounding must not clip it."""
_BESIDE = 0.5
"""Share of the nearest depth that can be in the picture: splats whose centres are beside it may reach in."""


def checked_points(points: ArrayLike) -> Floats:
    """(N, 3) finite points, at least one."""
    found = checks.numbers("points", points, "points (N, 3), N >= 1")
    if found.ndim != 2 or found.shape[1] != 3 or not len(found):
        raise checks.reject("points.shape", found.shape, "(N, 3), N >= 1")
    if not np.isfinite(found).all():
        raise checks.reject("points", "a point that is not finite", "finite numbers")
    return found


def fitted_planes(
    points: Floats, view_from_world: Floats, widest: float | None, near: float | None, far: float | None
) -> tuple[float, float]:
    """Distances of planes that hold the convex hull of points (N, 3) in world space, or what of it is before the eye.

    widest: the tangent of the angle between the view axis and the farthest corner of the picture; None: orthographic.
    near, far: kept where they are given; the other one lies behind, or before, even if nothing is between them then.
    """
    local = transformed(view_from_world, points)[:, :3]
    depths = 0.0 - local[:, 2]
    if widest is None:
        fitted = _parallel(float(depths.min()), float(depths.max()))
        apart = 1.0
    else:
        fitted = _before_the_eye(local, float(depths.min()), float(depths.max()), widest)
        apart = float(near if near is not None else far if far is not None else 0.0) / 2.0
    if near is None:
        near = fitted[0] if far is None or fitted[0] < far else far - apart
    if far is None:
        far = fitted[1] if near < fitted[1] else near + apart
    return near, far


def _parallel(nearest: float, farthest: float) -> tuple[float, float]:
    room = _ROOM * (farthest - nearest or max(abs(farthest), 1.0))
    return nearest - room, farthest + room


def _before_the_eye(local: Floats, nearest: float, farthest: float, widest: float) -> tuple[float, float]:
    """For points in view space. What is in the picture lies no nearer than the box around them times a cosine."""
    low, high = local.min(axis=0), local.max(axis=0)
    if farthest <= 0.0:  # all behind the eye: planes about as far away, which hold nothing
        reach = float(np.abs(local).max()) or 1.0
        return 1e-3 * reach, reach
    far = (1.0 + _ROOM) * farthest
    x, y, z = np.maximum(0.0, np.maximum(low, -high)).tolist()
    seen = float(np.sqrt(x * x + y * y + z * z) / np.sqrt(1.0 + widest * widest))
    return max((1.0 - _ROOM) * nearest, _BESIDE * min(seen, far), _LEAST * far), far
