"""Cone step mapping (Dummer 2006): each step as far down as the empty cone over the texel reaches.

With the ray's speed m = |(v_u, v_v)| / v_h in (u, v) per depth, a cone of ratio c and the ray D - d above its apex, the ray
leaves the cone after c (D - d) / (m + c) of depth. N steps from d = 0, with height and ratio fetched bilinearly from one
texture (`cones` makes the ratios); the hit is where the last one ends, at or above the surface.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.below import keep, view_ray
from ibr_ref.displacement.cones import cone_ratios
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import fetch


@device
def cone_steps(repeat, texels, ratios, columns, rows, u, v, along_u, along_v, steps):
    """Depth after so many cone steps from the polygon."""
    speed = np.sqrt(along_u * along_u + along_v * along_v)
    d = 0.0
    for _ in range(steps):
        p_u, p_v = u - along_u * d, v - along_v * d
        above = max(0.0, 1.0 - fetch(texels, columns, rows, repeat, p_u, p_v) - d)
        ratio = fetch(ratios, columns, rows, repeat, p_u, p_v)
        d += ratio * above / (speed + ratio)
    return d


@device
def _trace(repeat, points, pixel, eye, texels, ratios, columns, rows, steps, found, fetches):
    u, v, along_u, along_v, seen = view_ray(points, pixel, eye)
    if not seen:
        return
    d = cone_steps(repeat, texels, ratios, columns, rows, u, v, along_u, along_v, steps)
    fetches[pixel] = steps
    keep(found, pixel, steps, u - along_u * d, v - along_v * d, d, repeat is None)


@kernel
def cone_search(repeat, points, eye, texels, ratios, columns, rows, steps, found, fetches):
    """Hits of all pixels. steps: N."""
    for pixel in prange(len(fetches)):
        _trace(repeat, points, pixel, eye, texels, ratios, columns, rows, steps, found, fetches)


def search(s: Sought) -> None:
    """Hits of a polygon."""
    texels, columns, rows = s.height
    ratios = cone_ratios(s, relaxed=False)
    cone_search(s.repeat, s.points, s.constants.eye, texels, ratios, columns, rows, s.params.linear_steps, *s.found)
