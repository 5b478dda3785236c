"""Relaxed cone stepping (Policarpo & Oliveira 2007): cone steps that may end inside the solid, then a binary search.

N steps as in cone step mapping, with the relaxed ratios of `cones`: they end inside, but cannot have come out again. Then M
halvings of the whole stretch from the polygon to there, as in the authors' shader: outside, d < D, goes on, inside back; the
hit is where the last one ends, within 2^-M of that stretch.

Arrays: points (3, P), eye (4,), found and fetches (P,), one a point, as in `sought.Sought`.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Indices, Lanes, Texels, Wrap
from ibr_ref.displacement.below import border, keep, sampled, view_rays
from ibr_ref.displacement.buffers import Hits
from ibr_ref.displacement.cone import cone_steps
from ibr_ref.displacement.cones import cone_ratios
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import LANES, device, kernel, prange
from ibr_ref.pipeline.fetches import fetch_wave
from ibr_ref.pipeline.waves import lanes


@device
def _halve(
    repeat: Wrap, texels: Texels, columns: float, rows: float, u: Lanes, v: Lanes, along_u: Lanes, along_v: Lanes,
    halvings: int, depth: Lanes, margin: Lanes, nearest: Lanes,
) -> None:  # fmt: skip
    """Halvings of the stretch from the polygon to each depth of a wave; the margins start at infinity."""
    bounded = repeat is None
    stretch, p_u, p_v, height = lanes(), lanes(), lanes(), lanes()
    for lane in range(LANES):
        margin[lane] = nearest[lane] = np.inf
        if halvings > 0:
            depth[lane] = 0.5 * depth[lane]
        stretch[lane] = depth[lane]
    for _ in range(halvings):
        for lane in range(LANES):
            p_u[lane], p_v[lane] = u[lane] - along_u[lane] * depth[lane], v[lane] - along_v[lane] * depth[lane]
        fetch_wave(texels, columns, rows, repeat, p_u, p_v, height)
        for lane in range(LANES):
            stretch[lane] *= 0.5
            inside, distance, _ = sampled(height[lane], bounded, p_u[lane], p_v[lane], depth[lane])
            margin[lane] = min(margin[lane], distance)
            nearest[lane] = border(p_u[lane], p_v[lane], bounded, nearest[lane])
            depth[lane] += -stretch[lane] if inside else stretch[lane]


@device
def _trace(
    repeat: Wrap, points: Floats, first: int, eye: Floats, texels: Texels, ratios: Texels, columns: float, rows: float,
    steps: int, halvings: int, found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """Hits of a wave of points."""
    u, v, along_u, along_v, depth, margin, nearest = lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    count, seen = view_rays(points, first, eye, u, v, along_u, along_v)
    if not seen:
        return
    cone_steps(repeat, texels, ratios, columns, rows, u, v, along_u, along_v, steps, depth)
    _halve(repeat, texels, columns, rows, u, v, along_u, along_v, halvings, depth, margin, nearest)
    for lane in range(count):
        if not np.isnan(u[lane]):
            i, d = first + lane, depth[lane]
            fetches[i] = steps + halvings
            keep(found, i, steps, u[lane] - along_u[lane] * d, v[lane] - along_v[lane] * d, d, repeat is None)
            found.margin[i], found.domain_margin[i] = margin[lane], nearest[lane]


@kernel
def relaxed_cone_search(
    repeat: Wrap, points: Floats, eye: Floats, texels: Texels, ratios: Texels, columns: float, rows: float, steps: int,
    halvings: int, found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """Hits of all points. steps, halvings: N and M."""
    for wave in prange((len(fetches) + LANES - 1) // LANES):
        _trace(repeat, points, wave * LANES, eye, texels, ratios, columns, rows, steps, halvings, found, fetches)


def search(s: Sought) -> None:
    """Hits of a polygon."""
    texels, columns, rows = s.height
    ratios = cone_ratios(s, relaxed=True)
    relaxed_cone_search(
        s.repeat, s.points, s.constants.eye, texels, ratios, columns, rows, s.params.linear_steps,
        s.params.binary_steps, *s.found,
    )  # fmt: skip
