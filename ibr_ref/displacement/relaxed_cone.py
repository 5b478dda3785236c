"""Relaxed cone stepping (Policarpo & Oliveira 2007): cone steps that may end inside the solid, then a binary search.

N steps as in cone step mapping, with the relaxed ratios of `cones`: they end inside, but cannot have come out again. Then M
halvings of the whole stretch from the polygon to there, as in the authors' shader: outside, d < D, goes on, inside back; the
hit is where the last one ends, within 2^-M of that stretch.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.below import border, keep, sample, view_ray
from ibr_ref.displacement.cone import cone_steps
from ibr_ref.displacement.cones import cone_ratios
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import device, kernel, prange


@device
def _trace(repeat, points, pixel, eye, texels, ratios, columns, rows, steps, halvings, found, fetches):
    u, v, along_u, along_v, seen = view_ray(points, pixel, eye)
    if not seen:
        return
    reached = cone_steps(repeat, texels, ratios, columns, rows, u, v, along_u, along_v, steps)
    bounded, margin, nearest = repeat is None, np.inf, np.inf
    d = stretch = 0.5 * reached
    for _ in range(halvings):
        stretch *= 0.5
        p_u, p_v = u - along_u * d, v - along_v * d
        inside, distance, _ = sample(repeat, texels, columns, rows, bounded, p_u, p_v, d)
        margin, nearest = min(margin, distance), border(p_u, p_v, bounded, nearest)
        d += -stretch if inside else stretch
    if halvings == 0:
        d = reached
    fetches[pixel] = steps + halvings
    keep(found, pixel, steps, u - along_u * d, v - along_v * d, d, bounded)
    found.margin[pixel], found.domain_margin[pixel] = margin, nearest


@kernel
def relaxed_cone_search(
    repeat, points, eye, texels, ratios, columns, rows, steps, halvings, found, fetches
):  # fmt: skip
    """Hits of all pixels. steps, halvings: N and M."""
    for pixel in prange(len(fetches)):
        _trace(repeat, points, pixel, eye, texels, ratios, columns, rows, steps, halvings, found, fetches)


def search(s: Sought) -> None:
    """Hits of a polygon."""
    texels, columns, rows = s.height
    ratios = cone_ratios(s, relaxed=True)
    relaxed_cone_search(
        s.repeat, s.points, s.constants.eye, texels, ratios, columns, rows, s.params.linear_steps,
        s.params.binary_steps, *s.found,
    )  # fmt: skip
