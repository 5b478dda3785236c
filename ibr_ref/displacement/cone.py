"""Cone step mapping (Dummer 2006): each step as far down as the empty cone over the texel reaches.

With the ray's speed m = |(v_u, v_v)| / v_h in (u, v) per depth, a cone of ratio c and the ray D - d above its apex, the ray
leaves the cone after c (D - d) / (m + c) of depth. N steps from d = 0, with height and ratio fetched bilinearly from one
texture (`cones` makes the ratios); the hit is where the last one ends, at or above the surface.

Arrays: points (3, P), eye (4,), found and fetches (P,), one a point, as in `sought.Sought`.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Indices, Lanes, Texels, Wrap
from ibr_ref.displacement.below import keep, view_rays
from ibr_ref.displacement.buffers import Hits
from ibr_ref.displacement.cones import cone_ratios
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import LANES, device, kernel, prange
from ibr_ref.pipeline.fetches import fetch_wave
from ibr_ref.pipeline.waves import lanes


@device
def cone_steps(
    repeat: Wrap, texels: Texels, ratios: Texels, columns: float, rows: float, u: Lanes, v: Lanes, along_u: Lanes,
    along_v: Lanes, steps: int, depth: Lanes,
) -> None:  # fmt: skip
    """Depths of a wave after so many cone steps from the polygon. ratios: of the texels."""
    speed, p_u, p_v, height, ratio = lanes(), lanes(), lanes(), lanes(), lanes()
    for lane in range(LANES):
        speed[lane] = np.sqrt(along_u[lane] * along_u[lane] + along_v[lane] * along_v[lane])
        depth[lane] = 0.0
    for _ in range(steps):
        for lane in range(LANES):
            p_u[lane], p_v[lane] = u[lane] - along_u[lane] * depth[lane], v[lane] - along_v[lane] * depth[lane]
        fetch_wave(texels, columns, rows, repeat, p_u, p_v, height)
        fetch_wave(ratios, columns, rows, repeat, p_u, p_v, ratio)
        for lane in range(LANES):
            above = 1.0 - height[lane] - depth[lane]
            above = above if above > 0.0 else 0.0
            depth[lane] += ratio[lane] * above / (speed[lane] + ratio[lane])


@device
def _trace(
    repeat: Wrap, points: Floats, first: int, eye: Floats, texels: Texels, ratios: Texels, columns: float, rows: float,
    steps: int, found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """Hits of a wave of points."""
    u, v, along_u, along_v, depth = lanes(), lanes(), lanes(), lanes(), lanes()
    count, seen = view_rays(points, first, eye, u, v, along_u, along_v)
    if not seen:
        return
    cone_steps(repeat, texels, ratios, columns, rows, u, v, along_u, along_v, steps, depth)
    for lane in range(count):
        if not np.isnan(u[lane]):
            i, d = first + lane, depth[lane]
            fetches[i] = steps
            keep(found, i, steps, u[lane] - along_u[lane] * d, v[lane] - along_v[lane] * d, d, repeat is None)


@kernel
def cone_search(
    repeat: Wrap, points: Floats, eye: Floats, texels: Texels, ratios: Texels, columns: float, rows: float, steps: int,
    found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """Hits of all points. steps: N."""
    for wave in prange((len(fetches) + LANES - 1) // LANES):
        _trace(repeat, points, wave * LANES, eye, texels, ratios, columns, rows, steps, found, fetches)


def search(s: Sought) -> None:
    """Hits of a polygon."""
    texels, columns, rows = s.height
    ratios = cone_ratios(s, relaxed=False)
    cone_search(s.repeat, s.points, s.constants.eye, texels, ratios, columns, rows, s.params.linear_steps, *s.found)
