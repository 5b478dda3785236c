"""The stretch of each view ray that is searched, in patch space (section 3.1; section 3.2.2 for the side faces).

The eye is (4,), homogeneous, in patch space.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.displacement.buffers import Fragments, Rays, padded
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.waves import lanes, load, store


@device
def _paper_ray(
    u: float, v: float, h: float, eye_u: float, eye_v: float, eye_h: float, eye_w: float
) -> tuple[float, float, float, float, float, float]:
    """From B on the top of the volume (h = 1) to A on the plane of the polygon (h = 0), for the face's point C."""
    to_u = eye_u - eye_w * u
    to_v = eye_v - eye_w * v
    to_h = eye_h - eye_w * h
    down = to_h > 0.0
    below = h / to_h if down else 0.0
    above = (1.0 - h) / to_h if down else 0.0
    a_u = u - to_u * below
    a_v = v - to_v * below
    b_u = u + to_u * above
    b_v = v + to_v * above
    return b_u, b_v, (1.0 if down else 2.0), a_u - b_u, a_v - b_v, (-1.0 if down else 0.0)


@device
def _exit(x: float, towards: float, best: float, axis: int, best_axis: int) -> tuple[float, int]:
    """Nearer of `best` and where a ray from x leaves [0, 1] on this axis; a tie stays with the earlier axis."""
    if towards > 0.0:
        t = (1.0 - x) / towards
    elif towards < 0.0:
        t = (0.0 - x) / towards
    else:
        return best, best_axis
    return (t, axis) if t < best else (best, best_axis)


@device
def _volume_ray(
    u: float, v: float, h: float, eye_u: float, eye_v: float, eye_h: float, eye_w: float
) -> tuple[float, float, float, float, float, float]:
    """From where the view ray enters the unit cube, or the eye if that is inside, to the face's point C."""
    inside = eye_w == 1.0 and 0.0 <= eye_u <= 1.0 and 0.0 <= eye_v <= 1.0 and 0.0 <= eye_h <= 1.0
    if inside:
        return eye_u, eye_v, eye_h, u - eye_u, v - eye_v, h - eye_h
    to_u = eye_u - eye_w * u
    to_v = eye_v - eye_w * v
    to_h = eye_h - eye_w * h
    t, axis = _exit(u, to_u, np.inf, 0, -1)
    t, axis = _exit(v, to_v, t, 1, axis)
    t, axis = _exit(h, to_h, t, 2, axis)
    if axis < 0:  # the eye rounds to C itself
        return u, v, h, 0.0, 0.0, 0.0
    b_u = u + to_u * t
    b_v = v + to_v * t
    b_h = h + to_h * t
    if axis == 0:
        b_u = 1.0 if to_u > 0.0 else 0.0
    elif axis == 1:
        b_v = 1.0 if to_v > 0.0 else 0.0
    else:
        b_h = 1.0 if to_h > 0.0 else 0.0
    return b_u, b_v, b_h, u - b_u, v - b_v, h - b_h


@device
def paper_rays(fragments: Fragments, count: int, eye: Floats, rays: Rays) -> None:
    """Rays of interval="paper"."""
    eye_u, eye_v, eye_h, eye_w = eye[0], eye[1], eye[2], eye[3]
    u, v, h, du, dv, dh = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        load(fragments.patch[0], first, u)
        load(fragments.patch[1], first, v)
        load(fragments.patch[2], first, h)
        for lane in range(LANES):
            u[lane], v[lane], h[lane], du[lane], dv[lane], dh[lane] = _paper_ray(
                u[lane], v[lane], h[lane], eye_u, eye_v, eye_h, eye_w
            )
        store(u, rays.u, first)
        store(v, rays.v, first)
        store(h, rays.h, first)
        store(du, rays.du, first)
        store(dv, rays.dv, first)
        store(dh, rays.dh, first)


@device
def volume_rays(fragments: Fragments, count: int, eye: Floats, rays: Rays) -> None:
    """Rays of interval="volume"."""
    for i in range(count):
        rays.u[i], rays.v[i], rays.h[i], rays.du[i], rays.dv[i], rays.dh[i] = _volume_ray(
            fragments.patch[0, i], fragments.patch[1, i], fragments.patch[2, i], eye[0], eye[1], eye[2], eye[3]
        )
    for i in range(count, padded(count)):  # the last wave's rest: copies, which change no bound
        rays.u[i], rays.v[i], rays.h[i] = rays.u[count - 1], rays.v[count - 1], rays.h[count - 1]
        rays.du[i], rays.dv[i], rays.dh[i] = rays.du[count - 1], rays.dv[count - 1], rays.dh[count - 1]
