"""What the compared systems share: the view ray below the polygon, and what a sample says of the map there.

Their polygon is the *top* of the volume. With D = 1 - H and the fragment's point C, the view ray at depth d is
q(d) = C_uv - d (v_uv / v_h), v = e - C. Samples beside a map that does not repeat are empty: a ray that leaves the map
before it meets the surface is discarded (the gaps of the paper's figure 3).
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Lanes, Whole
from ibr_ref.displacement.buffers import Hits, Uniforms
from ibr_ref.jit import LANES, device


@device
def in_domain(u: float, v: float, bounded: bool) -> bool:
    """Whether there is a map at (u, v)."""
    return not bounded or (0.0 <= u <= 1.0 and 0.0 <= v <= 1.0)


@device
def sampled(height: float, bounded: bool, u: float, v: float, d: float) -> tuple[bool, float, float]:
    """Of a height that was fetched at (u, v), wherever that is: whether the sample is at or below the surface.

    And its margin |d - D|, infinite at d = 0 and d = 1; H, 0 outside.
    """
    if not in_domain(u, v, bounded):
        return False, np.inf, 0.0
    depth = 1.0 - height
    return d >= depth, (abs(d - depth) if 0.0 < d < 1.0 else np.inf), height


@device
def border(u: float, v: float, bounded: bool, nearest: float) -> float:
    """The smaller of `nearest` and the distance in (u, v) from the border of a map that ends there."""
    if not bounded:
        return nearest
    return min(nearest, abs(min(min(u, 1.0 - u), min(v, 1.0 - v))))


@device
def view_ray(points: Floats, i: int, eye: Floats) -> tuple[float, float, float, float, bool]:
    """(u, v) on the polygon, v_u / v_h and v_v / v_h, and whether there is a ray: a fragment, and an eye above."""
    u, v = points[0, i], points[1, i]
    to_h = eye[2] - eye[3] * points[2, i]
    if not to_h > 0.0:
        return u, v, 0.0, 0.0, False
    return u, v, (eye[0] - eye[3] * u) / to_h, (eye[1] - eye[3] * v) / to_h, True


@device
def view_rays(
    points: Floats, first: int, eye: Floats, u: Lanes, v: Lanes, along_u: Lanes, along_v: Lanes
) -> tuple[int, bool]:
    """The same for a wave of points from `first` on: how many of them there are, and whether there is any ray.

    NaN where there is none, as the wave's rest has.
    """
    last = points.shape[1]
    count, seen = min(LANES, last - first), False
    for lane in range(LANES):
        u[lane] = v[lane] = along_u[lane] = along_v[lane] = np.nan
    for lane in range(count):
        at_u, at_v, to_u, to_v, here = view_ray(points, first + lane, eye)
        if here:
            u[lane], v[lane], along_u[lane], along_v[lane] = at_u, at_v, to_u, to_v
            seen = True
    return count, seen


@device
def distance_to_eye(constants: Uniforms, along_u: float, along_v: float) -> float:
    """World length of the view ray from depth 1 up to the polygon: |(v_u/v_h) U + (v_v/v_h) V + s n|."""
    a = constants.axes
    x = along_u * a[0, 0] + along_v * a[1, 0] + a[2, 0]
    y = along_u * a[0, 1] + along_v * a[1, 1] + a[2, 1]
    z = along_u * a[0, 2] + along_v * a[1, 2] + a[2, 2]
    return np.sqrt(x * x + y * y + z * z)


@device
def keep(found: Hits, i: int, step: Whole, u: float, v: float, d: float, bounded: bool) -> None:
    """Write a hit at depth d, after so many steps; one beside the map stays discarded."""
    if in_domain(u, v, bounded):
        found.linear_index[i], found.hit_index[i] = step, step
        found.u[i], found.v[i], found.h[i] = u, v, -d
