"""Meshes with a depth buffer: which triangle each pixel shows, its depth, and varyings there; or their silhouette alone.

For passes without discard or depth changes in the fragment stage. Triangles are sorted into bands of rows; a band
belongs to one thread, which draws its triangles in submission order, so that ties go to the earlier one.

Arrays: rows (T, 2) as in `Triangles`; counts, ends (bands,); members, indices of triangles band by band, and starts
(bands + 1,), or the members of one band; winner and depth (H, W) as in `Visible`; spare: a row's numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes, Floats, Indices, Ints
from ibr_ref.jit import device, kernel, prange, routine
from ibr_ref.pipeline.bands import stride_of
from ibr_ref.pipeline.merge import passes
from ibr_ref.pipeline.triangles import (
    Triangles,
    columns_of,
    columns_within,
    edges_in_row,
    fall_of,
    fill_depth,
    fill_varyings,
    moved_down,
)

BAND_ROWS = 16


class Visible(NamedTuple):
    """What a picture shows of a list of triangles."""

    triangle: NDArray[np.int32]
    """(H, W) index into the rasterized (clipped) triangles; -1 none."""
    depth: NDArray[np.float64]
    """(H, W) window depth; 1 where nothing is."""


@routine
def _count_in_bands(rows: Ints, counts: Ints) -> None:
    """How many triangles each band has a share in."""
    for t in range(len(rows)):
        if rows[t, 1] > rows[t, 0]:
            for band in range(rows[t, 0] // BAND_ROWS, (rows[t, 1] - 1) // BAND_ROWS + 1):
                counts[band] += 1


@routine
def _sort_into_bands(rows: Ints, ends: Ints, members: Indices) -> None:
    """Triangles of each band in submission order; `ends` holds the band's start and is moved to its end."""
    for t in range(len(rows)):
        if rows[t, 1] > rows[t, 0]:
            for band in range(rows[t, 0] // BAND_ROWS, (rows[t, 1] - 1) // BAND_ROWS + 1):
                members[ends[band]] = t
                ends[band] += 1


def _bands(triangles: Triangles, height: int) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Triangles of all bands, each band's in submission order, and where each band's begin and the last one's end."""
    counts = np.zeros(-(-height // BAND_ROWS), np.int64)
    _count_in_bands(triangles.rows, counts)
    starts = np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)])
    members = np.empty(int(starts[-1]), np.int32)
    _sort_into_bands(triangles.rows, starts[:-1].copy(), members)
    return members, starts


@device
def _draw_triangle(
    triangles: Triangles, t: int, first_row: int, last_row: int, spare: Floats, winner: Indices, depth: Floats
) -> None:
    """Depth-test one triangle in the rows [first_row, last_row) of the picture."""
    xs, ys, from_row = triangles.x[t], triangles.y[t], max(first_row, triangles.rows[t, 0])
    low, high = columns_of(xs, winner.shape[1])
    edges, fall = edges_in_row(xs, ys, from_row), fall_of(xs, ys)
    for row in range(from_row, min(last_row, triangles.rows[t, 1])):
        first, stop = columns_within(edges, low, high)
        fill_depth(edges, first, stop, triangles.z[t], spare, 0)
        for column in range(first, stop):
            if passes(spare[column - first], depth[row, column]):
                depth[row, column] = spare[column - first]
                winner[row, column] = t
        edges = moved_down(edges, fall)


@device
def _draw_band(
    triangles: Triangles, members: Indices, first_row: int, last_row: int, winner: Indices, depth: Floats
) -> None:
    """Clear the rows [first_row, last_row) and draw a band's triangles there."""
    spare = np.empty(winner.shape[1])
    for row in range(first_row, last_row):
        for column in range(winner.shape[1]):
            winner[row, column] = -1
            depth[row, column] = 1.0
    for i in range(len(members)):
        _draw_triangle(triangles, members[i], first_row, last_row, spare, winner, depth)


@kernel
def _draw(triangles: Triangles, members: Indices, starts: Ints, winner: Indices, depth: Floats) -> None:
    """All bands."""
    bands = len(starts) - 1
    stride = stride_of(bands)
    for turn in prange(bands):
        band = turn * stride % bands
        first_row = band * BAND_ROWS
        last_row = min(winner.shape[0], first_row + BAND_ROWS)
        _draw_band(triangles, members[starts[band] : starts[band + 1]], first_row, last_row, winner, depth)


def visible(triangles: Triangles, width: int, height: int) -> Visible:
    """Rasterize triangles with the depth test LESS against a buffer cleared to 1."""
    members, starts = _bands(triangles, height)
    result = Visible(np.empty((height, width), np.int32), np.empty((height, width)))
    _draw(triangles, members, starts, *result)
    return result


@device
def _cover_band(triangles: Triangles, members: Indices, first_row: int, last_row: int, out: Bytes) -> None:
    """Out (H, W) in the rows [first_row, last_row): 1 where a triangle of the band covers the pixel."""
    for row in range(first_row, last_row):
        for column in range(out.shape[1]):
            out[row, column] = 0
    x, y, rows = triangles.x, triangles.y, triangles.rows  # taken out in the loop, each is counted: atomic operations
    for i in range(len(members)):
        t = members[i]
        xs, ys = (x[t, 0], x[t, 1], x[t, 2]), (y[t, 0], y[t, 1], y[t, 2])
        from_row = max(first_row, rows[t, 0])
        low, high = columns_of(xs, out.shape[1])
        edges, fall = edges_in_row(xs, ys, from_row), fall_of(xs, ys)
        for row in range(from_row, min(last_row, rows[t, 1])):
            first, stop = columns_within(edges, low, high)
            for column in range(first, stop):
                out[row, column] = 1
            edges = moved_down(edges, fall)


@kernel
def _cover(triangles: Triangles, members: Indices, starts: Ints, out: Bytes) -> None:
    """All bands: out (H, W)."""
    bands = len(starts) - 1
    stride = stride_of(bands)
    for turn in prange(bands):
        band = turn * stride % bands
        first_row = band * BAND_ROWS
        last_row = min(out.shape[0], first_row + BAND_ROWS)
        _cover_band(triangles, members[starts[band] : starts[band + 1]], first_row, last_row, out)


def covered(triangles: Triangles, width: int, height: int) -> NDArray[np.uint8]:
    """(H, W) 1 where any triangle covers the pixel, else 0: no depth test, the silhouette alone."""
    members, starts = _bands(triangles, height)
    out = np.empty((height, width), np.uint8)
    _cover(triangles, members, starts, out)
    return out


@device
def _varyings_in_row(triangles: Triangles, winner: Indices, row: int, spare: Floats, out: Floats) -> None:
    """Runs of pixels that show the same triangle get their varyings together: out (H, W, K), spare (K, W)."""
    column, width = 0, winner.shape[1]
    while column < width:
        t, first = winner[row, column], column
        while column < width and winner[row, column] == t:
            column += 1
        if t >= 0:
            edges = edges_in_row(triangles.x[t], triangles.y[t], row)
            fill_varyings(edges, first, column, triangles.varyings[t], triangles.w[t], spare, 0)
        for i in range(first, column):
            for k in range(out.shape[2]):
                out[row, i, k] = spare[k, i - first] if t >= 0 else np.nan


@kernel
def _interpolate(triangles: Triangles, winner: Indices, out: Floats) -> None:
    """out (H, W, K)."""
    for row in prange(winner.shape[0]):
        _varyings_in_row(triangles, winner, row, np.empty((out.shape[2], winner.shape[1])), out)


def interpolate(triangles: Triangles, winner: NDArray[np.int32]) -> NDArray[np.float64]:
    """(H, W, K) perspective-correct varyings of the triangles that `winner` (H, W) names; NaN where it is -1."""
    out = np.empty((*winner.shape, triangles.varyings.shape[2]))
    _interpolate(triangles, winner, out)
    return out
