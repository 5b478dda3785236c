"""How close each pixel came to another outcome: the margins of the march's comparisons.

Computed after the search, and only where all stages are kept: the search itself stays free of them. Steps whose
comparison cannot be the closest, because the maxima keep the wave's rays farther away, are left out.

Arrays: linear_index, hit_index, margin, border (F,), as in `Hits`.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Indices, Lanes, Texels, Whole, Wrap
from ibr_ref.displacement.buffers import Rays, Settings, load_rays
from ibr_ref.displacement.march import STRETCH, clearances, wave_bounds
from ibr_ref.displacement.maxima import Maxima
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.fetches import fetch_wave
from ibr_ref.pipeline.waves import lanes, largest, load, load_indices, store


@device
def _distance_to_border(u: float, v: float) -> float:
    """Distance of (u, v) from the border of the domain, on either side: |min(u, 1 - u, v, 1 - v)|."""
    return abs(min(min(u, 1.0 - u), min(v, 1.0 - v)))


@device
def _last_steps(rays: Rays, linear_index: Indices, first: int, steps: int, last: Lanes) -> Whole:
    """The last step that each lane of a wave was tested at, -1 where the ray does not go down; the largest of them."""
    stop, h = lanes(), lanes()
    load_indices(linear_index, first, stop)
    load(rays.h, first, h)
    for lane in range(LANES):
        stop[lane] = stop[lane] if stop[lane] >= 0.0 else np.float64(steps)
        stop[lane] = stop[lane] if h[lane] <= 1.0 else -1.0
    store(stop, last, 0)
    return np.int64(largest(stop))


@device
def _farthest(closest: Lanes, compared: Lanes) -> float:
    """The largest margin of a wave so far: what stays farther away than this changes none."""
    near, last = lanes(), lanes()
    load(closest, 0, near)
    load(compared, 0, last)
    for lane in range(LANES):
        near[lane] = near[lane] if last[lane] >= 0.0 else 0.0
    return largest(near)


@device
def linear_margins(
    repeat: Wrap, rays: Rays, count: int, texels: Texels, columns: float, rows: float, maxima: Maxima,
    settings: Settings, linear_index: Indices, margin: Floats,
) -> None:  # fmt: skip
    """Smallest |h - H| over the comparisons of the linear search, without those at h = 0 or h = 1."""
    steps = settings.linear_steps
    total = np.float64(steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    p_u, p_v, sample, closest = lanes(), lanes(), lanes(), lanes()
    compared, never, clear = lanes(), lanes(), lanes()
    for lane in range(LANES):
        never[lane] = -1.0
    for first in range(0, count, LANES):
        load_rays(rays, first, u, v, h, du, dv, dh)
        load(margin, first, closest)
        last_step = _last_steps(rays, linear_index, first, steps, compared)
        if not settings.volume:
            last_step = min(last_step, steps - 1)  # the last comparison is at h = 0
        farthest = _farthest(closest, compared)
        bounds = wave_bounds(u, v, h, du, dv, dh, never, settings.volume)
        known = last_step + 1  # clear[i] is known for the step known + i
        for step in range(last_step, -1, -1):
            if step < known:
                known = step - STRETCH + 1
                clearances(repeat, maxima, settings, bounds, known, clear)
            if clear[step - known] >= farthest:
                continue
            t, here = step * stride / total, np.float64(step)
            for lane in range(LANES):
                p_u[lane] = u[lane] + du[lane] * t
                p_v[lane] = v[lane] + dv[lane] * t
            fetch_wave(texels, columns, rows, repeat, p_u, p_v, sample)
            for lane in range(LANES):
                p_h = h[lane] + dh[lane] * t
                distance = abs(p_h - sample[lane])
                inside = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
                counts = inside & (p_h != 0.0) & (p_h != 1.0) & (here <= compared[lane])
                closest[lane] = distance if counts & (distance < closest[lane]) else closest[lane]
            farthest = _farthest(closest, compared)
        store(closest, margin, first)


@device
def binary_margins(
    repeat: Wrap, rays: Rays, count: int, texels: Texels, columns: float, rows: float, settings: Settings,
    linear_index: Indices, hit_index: Indices, margin: Floats, border: Floats,
) -> None:  # fmt: skip
    """The same over the comparisons of the binary search, replayed from its result; `border` as in `linear_border`."""
    stride = np.float64(1 << settings.binary_steps)
    total = np.float64(settings.linear_steps << settings.binary_steps)
    low, high = (0.0, 1.0) if settings.bounded else (-np.inf, np.inf)
    u, v, h, du, dv, dh = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    p_u, p_v, p_h, sample = lanes(), lanes(), lanes(), lanes()
    outside, inside, stop, index = lanes(), lanes(), lanes(), lanes()
    closest, nearest = lanes(), lanes()
    for first in range(0, count, LANES):
        load_indices(linear_index, first, stop)
        if largest(stop) <= 0.0:
            continue
        load_indices(hit_index, first, index)
        for lane in range(LANES):
            inside[lane] = stop[lane] * stride
            outside[lane] = inside[lane] - stride
        load_rays(rays, first, u, v, h, du, dv, dh)
        load(margin, first, closest)
        load(border, first, nearest)
        for _ in range(settings.binary_steps):
            for lane in range(LANES):
                t = (outside[lane] + inside[lane]) * 0.5 / total
                p_u[lane] = u[lane] + du[lane] * t
                p_v[lane] = v[lane] + dv[lane] * t
                p_h[lane] = h[lane] + dh[lane] * t
            fetch_wave(texels, columns, rows, repeat, p_u, p_v, sample)
            for lane in range(LANES):
                distance = abs(p_h[lane] - sample[lane])
                covered = (p_u[lane] >= low) & (p_u[lane] <= high) & (p_v[lane] >= low) & (p_v[lane] <= high)
                counts = covered & (p_h[lane] != 0.0) & (p_h[lane] != 1.0) & (stop[lane] > 0.0)
                closest[lane] = distance if counts & (distance < closest[lane]) else closest[lane]
            for lane in range(LANES):
                edge = _distance_to_border(p_u[lane], p_v[lane])
                nearest[lane] = edge if (stop[lane] > 0.0) & (edge < nearest[lane]) else nearest[lane]
            for lane in range(LANES):
                middle = (outside[lane] + inside[lane]) * 0.5
                below = middle >= index[lane]
                outside[lane] = outside[lane] if below else middle
                inside[lane] = middle if below else inside[lane]
        store(closest, margin, first)
        if settings.bounded:
            store(nearest, border, first)


@device
def linear_border(rays: Rays, count: int, settings: Settings, linear_index: Indices, border: Floats) -> None:
    """Smallest distance in (u, v) of a sample of the linear search from the border of the domain."""
    steps = settings.linear_steps
    total = np.float64(steps << settings.binary_steps)
    stride = np.float64(1 << settings.binary_steps)
    u, v, du, dv = lanes(), lanes(), lanes(), lanes()
    nearest, tested = lanes(), lanes()
    for first in range(0, count, LANES):
        load(rays.u, first, u)
        load(rays.v, first, v)
        load(rays.du, first, du)
        load(rays.dv, first, dv)
        last_step = _last_steps(rays, linear_index, first, steps, tested)
        for lane in range(LANES):
            nearest[lane] = np.inf
        for step in range(last_step + 1):
            t, here = step * stride / total, np.float64(step)
            for lane in range(LANES):
                edge = _distance_to_border(u[lane] + du[lane] * t, v[lane] + dv[lane] * t)
                nearest[lane] = edge if (here <= tested[lane]) & (edge < nearest[lane]) else nearest[lane]
        store(nearest, border, first)
