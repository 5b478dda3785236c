"""The search of protruded displacement mapping: linear, then binary (section 3.1), then steep or not (section 4.2).

All tests are on the lattice t = k/K, K = N 2^M. Fragments run in waves: each step of the search runs over all LANES in
an inner loop, with masks instead of branches, as a GPU does; LLVM turns those loops into SIMD gathers. It only does so
where the lanes' arrays are allocated in the same function: it must see that stores to them cannot change the texture. Where
to sample, the fetch, and what follows from it are loops of their own: one loop for all takes half as long again.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.buffers import lanes, load_rays, over_polygon, store, store_indices
from ibr_ref.displacement.maxima import highest
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.sampling import fetch, lerp

_LEAP = 16  # most steps that one look at the maxima may prove empty
_VOLUME_SLACK = 1e-9  # rounding of h = B_h + (C_h - B_h) t; the paper's h = 1 - t is the same number in all lanes


@device
def _bounds(values, steps, stop):
    """Smallest and largest value of a wave's open lanes at t = 0, and the same at t = 1: low0, high0, low1, high1."""
    low0 = low1 = np.inf
    high0 = high1 = -np.inf
    for lane in range(LANES):
        start = values[lane] if stop[lane] < 0 else np.nan  # a NaN passes no comparison
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
def wave_bounds(u, v, h, du, dv, dh, stop, volume):
    """Bounds of u, v and h over the lanes that have not stopped, stop < 0 (paper: h is 1 - t in every lane)."""
    if volume:
        low0, high0, low1, high1 = _bounds(h, dh, stop)
        return (
            _bounds(u, du, stop),
            _bounds(v, dv, stop),
            (low0 - _VOLUME_SLACK, high0, low1 - _VOLUME_SLACK, high1),
        )
    return _bounds(u, du, stop), _bounds(v, dv, stop), (1.0, 1.0, 0.0, 0.0)


@device
def _first_step(maxima, settings):
    """The first step of the paper's interval that is not above all heights."""
    total = np.float64(settings.linear_steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    step = 0
    while not settings.volume and step <= settings.linear_steps and 1.0 - step * stride / total >= maxima.everywhere:
        step += 1
    return step


@device
def linear_search(repeat, rays, count, texels, columns, rows, maxima, settings, linear_index):
    """Step at which each ray is first found inside the solid, -1 if never.

    Stretches that the maxima prove empty for a whole wave are leapt over.
    """
    steps = settings.linear_steps
    total = np.float64(steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    p_u, p_v, sample, stop = lanes(), lanes(), lanes(), lanes()
    first_step = _first_step(maxima, settings)
    for first in range(0, count, LANES):
        load_rays(rays, first, u, v, h, du, dv, dh)
        for lane in range(LANES):
            stop[lane] = -1.0
        bounds_u, bounds_v, bounds_h = wave_bounds(u, v, h, du, dv, dh, stop, settings.volume)
        step, leap, stopped = first_step, _LEAP, 0.0
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
                p_u[lane] = u[lane] + du[lane] * t0
                p_v[lane] = v[lane] + dv[lane] * t0
            for lane in range(LANES):
                sample[lane] = fetch(texels, columns, rows, repeat, p_u[lane], p_v[lane])
            before, stopped, here = stopped, 0.0, np.float64(step)
            for lane in range(LANES):
                inside = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
                below = h[lane] + dh[lane] * t0 < sample[lane]
                stop[lane] = here if below & inside & (stop[lane] < 0.0) else stop[lane]
            for lane in range(LANES):
                stopped += 1.0 if stop[lane] >= 0.0 else 0.0
            if stopped == LANES:
                break
            if stopped > before:  # the lanes that are left may have a clear way
                bounds_u, bounds_v, bounds_h = wave_bounds(u, v, h, du, dv, dh, stop, settings.volume)
            step += 1
        store_indices(stop, linear_index, first)


@device
def binary_search(repeat, rays, count, texels, columns, rows, settings, linear_index, hit_index):
    """Lattice index of each hit: M halvings of the last linear step; -1 where the linear search found nothing.

    Indices are floats here, which hold them exactly: a wave of one type needs no conversions.
    """
    stride = np.float64(1 << settings.binary_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    p_u, p_v, p_h, sample = lanes(), lanes(), lanes(), lanes()
    outside, inside, stop = lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        searching = 0.0
        for lane in range(LANES):
            stop[lane] = np.float64(linear_index[first + lane])
            inside[lane] = stop[lane] * stride if stop[lane] >= 0.0 else -1.0
            outside[lane] = inside[lane] - stride if stop[lane] > 0.0 else inside[lane]
        for lane in range(LANES):
            searching += 1.0 if stop[lane] > 0.0 else 0.0
        if searching > 0.0:
            load_rays(rays, first, u, v, h, du, dv, dh)
        for _ in range(settings.binary_steps if searching > 0.0 else 0):
            for lane in range(LANES):
                t = (outside[lane] + inside[lane]) * 0.5 / total
                p_u[lane] = u[lane] + du[lane] * t
                p_v[lane] = v[lane] + dv[lane] * t
                p_h[lane] = h[lane] + dh[lane] * t
            for lane in range(LANES):
                sample[lane] = fetch(texels, columns, rows, repeat, p_u[lane], p_v[lane])
            for lane in range(LANES):
                covered = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
                middle = (outside[lane] + inside[lane]) * 0.5
                below = (p_h[lane] < sample[lane]) & covered
                searched = stop[lane] > 0.0
                inside[lane] = middle if below & searched else inside[lane]
                outside[lane] = outside[lane] if below | (not searched) else middle
        store_indices(inside, hit_index, first)


@device
def heights_before(repeat, rays, count, texels, columns, rows, settings, linear_index, height_before):
    """a (section 4.2): the height map one linear step before the stop; 0 where that sample is empty."""
    stride = np.float64(1 << settings.binary_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    p_u, p_v, stop, before = lanes(), lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        searched = 0.0
        for lane in range(LANES):
            stop[lane] = np.float64(linear_index[first + lane])
        for lane in range(LANES):
            searched += 1.0 if stop[lane] > 0.0 else 0.0
        if searched == 0.0:  # nothing to read: the heights stay 0
            continue
        for lane in range(LANES):
            i = first + lane
            t = (stop[lane] - 1.0) * stride / total
            p_u[lane] = rays.u[i] + rays.du[i] * t
            p_v[lane] = rays.v[i] + rays.dv[i] * t
        for lane in range(LANES):
            before[lane] = fetch(texels, columns, rows, repeat, p_u[lane], p_v[lane])
        for lane in range(LANES):
            inside = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
            before[lane] = before[lane] if inside & (stop[lane] > 0.0) else 0.0
        store(before, height_before, first)


@device
def place_hits(fragments, rays, count, settings, hits):
    """(u, v, h) of each hit, from its lattice index.

    No stop, or a hit at k = K: a fragment over the polygon hits the polygon itself, any other is discarded.
    """
    end = np.float64(settings.linear_steps << settings.binary_steps)
    u, v, h, t = lanes(), lanes(), lanes(), lanes()
    index, stopped = lanes(), lanes()
    for first in range(0, count, LANES):
        for lane in range(LANES):
            index[lane] = np.float64(hits.hit_index[first + lane])
        for lane in range(LANES):
            hit = (index[lane] >= 0.0) & (index[lane] < end)
            stopped[lane] = 1.0 if hit else 0.0
            t[lane] = index[lane] / end if hit else 1.0
        for lane in range(LANES):
            i = first + lane
            u[lane] = rays.u[i] + rays.du[i] * t[lane]
            v[lane] = rays.v[i] + rays.dv[i] * t[lane]
            h[lane] = rays.h[i] + rays.dh[i] * t[lane] if stopped[lane] > 0.0 else 0.0
        store(u, hits.u, first)
        store(v, hits.v, first)
        store(h, hits.h, first)
        for lane in range(LANES):
            i = first + lane
            if stopped[lane] == 0.0:
                ground = over_polygon(fragments, i) & (rays.h[i] <= 1.0)
                hits.hit_index[i] = np.int32(end) if ground else np.int32(-1)
                hits.linear_index[i] = -1
                hits.height_before[i] = 0.0


@device
def mark_steep(count, settings, hits):
    """Steep: the hit is higher than the map was one linear step before, by more than delta (section 4.2)."""
    for i in range(count):
        rise = hits.h[i] - hits.height_before[i]
        hits.steep[i] = hits.linear_index[i] >= 0 and rise > settings.steep_threshold
        hits.steep_margin[i] = abs(rise - settings.steep_threshold)
