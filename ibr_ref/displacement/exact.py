"""Ground truth: the first intersection of the view ray with the piecewise-bilinear height field itself.

Cell by cell (DDA over the cells between texel centres); within a cell the height above the surface is a quadratic in
the ray's parameter. The border walls of the solid are included. It finds what the linear search steps over: narrow and
tall shapes (the paper's second open problem).
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Texels, Wrap
from ibr_ref.displacement.buffers import Fragments, Hits, Rays, Settings, over_polygon
from ibr_ref.jit import device
from ibr_ref.pipeline.sampling import fetch

_MOST_CELLS = 1 << 24  # a repeated, nearly empty plane seen at a grazing angle is given up there


@device
def upward_crossing(c: float, b: float, a: float, end: float) -> float:
    """Smallest s in [0, 1] at which a s^2 + b s + c, with c <= 0 and the value `end` at s = 1, becomes positive; else 2.

    Of the two roots only (-b + sqrt(D))/(2 a) has a positive slope; written so that nothing cancels.
    """
    apex = a < 0.0 and 0.0 < b < -2.0 * a and c - b * b / (4.0 * a) > 0.0
    if not (end > 0.0 or apex):
        return 2.0
    root = np.sqrt(max(0.0, b * b - 4.0 * a * c))
    if b >= 0.0:
        s = -2.0 * c / (b + root) if b + root > 0.0 else 0.0
    else:
        s = (root - b) / (2.0 * a) if a != 0.0 else 1.0
    return min(max(s, 0.0), 1.0)


@device
def next_line(x: float, dx: float, cell: float) -> float:
    """t at which x + t dx leaves the cell [cell, cell + 1]."""
    if dx > 0.0:
        return (cell + 1.0 - x) / dx
    if dx < 0.0:
        return (cell - x) / dx
    return np.inf


@device
def clip_unit(x: float, dx: float, t0: float, t1: float) -> tuple[float, float]:
    """Narrow [t0, t1] to where x + t dx lies in [0, 1]."""
    if dx == 0.0:
        return (t0, t1) if 0.0 <= x <= 1.0 else (1.0, 0.0)
    a, b = (0.0 - x) / dx, (1.0 - x) / dx
    return max(t0, min(a, b)), min(t1, max(a, b))


@device
def _above(repeat: Wrap, texels: Texels, columns: float, rows: float, u: float, v: float, h: float) -> float:
    """H - h at a point: >= 0 inside the solid."""
    return fetch(texels, columns, rows, repeat, u, v) - h


@device
def intersect(
    repeat: Wrap, texels: Texels, columns: float, rows: float, highest: float, u: float, v: float, h: float, du: float,
    dv: float, dh: float, t0: float, t1: float,
) -> float:  # fmt: skip
    """Smallest t in [t0, t1] at which (u, v, h) + t (du, dv, dh) is inside the solid; 2 if there is none.

    `highest`: the largest height of all, above which nothing can be hit.
    """
    if dh < 0.0:
        t0 = max(t0, (highest - h) / dh)  # down to the highest point
    if not t0 <= t1:
        return 2.0
    value = _above(repeat, texels, columns, rows, u + t0 * du, v + t0 * dv, h + t0 * dh)
    if value > 0.0:
        return t0
    x, y = u * columns - 0.5, v * rows - 0.5
    dx, dy = du * columns, dv * rows
    column, row = np.floor(x + t0 * dx), np.floor(y + t0 * dy)
    if dx < 0.0 and x + t0 * dx == column:
        column -= 1.0
    if dy < 0.0 and y + t0 * dy == row:
        row -= 1.0
    t = t0
    for _ in range(_MOST_CELLS):
        next_x, next_y = next_line(x, dx, column), next_line(y, dy, row)
        end = max(t, min(next_x, next_y, t1))
        middle = 0.5 * (t + end)
        # The quadratic through three points of the cell: exact, as a bilinear surface is one along a line.
        start = value
        half = _above(repeat, texels, columns, rows, u + middle * du, v + middle * dv, h + middle * dh)
        value = _above(repeat, texels, columns, rows, u + end * du, v + end * dv, h + end * dh)
        curvature = 2.0 * (value - 2.0 * half + start)
        s = upward_crossing(start, value - start - curvature, curvature, value)
        if s <= 1.0:
            return t + s * (end - t)
        if not end < t1:
            return 2.0
        if next_x <= end:
            column += 1.0 if dx > 0.0 else -1.0
        if next_y <= end:
            row += 1.0 if dy > 0.0 else -1.0
        t = end
    return 2.0


@device
def exact_search(
    repeat: Wrap, fragments: Fragments, rays: Rays, count: int, texels: Texels, columns: float, rows: float,
    highest: float, settings: Settings, hits: Hits,
) -> None:  # fmt: skip
    """The first intersections; a ray without one that ends on the polygon hits the polygon itself.

    linear_index and hit_index are those of the first lattice points at or behind the hit, so that figures compare;
    height_before is the map one linear step before the hit.
    """
    steps = np.float64(settings.linear_steps)
    end = settings.linear_steps << settings.binary_steps
    for i in range(count):
        if rays.h[i] > 1.0:
            continue
        u, v, h, du, dv, dh = rays.u[i], rays.v[i], rays.h[i], rays.du[i], rays.dv[i], rays.dh[i]
        t0, t1 = 0.0, 1.0
        if settings.bounded:
            t0, t1 = clip_unit(u, du, t0, t1)
            t0, t1 = clip_unit(v, dv, t0, t1)
        t = intersect(repeat, texels, columns, rows, highest, u, v, h, du, dv, dh, t0, t1)
        if t < 1.0:  # at t = 1 it would hit the face itself, as a search that stops at k = K
            hits.linear_index[i] = np.int32(min(np.ceil(t * steps), steps))
            hits.hit_index[i] = np.int32(min(np.ceil(t * end), end - 1.0))
            hits.u[i], hits.v[i], hits.h[i] = u + du * t, v + dv * t, h + dh * t
            before = t - 1.0 / steps
            if before >= t0:
                hits.height_before[i] = fetch(texels, columns, rows, repeat, u + du * before, v + dv * before)
        elif over_polygon(fragments.patch[0, i], fragments.patch[1, i], fragments.patch[2, i]):
            hits.hit_index[i] = end
            hits.u[i], hits.v[i], hits.h[i] = u + du, v + dv, 0.0
