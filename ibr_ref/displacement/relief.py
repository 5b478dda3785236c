"""Relief mapping (Policarpo et al. 2005), what the paper compares with: the polygon is the *top* of the volume.

Depth d = -h below the polygon, D = 1 - H: N linear steps down from d = 0, then M binary ones, on the base face alone.
The comparison is d >= D, as in Policarpo's own shader. Everything that is not raised to H = 1 sinks below the polygon.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.below import border, sample
from ibr_ref.jit import device


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
        margin, nearest, before, height = np.inf, np.inf, 0.0, 0.0
        step, below = 0, False
        while not below and step <= settings.linear_steps:
            before = height
            d = step * stride / end
            p_u, p_v = u - along_u * d, v - along_v * d
            below, distance, height = sample(repeat, texels, columns, rows, bounded, p_u, p_v, d)
            margin, nearest = min(margin, distance), border(p_u, p_v, bounded, nearest)
            step += 0 if below else 1
        inside, outside = step * stride, max(0, step - 1) * stride
        while below and inside - outside > 1:
            middle = (inside + outside) // 2
            d = middle / end
            p_u, p_v = u - along_u * d, v - along_v * d
            deeper, distance, _ = sample(repeat, texels, columns, rows, bounded, p_u, p_v, d)
            margin, nearest = min(margin, distance), border(p_u, p_v, bounded, nearest)
            inside, outside = (middle, outside) if deeper else (inside, middle)
        hits.margin[i], hits.domain_margin[i] = margin, nearest
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
