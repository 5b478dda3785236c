"""The search of protruded displacement mapping: linear, then binary (section 3.1), then steep or not (section 4.2).

All tests are on the lattice t = k/K, K = N 2^M. Fragments run in waves: each step of the search runs over all LANES in
an inner loop, with masks instead of branches, as a GPU does; LLVM turns those loops into SIMD (`pipeline.waves` says when).
Where to sample, the fetch (`pipeline.fetches`), and what follows from it are loops of their own: one loop for all takes
half as long again.

Arrays: linear_index, hit_index, height_before (F,), as in `Hits`.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Indices, Lanes, Texels, Wrap
from ibr_ref.displacement.buffers import Fragments, Hits, Rays, Settings, load_rays, over_polygon
from ibr_ref.displacement.maxima import Maxima, cells_in, level_for, within_reach
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.fetches import fetch_wave
from ibr_ref.pipeline.sampling import lerp
from ibr_ref.pipeline.waves import (
    gather,
    index_lanes,
    lanes,
    largest,
    load,
    load_indices,
    smallest,
    store,
    store_indices,
)

_VOLUME_SLACK = 1e-9  # rounding of h = B_h + (C_h - B_h) t; the paper's h = 1 - t is the same number in all lanes
_BORDER_SLACK = 1e-6

STRETCH = 16
"""Steps whose clearance is computed at once: steps take the place of lanes there."""

Bounds = tuple[float, float, float, float]
"""Of u, v or h over a wave's lanes: the smallest at t = 0, the smallest at t = 1, the largest at t = 0 and at t = 1."""


@device
def _bounds(values: Lanes, steps: Lanes, stop: Lanes) -> Bounds:
    """Smallest and largest value of a wave's open lanes at t = 0, and the same at t = 1: low0, low1, high0, high1."""
    low0, low1, high0, high1 = lanes(), lanes(), lanes(), lanes()
    for lane in range(LANES):
        start, end, is_open = values[lane], values[lane] + steps[lane], stop[lane] < 0.0
        low0[lane] = start if is_open else np.inf
        low1[lane] = end if is_open else np.inf
        high0[lane] = start if is_open else -np.inf
        high1[lane] = end if is_open else -np.inf
    return smallest(low0), smallest(low1), largest(high0), largest(high1)


@device
def wave_bounds(
    u: Lanes, v: Lanes, h: Lanes, du: Lanes, dv: Lanes, dh: Lanes, stop: Lanes, volume: bool
) -> tuple[Bounds, Bounds, Bounds]:
    """Bounds of u, v and h over the lanes that have not stopped, stop < 0 (paper: h is 1 - t in every lane)."""
    if volume:
        low0, low1, high0, high1 = _bounds(h, dh, stop)
        return (
            _bounds(u, du, stop),
            _bounds(v, dv, stop),
            (low0 - _VOLUME_SLACK, low1 - _VOLUME_SLACK, high0, high1),
        )
    return _bounds(u, du, stop), _bounds(v, dv, stop), (1.0, 0.0, 1.0, 0.0)


@device
def clearances(
    repeat: Wrap, maxima: Maxima, settings: Settings, bounds: tuple[Bounds, Bounds, Bounds], step: int, clear: Lanes
) -> None:
    """How far the wave's rays stay above all heights at each of STRETCH steps, at least; infinite outside the domain.

    At each t the lanes' values lie between the mixes of their bounds at t = 0 and t = 1. A NaN or infinite bound proves
    nothing.
    """
    total = np.float64(settings.linear_steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    (u_low0, u_low1, u_high0, u_high1), (v_low0, v_low1, v_high0, v_high1), (h_low0, h_low1, _, _) = bounds
    bounded = settings.bounded
    start, last = max(step * stride / total, 0.0), min((step + STRETCH - 1) * stride / total, 1.0)
    grid = level_for(
        maxima,
        max(lerp(u_high0 - u_low0, u_high1 - u_low1, start), lerp(u_high0 - u_low0, u_high1 - u_low1, last)),
        max(lerp(v_high0 - v_low0, v_high1 - v_low1, start), lerp(v_high0 - v_low0, v_high1 - v_low1, last)),
    )
    first, second, third, fourth = index_lanes(), index_lanes(), index_lanes(), index_lanes()
    near, lowest, heights, others = lanes(), lanes(), lanes(), lanes()
    for i in range(LANES):
        first[i] = second[i] = third[i] = fourth[i] = 0
    for i in range(STRETCH):
        t = np.float64(step + i) * stride / total
        u_low, u_high = lerp(u_low0, u_low1, t), lerp(u_high0, u_high1, t)
        v_low, v_high = lerp(v_low0, v_low1, t), lerp(v_high0, v_high1, t)
        first[i], second[i], third[i], fourth[i] = cells_in(grid, u_low, u_high, v_low, v_high)
        near[i] = 1.0 if within_reach(u_low, u_high, v_low, v_high) & (repeat is None) else 0.0
        beside = (u_high < -_BORDER_SLACK) | (u_low > 1.0 + _BORDER_SLACK)
        beside |= (v_high < -_BORDER_SLACK) | (v_low > 1.0 + _BORDER_SLACK)
        lowest[i] = np.inf if beside & bounded else lerp(h_low0, h_low1, t)
    gather(maxima.values, first, heights)
    for more in (second, third, fourth):
        gather(maxima.values, more, others)
        for i in range(STRETCH):
            heights[i] = heights[i] if heights[i] > others[i] else others[i]
    for i in range(STRETCH):
        clear[i] = lowest[i] - (heights[i] if near[i] > 0.0 else maxima.everywhere)


@device
def _first_step(maxima: Maxima, settings: Settings) -> int:
    """The first step of the paper's interval that is not above all heights."""
    total = np.float64(settings.linear_steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    step = 0
    while not settings.volume and step <= settings.linear_steps and 1.0 - step * stride / total >= maxima.everywhere:
        step += 1
    return step


@device
def linear_search(
    repeat: Wrap, rays: Rays, count: int, texels: Texels, columns: float, rows: float, maxima: Maxima,
    settings: Settings, linear_index: Indices,
) -> None:  # fmt: skip
    """Step at which each ray is first found inside the solid, -1 if never.

    Stretches that the maxima prove empty for a whole wave are leapt over.
    """
    steps = settings.linear_steps
    total = np.float64(steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    p_u, p_v, sample, stop, clear = lanes(), lanes(), lanes(), lanes(), lanes()
    first_step = _first_step(maxima, settings)
    for first in range(0, count, LANES):
        load_rays(rays, first, u, v, h, du, dv, dh)
        for lane in range(LANES):
            stop[lane] = -1.0
        bounds = wave_bounds(u, v, h, du, dv, dh, stop, settings.volume)
        step, known = first_step, first_step  # clear[i] is known for the step known - STRETCH + i
        while step <= steps:
            if step == known:
                clearances(repeat, maxima, settings, bounds, step, clear)
                known = step + STRETCH
            if clear[step - known + STRETCH] >= 0.0:
                step += 1
                continue
            t, here = step * stride / total, np.float64(step)
            for lane in range(LANES):
                p_u[lane] = u[lane] + du[lane] * t
                p_v[lane] = v[lane] + dv[lane] * t
            fetch_wave(texels, columns, rows, repeat, p_u, p_v, sample)
            stopped = 0
            for lane in range(LANES):
                inside = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
                below = h[lane] + dh[lane] * t < sample[lane]
                stop[lane] = here if below & inside & (stop[lane] < 0.0) else stop[lane]
            for lane in range(LANES):
                stopped += 1 if stop[lane] >= 0.0 else 0
            if stopped == LANES:
                break
            step += 1
        store_indices(stop, linear_index, first)


@device
def binary_search(
    repeat: Wrap, rays: Rays, count: int, texels: Texels, columns: float, rows: float, settings: Settings,
    linear_index: Indices, hit_index: Indices,
) -> None:  # fmt: skip
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
        load_indices(linear_index, first, stop)
        for lane in range(LANES):
            inside[lane] = stop[lane] * stride if stop[lane] >= 0.0 else -1.0
            outside[lane] = inside[lane] - stride if stop[lane] > 0.0 else inside[lane]
        searching = largest(stop) > 0.0
        if searching:
            load_rays(rays, first, u, v, h, du, dv, dh)
        for _ in range(settings.binary_steps if searching else 0):
            for lane in range(LANES):
                t = (outside[lane] + inside[lane]) * 0.5 / total
                p_u[lane] = u[lane] + du[lane] * t
                p_v[lane] = v[lane] + dv[lane] * t
                p_h[lane] = h[lane] + dh[lane] * t
            fetch_wave(texels, columns, rows, repeat, p_u, p_v, sample)
            for lane in range(LANES):
                covered = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
                middle = (outside[lane] + inside[lane]) * 0.5
                below = (p_h[lane] < sample[lane]) & covered
                searched = stop[lane] > 0.0
                inside[lane] = middle if below & searched else inside[lane]
                outside[lane] = outside[lane] if below | (not searched) else middle
        store_indices(inside, hit_index, first)


@device
def heights_before(
    repeat: Wrap, rays: Rays, count: int, texels: Texels, columns: float, rows: float, settings: Settings,
    linear_index: Indices, height_before: Floats,
) -> None:  # fmt: skip
    """a (section 4.2): the height map one linear step before the stop; 0 where that sample is empty."""
    stride = np.float64(1 << settings.binary_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, du, dv = lanes(), lanes(), lanes(), lanes()
    p_u, p_v, stop, before = lanes(), lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        load_indices(linear_index, first, stop)
        if largest(stop) <= 0.0:  # nothing to read: the heights stay 0
            continue
        load(rays.u, first, u)
        load(rays.v, first, v)
        load(rays.du, first, du)
        load(rays.dv, first, dv)
        for lane in range(LANES):
            t = (stop[lane] - 1.0) * stride / total
            p_u[lane] = u[lane] + du[lane] * t
            p_v[lane] = v[lane] + dv[lane] * t
        fetch_wave(texels, columns, rows, repeat, p_u, p_v, before)
        for lane in range(LANES):
            inside = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
            before[lane] = before[lane] if inside & (stop[lane] > 0.0) else 0.0
        store(before, height_before, first)


@device
def place_hits(fragments: Fragments, rays: Rays, count: int, settings: Settings, hits: Hits) -> None:
    """(u, v, h) of each hit, from its lattice index.

    No stop, or a hit at k = K: a fragment over the polygon hits the polygon itself, any other is discarded.
    """
    end = np.float64(settings.linear_steps << settings.binary_steps)
    u, v, h, du, dv, dh = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    c_u, c_v, c_h = lanes(), lanes(), lanes()
    index, linear, before = lanes(), lanes(), lanes()
    for first in range(0, count, LANES):
        load_rays(rays, first, u, v, h, du, dv, dh)
        load(fragments.patch[0], first, c_u)
        load(fragments.patch[1], first, c_v)
        load(fragments.patch[2], first, c_h)
        load_indices(hits.hit_index, first, index)
        load_indices(hits.linear_index, first, linear)
        load(hits.height_before, first, before)
        for lane in range(LANES):
            hit = (index[lane] >= 0.0) & (index[lane] < end)
            ground = over_polygon(c_u[lane], c_v[lane], c_h[lane]) & (h[lane] <= 1.0)
            t = index[lane] / end if hit else 1.0
            u[lane] = u[lane] + du[lane] * t
            v[lane] = v[lane] + dv[lane] * t
            h[lane] = h[lane] + dh[lane] * t if hit else 0.0
            index[lane] = index[lane] if hit else (end if ground else -1.0)
            linear[lane] = linear[lane] if hit else -1.0
            before[lane] = before[lane] if hit else 0.0
        store(u, hits.u, first)
        store(v, hits.v, first)
        store(h, hits.h, first)
        store_indices(index, hits.hit_index, first)
        store_indices(linear, hits.linear_index, first)
        store(before, hits.height_before, first)


@device
def mark_steep(count: int, settings: Settings, hits: Hits) -> None:
    """Steep: the hit is higher than the map was one linear step before, by more than delta (section 4.2)."""
    for i in range(count):
        rise = hits.h[i] - hits.height_before[i]
        hits.steep[i] = hits.linear_index[i] >= 0 and rise > settings.steep_threshold
        hits.steep_margin[i] = abs(rise - settings.steep_threshold)
