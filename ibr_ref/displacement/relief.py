"""Relief mapping (Policarpo et al. 2005), what the paper compares with: the polygon is the *top* of the volume.

Depth d = -h below the polygon, D = 1 - H: N linear steps down from d = 0, then M binary ones, on the base face alone.
The comparison is d >= D, as in Policarpo's own shader. Everything that is not raised to H = 1 sinks below the polygon.

The eye is (4,), homogeneous, in patch space.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Lanes, Texels, Wrap
from ibr_ref.displacement.below import view_rays
from ibr_ref.displacement.buffers import Fragments, Hits, Settings
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.fetches import fetch_wave
from ibr_ref.pipeline.waves import lanes, smallest, store


@device
def _compared(
    sample: Lanes, p_u: Lanes, p_v: Lanes, depth: Lanes, bounded: bool, active: Lanes, below: Lanes, margin: Lanes,
    nearest: Lanes,
) -> None:  # fmt: skip
    """Of a wave's samples at their depths: whether they are at or below the surface, 1 or 0, and their margins.

    The same as `below.sampled` and `below.border` lane by lane, without branches.
    """
    low, high = (0.0, 1.0) if bounded else (-np.inf, np.inf)
    for lane in range(LANES):
        inside = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
        d, surface = depth[lane], 1.0 - sample[lane]
        below[lane] = 1.0 if inside & (d >= surface) & (active[lane] > 0.0) else 0.0
        distance = abs(d - surface)
        closer = inside & (d > 0.0) & (d < 1.0) & (distance < margin[lane]) & (active[lane] > 0.0)
        margin[lane] = distance if closer else margin[lane]
        sample[lane] = sample[lane] if inside else 0.0
    for lane in range(LANES if bounded else 0):
        at_u = p_u[lane] if p_u[lane] < 1.0 - p_u[lane] else 1.0 - p_u[lane]
        at_v = p_v[lane] if p_v[lane] < 1.0 - p_v[lane] else 1.0 - p_v[lane]
        edge = abs(at_u if at_u < at_v else at_v)
        nearest[lane] = edge if (edge < nearest[lane]) & (active[lane] > 0.0) else nearest[lane]


@device
def _linear_search(
    repeat: Wrap, texels: Texels, columns: float, rows: float, u: Lanes, v: Lanes, along_u: Lanes, along_v: Lanes,
    settings: Settings, stop: Lanes, before: Lanes, margin: Lanes, nearest: Lanes,
) -> None:  # fmt: skip
    """Step at which each lane that searches (stop < 0) is at or below the surface, and the height one step before."""
    stride = np.float64(1 << settings.binary_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    p_u, p_v, depth, sample = lanes(), lanes(), lanes(), lanes()
    height, active, below = lanes(), lanes(), lanes()
    for lane in range(LANES):
        height[lane] = 0.0
    for step in range(settings.linear_steps + 1):
        d, here = step * stride / total, np.float64(step)
        for lane in range(LANES):
            depth[lane], active[lane] = d, (1.0 if stop[lane] < 0.0 else 0.0)
            p_u[lane], p_v[lane] = u[lane] - along_u[lane] * d, v[lane] - along_v[lane] * d
        fetch_wave(texels, columns, rows, repeat, p_u, p_v, sample)
        _compared(sample, p_u, p_v, depth, settings.bounded, active, below, margin, nearest)
        for lane in range(LANES):
            searches = active[lane] > 0.0
            before[lane] = height[lane] if searches else before[lane]
            height[lane] = sample[lane] if searches else height[lane]
            stop[lane] = here if below[lane] > 0.0 else stop[lane]
        if smallest(stop) >= 0.0:
            break


@device
def _binary_search(
    repeat: Wrap, texels: Texels, columns: float, rows: float, u: Lanes, v: Lanes, along_u: Lanes, along_v: Lanes,
    settings: Settings, stop: Lanes, inside: Lanes, margin: Lanes, nearest: Lanes,
) -> None:  # fmt: skip
    """Lattice index of each lane that has stopped below the polygon."""
    stride, steps = np.float64(1 << settings.binary_steps), np.float64(settings.linear_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    p_u, p_v, depth, sample = lanes(), lanes(), lanes(), lanes()
    outside, active, below = lanes(), lanes(), lanes()
    for lane in range(LANES):
        inside[lane] = stop[lane] * stride
        outside[lane] = inside[lane] - stride
        active[lane] = 1.0 if (stop[lane] > 0.0) & (stop[lane] <= steps) else 0.0
    for _ in range(settings.binary_steps):
        for lane in range(LANES):
            d = (inside[lane] + outside[lane]) * 0.5 / total
            depth[lane], p_u[lane], p_v[lane] = d, u[lane] - along_u[lane] * d, v[lane] - along_v[lane] * d
        fetch_wave(texels, columns, rows, repeat, p_u, p_v, sample)
        _compared(sample, p_u, p_v, depth, settings.bounded, active, below, margin, nearest)
        for lane in range(LANES):
            middle, searches = (inside[lane] + outside[lane]) * 0.5, active[lane] > 0.0
            inside[lane] = middle if below[lane] > 0.0 else inside[lane]
            outside[lane] = middle if searches & (below[lane] <= 0.0) else outside[lane]


@device
def relief_search(
    repeat: Wrap, fragments: Fragments, count: int, eye: Floats, texels: Texels, columns: float, rows: float,
    settings: Settings, hits: Hits,
) -> None:  # fmt: skip
    """Hits (u, v, -d) of all fragments; a ray that leaves the map before it meets the surface is discarded."""
    total, beyond = np.float64(settings.linear_steps << settings.binary_steps), settings.linear_steps + 1.0
    u, v, along_u, along_v = lanes(), lanes(), lanes(), lanes()
    stop, inside, before, margin, nearest = lanes(), lanes(), lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        view_rays(fragments.patch, first, eye, u, v, along_u, along_v)
        for lane in range(LANES):
            stop[lane] = beyond if np.isnan(u[lane]) else -1.0
            before[lane], margin[lane], nearest[lane] = 0.0, np.inf, np.inf
        _linear_search(repeat, texels, columns, rows, u, v, along_u, along_v, settings, stop, before, margin, nearest)
        _binary_search(repeat, texels, columns, rows, u, v, along_u, along_v, settings, stop, inside, margin, nearest)
        store(margin, hits.margin, first)
        store(nearest, hits.domain_margin, first)
        for lane in range(LANES):
            if 0.0 <= stop[lane] < beyond:
                i, d = first + lane, inside[lane] / total
                hits.linear_index[i], hits.hit_index[i] = np.int32(stop[lane]), np.int32(inside[lane])
                hits.u[i], hits.v[i], hits.h[i] = u[lane] - along_u[lane] * d, v[lane] - along_v[lane] * d, -d
                hits.height_before[i] = before[lane]


@device
def texture_search(fragments: Fragments, count: int, settings: Settings, hits: Hits) -> None:
    """Texture mapping: every fragment hits the polygon where it is."""
    for i in range(count):
        hits.hit_index[i] = settings.linear_steps << settings.binary_steps
        hits.u[i], hits.v[i], hits.h[i] = fragments.patch[0, i], fragments.patch[1, i], 0.0
