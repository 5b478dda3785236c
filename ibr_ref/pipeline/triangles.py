"""Triangle rasterization: window coordinates snapped to 1/256 pixel, exact integer edge functions, top-left rule.

A triangle covers, in each row of pixel centres, one run of columns; its ends come from floor divisions of the edge
functions, so that no pixel is tested that is not covered. Varyings are perspective-correct: with the edge functions
E_i as weights, (sum E_i a_i / w_i) / (sum E_i / w_i) at the pixel centre; depth is linear in window space.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Ints, Whole
from ibr_ref.jit import device, routine
from ibr_ref.pipeline.clip import ClippedTriangles

SUBPIXELS = 256

FEW_COLUMNS = 8
"""So many are tried one by one: a division takes as long."""


class Triangles(NamedTuple):
    """Triangles ready for rasterization; everything (T, 3) per corner unless said otherwise."""

    x: NDArray[np.int64]
    """Snapped window x, in 1/256 pixel."""
    y: NDArray[np.int64]
    """Snapped window y, in 1/256 pixel, downwards."""
    z: NDArray[np.float64]
    """Window depth in [0, 1]."""
    w: NDArray[np.float64]
    """Clip w, > 0."""
    varyings: NDArray[np.float64]
    """(T, 3, K)."""
    source: NDArray[np.int32]
    """(T,) index of the triangle before clipping."""
    rows: NDArray[np.int64]
    """(T, 2) first row of pixel centres, and one past the last, inside the picture; (0, 0): covers nothing."""


Corners = Ints | tuple[int, int, int]
"""(3,): a coordinate of a triangle's corners, snapped, in 1/256 pixel."""


class Edges(NamedTuple):
    """Edge functions of one triangle in a row: values at column 0, steps from column to column, least value inside."""

    e0: int
    e1: int
    e2: int
    step0: int
    step1: int
    step2: int
    least0: int
    least1: int
    least2: int


@device
def _window_x(x: float, w: float, width: float) -> float:
    """Of clip x, in pixels."""
    return (x / w + 1.0) / 2.0 * width


@device
def _window_y(y: float, w: float, height: float) -> float:
    """Of clip y, in pixels, downwards."""
    return (1.0 - y / w) / 2.0 * height


@device
def _area(xs: Corners, ys: Corners) -> int:
    """Twice the signed area in 1/256 pixel, positive where the corners run clockwise on the screen (y down)."""
    return (xs[1] - xs[0]) * (ys[2] - ys[0]) - (ys[1] - ys[0]) * (xs[2] - xs[0])


@routine
def _set_up(clip: Floats, width: float, height: float, x: Ints, y: Ints, z: Floats, w: Floats, rows: Ints) -> None:
    """clip (T, 3, 4); the others are filled, as in `Triangles`."""
    for triangle in range(len(clip)):
        for corner in range(3):
            p = clip[triangle, corner]
            x[triangle, corner] = np.int64(np.rint(_window_x(p[0], p[3], width) * SUBPIXELS))
            y[triangle, corner] = np.int64(np.rint(_window_y(p[1], p[3], height) * SUBPIXELS))
            z[triangle, corner] = p[2] / p[3]
            w[triangle, corner] = p[3]
        low = min(y[triangle, 0], y[triangle, 1], y[triangle, 2])
        high = max(y[triangle, 0], y[triangle, 1], y[triangle, 2])
        half = SUBPIXELS // 2
        first = max(0, (low - half + SUBPIXELS - 1) // SUBPIXELS)  # the first centre at or below the upper end
        stop = min(np.int64(height), (high - half) // SUBPIXELS + 1)
        empty = first >= stop or _area(x[triangle], y[triangle]) == 0
        rows[triangle, 0] = 0 if empty else first
        rows[triangle, 1] = 0 if empty else stop


def set_up(clipped: ClippedTriangles, width: int, height: int) -> Triangles:
    """Window coordinates of clipped triangles for a picture of `width` x `height` pixels."""
    count = len(clipped.source)
    x, y = np.empty((2, count, 3), np.int64)
    z, w = np.empty((2, count, 3))
    rows = np.empty((count, 2), np.int64)
    _set_up(clipped.clip, float(width), float(height), x, y, z, w, rows)
    return Triangles(x, y, z, w, clipped.varyings, clipped.source, rows)


def shifted(triangles: Triangles, first: int, stop: int) -> Triangles:
    """The same triangles for the rows [first, stop) of the picture alone, counted from `first`.

    Whole pixels change no edge function at a pixel's centre: what is drawn has the bits of the whole picture.
    """
    rows = np.clip(triangles.rows, first, stop) - first
    return triangles._replace(y=triangles.y - first * SUBPIXELS, rows=np.ascontiguousarray(rows))


@device
def _edge(ax: int, ay: int, bx: int, by: int, sign: int, py: int) -> tuple[int, int, int]:
    """Edge a -> b at column 0 of the row of centres py: value, step a column, least value that is inside."""
    dx = (bx - ax) * sign
    dy = (by - ay) * sign
    value = dx * (py - ay) - dy * (SUBPIXELS // 2 - ax)
    top_left = dy < 0 or (dy == 0 and dx > 0)
    return value, -dy * SUBPIXELS, 0 if top_left else 1


@device
def edges_in_row(xs: Corners, ys: Corners, row: int) -> Edges:
    """The three edge functions of a triangle along a row of pixel centres; positive inside for both orientations."""
    py = row * SUBPIXELS + SUBPIXELS // 2
    sign = 1 if _area(xs, ys) > 0 else -1
    e0, step0, least0 = _edge(xs[1], ys[1], xs[2], ys[2], sign, py)
    e1, step1, least1 = _edge(xs[2], ys[2], xs[0], ys[0], sign, py)
    e2, step2, least2 = _edge(xs[0], ys[0], xs[1], ys[1], sign, py)
    return Edges(e0, e1, e2, step0, step1, step2, least0, least1, least2)


@device
def fall_of(xs: Corners, ys: Corners) -> tuple[int, int, int]:
    """By how much the edge functions are larger in the next row."""
    here, below = edges_in_row(xs, ys, 0), edges_in_row(xs, ys, 1)
    return below.e0 - here.e0, below.e1 - here.e1, below.e2 - here.e2


@device
def moved_down(edges: Edges, fall: tuple[int, int, int]) -> Edges:
    """The edge functions in the next row."""
    return Edges(
        edges.e0 + fall[0],
        edges.e1 + fall[1],
        edges.e2 + fall[2],
        edges.step0,
        edges.step1,
        edges.step2,
        edges.least0,
        edges.least1,
        edges.least2,
    )


@device
def columns_of(xs: Corners, width: int) -> tuple[Whole, Whole]:
    """The columns [first, stop) of the picture whose centres lie between the corners: a triangle covers no other."""
    low, high, half = min(xs[0], xs[1], xs[2]), max(xs[0], xs[1], xs[2]), SUBPIXELS // 2
    first = max(np.int64(0), (low - half + SUBPIXELS - 1) // SUBPIXELS)
    return first, min(np.int64(width), (high - half) // SUBPIXELS + 1)


@device
def _narrow(value: int, step: int, least: int, first: Whole, stop: Whole) -> tuple[int, int]:
    """The columns of [first, stop) where value + column * step >= least."""
    if stop - first <= FEW_COLUMNS:
        while first < stop and value + step * first < least:
            first += 1
        while first < stop and value + step * (stop - 1) < least:
            stop -= 1
        return first, stop
    if step > 0:
        return max(first, -((value - least) // step)), stop
    if step < 0:
        return first, min(stop, (value - least) // -step + 1)
    return (first, stop) if value >= least else (first, first)


@device
def columns_in_row(edges: Edges, width: int) -> tuple[int, int]:
    """The columns [first, stop) of the picture that the triangle covers in this row."""
    return columns_within(edges, np.int64(0), np.int64(width))


@device
def columns_within(edges: Edges, first: Whole, stop: Whole) -> tuple[int, int]:
    """Those of [first, stop)."""
    first, stop = _narrow(edges.e0, edges.step0, edges.least0, first, stop)
    first, stop = _narrow(edges.e1, edges.step1, edges.least1, first, stop)
    first, stop = _narrow(edges.e2, edges.step2, edges.least2, first, stop)
    return first, max(first, stop)


@device
def _unit(a: float) -> bool:
    return a == 0.0 or a == 1.0


@device
def fill_varyings(edges: Edges, first: int, stop: int, corners: Floats, w: Floats, out: Floats, start: int) -> None:
    """Perspective-correct varyings with the values `corners` (3, K), for the columns [first, stop), into out[:, start:].

    A varying that is the same at all corners and 0 or 1 is so exactly, by the same formula: it needs no division. Where the
    corners have 0 and 1, E a / w is (E / w) a exactly: that needs fewer. w (3,), out (K, F).
    """
    w0, w1, w2 = w[0], w[1], w[2]
    for k in range(corners.shape[1]):
        a0, a1, a2 = corners[0, k], corners[1, k], corners[2, k]
        if a0 == a1 and a1 == a2 and (a0 == 0.0 or a0 == 1.0):
            for i in range(start, start + stop - first):
                out[k, i] = a0
            continue
        if _unit(a0) and _unit(a1) and _unit(a2):
            for i in range(stop - first):
                column = first + i
                q0 = np.float64(edges.e0 + edges.step0 * column) / w0
                q1 = np.float64(edges.e1 + edges.step1 * column) / w1
                q2 = np.float64(edges.e2 + edges.step2 * column) / w2
                out[k, start + i] = (q0 * a0 + q1 * a1 + q2 * a2) / (q0 + q1 + q2)
            continue
        for i in range(stop - first):
            column = first + i
            e0 = np.float64(edges.e0 + edges.step0 * column)
            e1 = np.float64(edges.e1 + edges.step1 * column)
            e2 = np.float64(edges.e2 + edges.step2 * column)
            over_w = e0 / w0 + e1 / w1 + e2 / w2
            out[k, start + i] = (e0 * a0 / w0 + e1 * a1 / w1 + e2 * a2 / w2) / over_w


@device
def fill_depth(edges: Edges, first: int, stop: int, z: Floats, out: Floats, out_first: int) -> None:
    """Write the window depth, z (3,) at the corners, for the columns [first, stop) to out (F,), from out_first on."""
    z0, z1, z2 = z[0], z[1], z[2]
    total = np.float64(edges.e0 + edges.e1 + edges.e2)
    for i in range(stop - first):
        column = first + i
        e0 = np.float64(edges.e0 + edges.step0 * column)
        e1 = np.float64(edges.e1 + edges.step1 * column)
        e2 = np.float64(edges.e2 + edges.step2 * column)
        out[out_first + i] = e0 / total * z0 + e1 / total * z1 + e2 / total * z2
