"""A trefoil knot: much hides much of it, from everywhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.models.loft import looped, turn
from ibr_ref.models.sweep import cross, ellipses, unit
from ibr_ref.scene import Mesh, checks

_TWICE, _THRICE = 2, 3
"""Times that the curve runs around the axis, and around the tube of the torus it lies on."""
_RADIUS, _TUBE, _CORD = 0.62, 0.27, 0.14
"""Of the torus, and of the cord."""


def knot(segments: int = 240, sides: int = 20) -> Mesh:
    """A cord along the (2, 3) torus knot, about the z axis, 2 across and 0.8 high; 2 segments sides triangles.

    Colours run through the hues along it. ValueError for segments outside 12 to 4096 or sides outside 3 to 4096.
    """
    segments = checks.whole("segments", segments, low=12, high=4096)
    sides = checks.whole("sides", sides, low=3, high=4096)
    step = np.arange(segments)
    x, y = turn(segments)[_TWICE * step % segments].T
    out, up = turn(segments)[_THRICE * step % segments].T
    outward = np.stack([out * x, out * y, up], axis=1)
    around = np.stack([-y, x, np.zeros(segments)], axis=1)
    along = np.stack([-up * x, -up * y, out], axis=1)
    center = _RADIUS * np.stack([x, y, np.zeros(segments)], axis=1) + _TUBE * outward
    # The curve lies on the torus, whose normal therefore is normal to it: a frame that closes without a twist.
    tangent = (_TWICE * (_RADIUS + _TUBE * out))[:, None] * around + (_THRICE * _TUBE) * along
    sideways = cross(unit(tangent), outward)
    return looped(ellipses(center, _CORD * outward, _CORD * sideways, sides), _hues(segments))


def _hues(count: int) -> NDArray[np.float64]:
    """(count, 3) around a circle about the grey axis."""
    cosine, sine = turn(count).T
    half_root_three = 0.8660254037844386
    red, green, blue = cosine, -0.5 * cosine + half_root_three * sine, -0.5 * cosine - half_root_three * sine
    return 0.55 + 0.35 * np.stack([red, green, blue], axis=1)
