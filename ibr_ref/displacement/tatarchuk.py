"""Parallax occlusion mapping (Tatarchuk 2005): as many steps as the angle asks for, then one secant.

n = trunc(n_max (1 - w_z) + n_min w_z), as in its author's shader; the samples k = 1 ... n go down from the polygon and stop
at the first with H > 1 - k/n. The hit is where the ray crosses the straight line between the last two samples, whose heights
above depth 1 are (1 - k/n, H_k) and (1 - (k-1)/n, H_{k-1}); H_0 counts as 1, as in the shader. Without a stop the hit is at
depth 1. (The shader's fade to normal mapping in the distance is left out.)

Arrays: points (3, P), found and fetches (P,), one a point, as in `sought.Sought`.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Indices, Texels, Whole, Wrap
from ibr_ref.displacement.below import border, distance_to_eye, in_domain, keep, view_ray
from ibr_ref.displacement.buffers import Hits, Uniforms
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import fetch


@device
def crossing(ray: float, height: float, ray_before: float, height_before: float) -> float:
    """Height at which the ray crosses the line between two samples; 0 where they run in parallel, as in the shader."""
    delta, delta_before = ray - height, ray_before - height_before
    denominator = delta_before - delta
    return 0.0 if denominator == 0.0 else (ray * delta_before - ray_before * delta) / denominator


@device
def _march(
    repeat: Wrap, points: Floats, i: int, constants: Uniforms, texels: Texels, columns: float, rows: float,
    least: int, most: int, found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """The hit of a point."""
    u, v, along_u, along_v, seen = view_ray(points, i, constants.eye)
    if not seen:
        return
    bounded = repeat is None
    cosine = constants.scale / distance_to_eye(constants, along_u, along_v)
    count = np.int64(most + (least - most) * cosine)  # HLSL's lerp: exact where both are the same
    step: Whole
    margin, nearest, before, step, depth = np.inf, np.inf, 1.0, count, 1.0
    for k in range(1, count + 1):
        ray = 1.0 - k / count
        p_u, p_v = u - along_u * (1.0 - ray), v - along_v * (1.0 - ray)
        nearest = border(p_u, p_v, bounded, nearest)
        if not in_domain(p_u, p_v, bounded):
            break
        height = fetch(texels, columns, rows, repeat, p_u, p_v)
        fetches[i] += 1
        if k < count:
            margin = min(margin, abs(ray - height))
        if height > ray:
            step, depth = k, 1.0 - crossing(ray, height, 1.0 - (k - 1) / count, before)
            found.height_before[i] = before
            break
        before = height
    keep(found, i, step, u - along_u * depth, v - along_v * depth, depth, bounded)
    found.margin[i], found.domain_margin[i] = margin, nearest


@kernel
def tatarchuk_search(
    repeat: Wrap, points: Floats, constants: Uniforms, texels: Texels, columns: float, rows: float, least: int,
    most: int, found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """Hits of all points. least, most: n_min and n_max."""
    for i in prange(len(fetches)):
        _march(repeat, points, i, constants, texels, columns, rows, least, most, found, fetches)


def search(s: Sought) -> None:
    """Hits of a polygon."""
    tatarchuk_search(s.repeat, s.points, s.constants, *s.height, s.params.min_steps, s.params.max_steps, *s.found)
