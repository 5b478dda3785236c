"""Relief mapping (Policarpo et al. 2005), what the paper compares with: the polygon is the *top* of the volume.

Depth d = -h below the polygon, D = 1 - H: N linear steps down from d = 0, then M binary ones, on the base face alone.
The comparison is d >= D, as in Policarpo's own shader. Everything that is not raised to H = 1 sinks below the polygon.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.jit import device
from ibr_ref.pipeline.sampling import fetch


@device
def _in_domain(u, v, bounded):
    return not bounded or (0.0 <= u <= 1.0 and 0.0 <= v <= 1.0)


@device
def _sample(repeat, texels, columns, rows, bounded, u, v, d):
    """Whether the sample is at or below the surface; its margin |d - D| (infinite at d = 0 and d = 1); H, 0 outside."""
    if not _in_domain(u, v, bounded):
        return False, np.inf, 0.0
    height = fetch(texels, columns, rows, repeat, u, v)
    depth = 1.0 - height
    return d >= depth, (abs(d - depth) if 0.0 < d < 1.0 else np.inf), height


@device
def _border(u, v, bounded, nearest):
    if not bounded:
        return nearest
    return min(nearest, abs(min(min(u, 1.0 - u), min(v, 1.0 - v))))


@device
def relief_search(repeat, fragments, count, eye, texels, columns, rows, settings, hits):
    """Hits (u, v, -d) of all fragments; a ray that leaves the map before it meets the surface is discarded."""
    stride = 1 << settings.binary_steps
    end = settings.linear_steps * stride
    bounded = settings.bounded
    for i in range(count):
        u, v = fragments.patch[0, i], fragments.patch[1, i]
        to_h = eye[2] - eye[3] * fragments.patch[2, i]
        if not to_h > 0.0:
            continue
        along_u = (eye[0] - eye[3] * u) / to_h
        along_v = (eye[1] - eye[3] * v) / to_h
        margin, border, before, height = np.inf, np.inf, 0.0, 0.0
        step, below = 0, False
        while not below and step <= settings.linear_steps:
            before = height
            d = step * stride / end
            p_u, p_v = u - along_u * d, v - along_v * d
            below, distance, height = _sample(repeat, texels, columns, rows, bounded, p_u, p_v, d)
            margin, border = min(margin, distance), _border(p_u, p_v, bounded, border)
            step += 0 if below else 1
        inside, outside = step * stride, max(0, step - 1) * stride
        while below and inside - outside > 1:
            middle = (inside + outside) // 2
            d = middle / end
            p_u, p_v = u - along_u * d, v - along_v * d
            deeper, distance, _ = _sample(repeat, texels, columns, rows, bounded, p_u, p_v, d)
            margin, border = min(margin, distance), _border(p_u, p_v, bounded, border)
            inside, outside = (middle, outside) if deeper else (inside, middle)
        hits.margin[i], hits.domain_margin[i] = margin, border
        if below:
            d = inside / end
            hits.linear_index[i], hits.hit_index[i] = step, inside
            hits.u[i], hits.v[i], hits.h[i] = u - along_u * d, v - along_v * d, -d
            hits.height_before[i] = before


@device
def texture_search(fragments, count, settings, hits):
    """Texture mapping: every fragment hits the polygon where it is."""
    for i in range(count):
        hits.hit_index[i] = settings.linear_steps << settings.binary_steps
        hits.u[i], hits.v[i], hits.h[i] = fragments.patch[0, i], fragments.patch[1, i], 0.0
