"""Steep parallax mapping (McGuire & McGuire 2005): n equal steps down, no refinement, heights from a mip chain.

The first of n depth steps, from d = 0, with d >= D(q(d)); n = round(2N (1 - w_z) + N w_z), w_z the cosine between the view
ray and the normal. Heights come from level `lod_bias` of the mip chain (trilinear): blurred as much as the steps would miss.
A GPU adds the bias to the level of the i's own footprint, which counts as 0 here, as in all other systems.

Arrays: points (3, P), found and fetches (P,), one a point, as in `sought.Sought`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Floats, Indices, Wrap
from ibr_ref.displacement.below import border, distance_to_eye, in_domain, keep, view_ray
from ibr_ref.displacement.buffers import Hits, Uniforms
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import fetch, lerp


class Level(NamedTuple):
    """One level of a mip chain, flat."""

    texels: Floats
    columns: float
    rows: float


def halved(texels: Floats, axis: int) -> Floats:
    """Half the texels along an axis, at least one: each the mean of what it covers (of an odd size 2m + 1: of three)."""
    size = texels.shape[axis]
    half = size // 2
    if half == 0:
        return texels
    t = np.moveaxis(texels, axis, 0)
    if size % 2 == 0:
        mean = (t[0::2] + t[1::2]) * 0.5
    else:
        first = np.arange(half).reshape(-1, *[1] * (t.ndim - 1))
        mean = (t[0:-1:2] * (half - first) + t[1::2] * half + t[2::2] * (first + 1)) / size
    return np.moveaxis(mean, 0, axis)


def mip_chain(heights: Floats) -> list[Floats]:
    """The height map (H, W), and every level down to one texel."""
    levels = [heights]
    while levels[-1].size > 1:
        levels.append(halved(halved(levels[-1], 0), 1))
    return levels


def levels_at(chain: list[Floats], level: float) -> tuple[Level, Level, float]:
    """The two levels that a trilinear fetch mixes, and the second one's share."""
    last = len(chain) - 1
    fine = min(int(level), last)
    pair = []
    for image in (chain[fine], chain[min(fine + 1, last)]):
        texels = np.ascontiguousarray(image).reshape(-1)
        texels.setflags(write=False)  # as the height map itself: a writable array would be another compilation
        pair.append(Level(texels, float(image.shape[1]), float(image.shape[0])))
    return pair[0], pair[1], min(level, last) - fine


@device
def _march(
    repeat: Wrap, points: Floats, i: int, constants: Uniforms, fine: Level, coarse: Level, share: float, steps: int,
    found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """The hit of a point; share: of the coarse level."""
    u, v, along_u, along_v, seen = view_ray(points, i, constants.eye)
    if not seen:
        return
    bounded = repeat is None
    cosine = constants.scale / distance_to_eye(constants, along_u, along_v)
    count = np.int64(np.floor(lerp(2.0 * steps, 1.0 * steps, cosine) + 0.5))
    margin, nearest, before = np.inf, np.inf, 0.0
    for k in range(count + 1):
        d = k / count
        p_u, p_v = u - along_u * d, v - along_v * d
        nearest = border(p_u, p_v, bounded, nearest)
        if not in_domain(p_u, p_v, bounded):
            break
        height = lerp(
            fetch(fine.texels, fine.columns, fine.rows, repeat, p_u, p_v),
            fetch(coarse.texels, coarse.columns, coarse.rows, repeat, p_u, p_v),
            share,
        )
        fetches[i] += 1
        if 0 < k < count:
            margin = min(margin, abs(d - (1.0 - height)))
        if d >= 1.0 - height:
            keep(found, i, k, p_u, p_v, d, bounded)
            found.height_before[i] = before
            break
        before = height
    found.margin[i], found.domain_margin[i] = margin, nearest


@kernel
def mcguire_search(
    repeat: Wrap, points: Floats, constants: Uniforms, fine: Level, coarse: Level, share: float, steps: int,
    found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """Hits of all points. steps: N."""
    for i in prange(len(fetches)):
        _march(repeat, points, i, constants, fine, coarse, share, steps, found, fetches)


def search(s: Sought) -> None:
    """Hits of a polygon."""
    chain = s.prepared(("mips",), lambda: mip_chain(s.heights))
    levels = levels_at(chain, s.params.lod_bias)
    mcguire_search(s.repeat, s.points, s.constants, *levels, s.params.linear_steps, *s.found)
