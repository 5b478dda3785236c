"""How close each pixel came to another outcome: the margins of the march's comparisons.

Computed after the search, and only where all stages are kept: the search itself stays free of them. Steps whose
comparison cannot be the closest, because the maxima keep the wave's rays farther away, are left out.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.buffers import index_lanes, lanes, load, store
from ibr_ref.displacement.march import clearance, wave_bounds
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.sampling import fetch


@device
def _distance_to_border(u, v):
    """Distance of (u, v) from the border of the domain, on either side: |min(u, 1 - u, v, 1 - v)|."""
    return abs(min(min(u, 1.0 - u), min(v, 1.0 - v)))


@device
def _load(rays, first, u, v, h, du, dv, dh):
    load(rays.u, first, u)
    load(rays.v, first, v)
    load(rays.h, first, h)
    load(rays.du, first, du)
    load(rays.dv, first, dv)
    load(rays.dh, first, dh)


@device
def linear_margins(repeat, rays, count, texels, columns, rows, maxima, settings, linear_index, margin):
    """Smallest |h - H| over the comparisons of the linear search, without those at h = 0 or h = 1."""
    steps = settings.linear_steps
    total = np.float64(steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh, sample, height, closest = (
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
    )
    compared = index_lanes()
    for first in range(0, count, LANES):
        _load(rays, first, u, v, h, du, dv, dh)
        last_step, farthest = 0, 0.0
        for lane in range(LANES):
            stop = linear_index[first + lane]
            stop = stop if stop >= 0 else steps
            compared[lane] = stop if h[lane] <= 1.0 else -1  # a ray that does not go down was never searched
            last_step = max(last_step, compared[lane])
            closest[lane] = margin[first + lane]
            farthest = max(farthest, closest[lane] if compared[lane] >= 0 else 0.0)
        bounds_u, bounds_v, bounds_h = wave_bounds(u, v, h, du, dv, dh, settings.volume)
        if not settings.volume:
            last_step = min(last_step, steps - 1)  # the last comparison is at h = 0
        for step in range(last_step, -1, -1):
            t = step * stride / total
            if clearance(repeat, maxima, settings.bounded, bounds_u, bounds_v, bounds_h, t, t) >= farthest:
                continue
            for lane in range(LANES):
                p_u = u[lane] + du[lane] * t
                p_v = v[lane] + dv[lane] * t
                p_h = h[lane] + dh[lane] * t
                inside = (p_u >= low) & (p_u <= high) & (p_v >= low) & (p_v <= high) & (p_h != 0.0) & (p_h != 1.0)
                distance = abs(p_h - fetch(texels, columns, rows, repeat, p_u, p_v))
                sample[lane] = distance if inside else np.inf
            farthest = 0.0
            for lane in range(LANES):
                nearer = (step <= compared[lane]) & (sample[lane] < closest[lane])
                closest[lane] = sample[lane] if nearer else closest[lane]
                height[lane] = closest[lane] if compared[lane] >= 0 else 0.0
            for lane in range(LANES):
                farthest = height[lane] if height[lane] > farthest else farthest
        store(closest, margin, first)


@device
def binary_margins(repeat, rays, count, texels, columns, rows, settings, linear_index, hit_index, margin, border):
    """The same over the comparisons of the binary search, replayed from its result; `border` as in `linear_border`."""
    stride = np.int32(1 << settings.binary_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh, sample, edge, closest, nearest = (
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
        lanes(),
    )
    outside, inside, middle, index = index_lanes(), index_lanes(), index_lanes(), index_lanes()
    for first in range(0, count, LANES):
        _load(rays, first, u, v, h, du, dv, dh)
        searching = np.int32(0)
        for lane in range(LANES):
            stop = linear_index[first + lane]
            index[lane] = hit_index[first + lane]
            inside[lane] = stop * stride if stop > 0 else 0
            outside[lane] = inside[lane] - stride if stop > 0 else 0
            closest[lane] = margin[first + lane]
            nearest[lane] = border[first + lane]
            searching += np.int32(1) if stop > 0 else np.int32(0)
        for _ in range(settings.binary_steps if searching > 0 else 0):
            for lane in range(LANES):
                middle[lane] = (outside[lane] + inside[lane]) >> 1
            for lane in range(LANES):
                t = middle[lane] / total
                p_u = u[lane] + du[lane] * t
                p_v = v[lane] + dv[lane] * t
                p_h = h[lane] + dh[lane] * t
                covered = (p_u >= low) & (p_u <= high) & (p_v >= low) & (p_v <= high) & (p_h != 0.0) & (p_h != 1.0)
                distance = abs(p_h - fetch(texels, columns, rows, repeat, p_u, p_v))
                sample[lane] = distance if covered else np.inf
                edge[lane] = _distance_to_border(p_u, p_v)
            for lane in range(LANES):
                searched = outside[lane] < inside[lane]
                closest[lane] = sample[lane] if searched & (sample[lane] < closest[lane]) else closest[lane]
                nearest[lane] = edge[lane] if searched & (edge[lane] < nearest[lane]) else nearest[lane]
                below = middle[lane] >= index[lane]
                outside[lane] = outside[lane] if below | (not searched) else middle[lane]
                inside[lane] = middle[lane] if below & searched else inside[lane]
        store(closest, margin, first)
        if settings.bounded:
            store(nearest, border, first)


@device
def linear_border(rays, count, settings, linear_index, border):
    """Smallest distance in (u, v) of a sample of the linear search from the border of the domain."""
    steps = settings.linear_steps
    total = np.float64(steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    u, v, h, du, dv, dh, nearest = lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    tested = index_lanes()
    for first in range(0, count, LANES):
        _load(rays, first, u, v, h, du, dv, dh)
        last_step = 0
        for lane in range(LANES):
            stop = linear_index[first + lane]
            stop = stop if stop >= 0 else steps
            tested[lane] = stop if h[lane] <= 1.0 else -1
            last_step = max(last_step, tested[lane])
            nearest[lane] = np.inf
        for step in range(last_step + 1):
            t = step * stride / total
            for lane in range(LANES):
                edge = _distance_to_border(u[lane] + du[lane] * t, v[lane] + dv[lane] * t)
                nearest[lane] = edge if (step <= tested[lane]) & (edge < nearest[lane]) else nearest[lane]
        store(nearest, border, first)
