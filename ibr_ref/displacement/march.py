"""The search of protruded displacement mapping: linear, then binary (section 3.1), then steep or not (section 4.2).

All tests are on the lattice t = k/K, K = N 2^M. Fragments run in waves: each step of the search runs over all LANES in
an inner loop, with masks instead of branches, as a GPU does; LLVM turns those loops into SIMD gathers. It only does so
where the lanes' arrays are allocated in the same function: it must see that stores to them cannot change the texture.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.buffers import index_lanes, lanes, over_polygon, store
from ibr_ref.displacement.maxima import highest
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.sampling import fetch, lerp

_LEAP = 16  # most steps that one look at the maxima may prove empty
_VOLUME_SLACK = 1e-9  # rounding of h = B_h + (C_h - B_h) t; the paper's h = 1 - t is the same number in all lanes


@device
def _bounds(values, steps):
    """Smallest and largest value of a wave at t = 0, and the same at t = 1: low0, high0, low1, high1."""
    low0 = high0 = values[0]
    low1 = high1 = values[0] + steps[0]
    for lane in range(1, LANES):
        start = values[lane]
        end = start + steps[lane]
        low0 = start if start < low0 else low0
        high0 = start if start > high0 else high0
        low1 = end if end < low1 else low1
        high1 = end if end > high1 else high1
    return low0, high0, low1, high1


@device
def _between(bounds, t0, t1):
    """Bounds of a wave's values for t in [t0, t1]: at each t they lie between the mixes of the ends' bounds."""
    low = min(lerp(bounds[0], bounds[2], t0), lerp(bounds[0], bounds[2], t1))
    return low, max(lerp(bounds[1], bounds[3], t0), lerp(bounds[1], bounds[3], t1))


@device
def clearance(repeat, maxima, bounded, bounds_u, bounds_v, bounds_h, t0, t1):
    """How far the wave's rays stay above all heights for t in [t0, t1], at least; infinite outside the domain."""
    u_low, u_high = _between(bounds_u, t0, t1)
    v_low, v_high = _between(bounds_v, t0, t1)
    if bounded and (u_high < -1e-6 or u_low > 1.0 + 1e-6 or v_high < -1e-6 or v_low > 1.0 + 1e-6):
        return np.inf
    h_low, _ = _between(bounds_h, t0, t1)
    if repeat is None:
        return h_low - highest(maxima, u_low, u_high, v_low, v_high)
    return h_low - maxima.everywhere


@device
def wave_bounds(u, v, h, du, dv, dh, volume):
    """Bounds of u, v and h over a wave (paper: h is 1 - t in every lane)."""
    if volume:
        low0, high0, low1, high1 = _bounds(h, dh)
        return (
            _bounds(u, du),
            _bounds(v, dv),
            (low0 - _VOLUME_SLACK, high0, low1 - _VOLUME_SLACK, high1),
        )
    return _bounds(u, du), _bounds(v, dv), (1.0, 1.0, 0.0, 0.0)


@device
def linear_search(repeat, rays, count, texels, columns, rows, maxima, settings, linear_index):
    """Step at which each ray is first found inside the solid, -1 if never.

    Stretches that the maxima prove empty for a whole wave are leapt over.
    """
    steps = settings.linear_steps
    total = np.float64(steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh, sample, height = lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    stop = index_lanes()
    for first in range(0, count, LANES):
        for lane in range(LANES):
            i = first + lane
            u[lane], v[lane], h[lane] = rays.u[i], rays.v[i], rays.h[i]
            du[lane], dv[lane], dh[lane] = rays.du[i], rays.dv[i], rays.dh[i]
            stop[lane] = -1
        bounds_u, bounds_v, bounds_h = wave_bounds(u, v, h, du, dv, dh, settings.volume)
        step, leap = 0, _LEAP // 2
        while step <= steps:
            leap = min(leap, steps - step + 1)
            t0, t1 = step * stride / total, (step + leap - 1) * stride / total
            if clearance(repeat, maxima, settings.bounded, bounds_u, bounds_v, bounds_h, t0, t1) >= 0.0:
                step += leap
                leap = min(2 * leap, _LEAP)
                continue
            if leap > 1:
                leap //= 2
                continue
            for lane in range(LANES):
                p_u = u[lane] + du[lane] * t0
                p_v = v[lane] + dv[lane] * t0
                inside = (p_u >= low) & (p_u <= high) & (p_v >= low) & (p_v <= high)
                texel = fetch(texels, columns, rows, repeat, p_u, p_v)
                sample[lane] = texel if inside else 0.0
                height[lane] = h[lane] + dh[lane] * t0
            stopped = np.int32(0)
            for lane in range(LANES):
                stop[lane] = step if (height[lane] < sample[lane]) & (stop[lane] < 0) else stop[lane]
                stopped += np.int32(1) if stop[lane] >= 0 else np.int32(0)
            if stopped == LANES:
                break
            step += 1
        store(stop, linear_index, first)


@device
def binary_search(repeat, rays, count, texels, columns, rows, settings, linear_index, hit_index):
    """Lattice index of each hit: M halvings of the last linear step; -1 where the linear search found nothing."""
    stride = np.int32(1 << settings.binary_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh, sample, height = lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    outside, inside, middle = index_lanes(), index_lanes(), index_lanes()
    for first in range(0, count, LANES):
        searching = np.int32(0)
        for lane in range(LANES):
            i = first + lane
            u[lane], v[lane], h[lane] = rays.u[i], rays.v[i], rays.h[i]
            du[lane], dv[lane], dh[lane] = rays.du[i], rays.dv[i], rays.dh[i]
            stop = linear_index[i]
            inside[lane] = stop * stride if stop >= 0 else -1
            outside[lane] = inside[lane] - stride if stop > 0 else inside[lane]
            searching += np.int32(1) if stop > 0 else np.int32(0)
        for _ in range(settings.binary_steps if searching > 0 else 0):
            for lane in range(LANES):
                middle[lane] = (outside[lane] + inside[lane]) >> 1
            for lane in range(LANES):
                t = middle[lane] / total
                p_u = u[lane] + du[lane] * t
                p_v = v[lane] + dv[lane] * t
                covered = (p_u >= low) & (p_u <= high) & (p_v >= low) & (p_v <= high)
                texel = fetch(texels, columns, rows, repeat, p_u, p_v)
                sample[lane] = texel if covered else 0.0
                height[lane] = h[lane] + dh[lane] * t
            for lane in range(LANES):
                below = height[lane] < sample[lane]
                open_ = outside[lane] < inside[lane]
                inside[lane] = middle[lane] if below & open_ else inside[lane]
                outside[lane] = outside[lane] if below | (not open_) else middle[lane]
        store(inside, hit_index, first)


@device
def heights_before(repeat, rays, count, texels, columns, rows, settings, linear_index, height_before):
    """a (section 4.2): the height map one linear step before the stop; 0 where that sample is empty."""
    stride = np.float64(1 << settings.binary_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    before = lanes()
    for first in range(0, count, LANES):
        searched = np.int32(0)
        for lane in range(LANES):
            searched += np.int32(1) if linear_index[first + lane] > 0 else np.int32(0)
        if searched == 0:  # nothing to read: the heights stay 0
            continue
        for lane in range(LANES):
            i = first + lane
            stop = linear_index[i]
            t = (stop - 1) * stride / total if stop > 0 else 0.0
            p_u = rays.u[i] + rays.du[i] * t
            p_v = rays.v[i] + rays.dv[i] * t
            inside = (p_u >= low) & (p_u <= high) & (p_v >= low) & (p_v <= high) & (stop > 0)
            texel = fetch(texels, columns, rows, repeat, p_u, p_v)
            before[lane] = texel if inside else 0.0
        store(before, height_before, first)


@device
def place_hits(fragments, rays, count, settings, hits):
    """(u, v, h) of each hit, from its lattice index.

    No stop, or a hit at k = K: a fragment over the polygon hits the polygon itself, any other is discarded.
    """
    end = np.int32(settings.linear_steps << settings.binary_steps)
    total = np.float64(end)
    u, v, h, before = lanes(), lanes(), lanes(), lanes()
    linear, index = index_lanes(), index_lanes()
    for first in range(0, count, LANES):
        for lane in range(LANES):
            i = first + lane
            k = hits.hit_index[i]
            stopped = (k >= 0) & (k < end)
            ground = over_polygon(fragments, i) & (rays.h[i] <= 1.0) & (not stopped)
            t = k / total if stopped else 1.0
            u[lane] = rays.u[i] + rays.du[i] * t
            v[lane] = rays.v[i] + rays.dv[i] * t
            h[lane] = rays.h[i] + rays.dh[i] * t if stopped else 0.0
            before[lane] = hits.height_before[i] if stopped else 0.0
            linear[lane] = hits.linear_index[i] if stopped else -1
            index[lane] = k if stopped else (end if ground else -1)
        store(u, hits.u, first)
        store(v, hits.v, first)
        store(h, hits.h, first)
        store(before, hits.height_before, first)
        store(linear, hits.linear_index, first)
        store(index, hits.hit_index, first)


@device
def mark_steep(count, settings, hits):
    """Steep: the hit is higher than the map was one linear step before, by more than delta (section 4.2)."""
    for i in range(count):
        rise = hits.h[i] - hits.height_before[i]
        hits.steep[i] = hits.linear_index[i] >= 0 and rise > settings.steep_threshold
        hits.steep_margin[i] = abs(rise - settings.steep_threshold)
