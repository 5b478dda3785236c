"""Point rasterization: square and round splats of constant depth, through the depth test, in submission order.

A splat of width w at the window position c, rounded to 1/256 pixel, covers the pixels whose centres lie in
[c - w/2, c + w/2) on both axes; a disc, of these, those with dx^2 + dy^2 <= w^2/4. The width is not rounded.

The splats are sorted into bands of rows, keeping their order; a band belongs to one thread, which draws its splats one
after another: one writer per pixel, no locks, and the winner is that of drawing in order for any number of threads.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.merge import passes
from ibr_ref.pipeline.sampling import clamped

BAND_ROWS = 8
"""Rows of a band: the buffers of one, of a common picture, fit into the L2 cache."""

_SUBPIXELS = 256.0
_PARTS = 32  # into which a list of splats is cut, to be sorted by all threads


class Splats(NamedTuple):
    """What is drawn, one row a splat."""

    window: NDArray[np.float64]
    """(N, 2) window x and y of the centres; NaN: not drawn."""
    depth: NDArray[np.float64]
    """(N,) window depth, <= 1."""
    width: NDArray[np.float64]
    """(N,) pixels, >= 0."""


class Target(NamedTuple):
    """The buffers that are drawn into; those that only the stages need have no rows where these are not kept."""

    splat: NDArray[np.int32]
    """(H, W) index of the winner; -1 none."""
    depth: NDArray[np.float64]
    """(H, W) its window depth; 1 where none is."""
    overdraw: NDArray[np.int32]
    """(H, W) or (0, W): all splats that cover the pixel."""
    second: NDArray[np.float64]
    """(H, W) or (0, W): second-smallest depth of those; infinite with fewer than two."""


def target_for(width: int, height: int, keep: bool) -> Target:
    """Cleared buffers; with `keep` those of the stages too."""
    return Target(
        splat=np.full((height, width), -1, np.int32),
        depth=np.ones((height, width)),
        overdraw=np.zeros((height if keep else 0, width), np.int32),
        second=np.full((height if keep else 0, width), np.inf),
    )


@device
def snapped(x):
    """To the nearest 1/256 pixel, ties to even."""
    return np.rint(x * _SUBPIXELS) / _SUBPIXELS


@device
def span(center, width, size):
    """The pixels [first, stop) of an axis of `size` pixels whose centres lie in [center - width/2, center + width/2).

    Clamped as floats, as int(nan) is INT_MIN; NaN covers nothing.
    """
    first = np.ceil(center - width / 2.0 - 0.5)
    stop = np.ceil(center + width / 2.0 - 0.5)
    return np.int64(clamped(first, 0.0, size)), np.int64(clamped(stop, 0.0, size))


@device
def _rows(splats, i, columns, rows):
    """The rows [first, stop) that a splat covers anything in."""
    width = splats.width[i]
    first, stop = span(snapped(splats.window[i, 0]), width, columns)
    if first >= stop:
        return np.int64(0), np.int64(0)
    return span(snapped(splats.window[i, 1]), width, rows)


@device
def _count_part(splats, first, last, columns, rows, counts):
    for i in range(first, last):
        top, stop = _rows(splats, i, columns, rows)
        if top < stop:
            for band in range(top // BAND_ROWS, (stop - 1) // BAND_ROWS + 1):
                counts[band] += 1


@kernel
def _count(splats, columns, rows, counts):
    """Splats of each part of the list that each band has a share in: counts (parts, bands)."""
    parts = len(counts)
    chunk = (len(splats.depth) + parts - 1) // parts
    for part in prange(parts):
        last = min(len(splats.depth), (part + 1) * chunk)
        _count_part(splats, part * chunk, last, columns, rows, counts[part])


@device
def _sort_part(splats, first, last, columns, rows, ends, members):
    for i in range(first, last):
        top, stop = _rows(splats, i, columns, rows)
        if top < stop:
            for band in range(top // BAND_ROWS, (stop - 1) // BAND_ROWS + 1):
                members[ends[band]] = i
                ends[band] += 1


@kernel
def _sort(splats, columns, rows, ends, members):
    """Members of each band, in order; `ends` (parts, bands): where each part's share starts, moved to its end."""
    parts = len(ends)
    chunk = (len(splats.depth) + parts - 1) // parts
    for part in prange(parts):
        last = min(len(splats.depth), (part + 1) * chunk)
        _sort_part(splats, part * chunk, last, columns, rows, ends[part], members)


@device
def _draw_pixel(target, row, column, splat, depth):
    """Depth test of one splat on one pixel, and what the stages note of it."""
    if len(target.overdraw) > 0:
        if target.overdraw[row, column] > 0:
            behind = max(depth, target.depth[row, column])
            target.second[row, column] = min(target.second[row, column], behind)
        target.overdraw[row, column] += 1
    if passes(depth, target.depth[row, column]):
        target.depth[row, column] = depth
        target.splat[row, column] = splat


@device
def _draw_splat(splats, i, disc, first_row, last_row, base, target):
    """Draw one splat into the rows [first_row, last_row) of the picture."""
    x, y, width, depth = snapped(splats.window[i, 0]), snapped(splats.window[i, 1]), splats.width[i], splats.depth[i]
    left, right = span(x, width, np.float64(target.splat.shape[1]))
    top, stop = span(y, width, np.float64(target.splat.shape[0]))
    splat = np.int32(base + i)
    for row in range(max(top, first_row), min(stop, last_row)):
        dy = row + 0.5 - y
        for column in range(left, right):
            dx = column + 0.5 - x
            if not disc or dx * dx + dy * dy <= width * width / 4.0:
                _draw_pixel(target, row, column, splat, depth)


@device
def _draw_band(splats, members, disc, first_row, last_row, base, target):
    for member in range(len(members)):
        _draw_splat(splats, members[member], disc, first_row, last_row, base, target)


@kernel
def _draw(splats, members, starts, disc, base, target):
    """All bands, in an order that gives every thread an even sample of the picture."""
    bands = len(starts) - 1
    stride = max(1, int(bands * 0.618))
    while np.gcd(stride, bands) != 1:
        stride += 1
    for turn in prange(bands):
        band = (turn * stride) % bands
        last_row = min(target.splat.shape[0], (band + 1) * BAND_ROWS)
        _draw_band(splats, members[starts[band] : starts[band + 1]], disc, band * BAND_ROWS, last_row, base, target)


def draw_splats(splats: Splats, disc: bool, base: int, target: Target) -> None:
    """Draw splats into `target`, over what has been drawn before; the first of them has the index `base` there."""
    rows, columns = target.splat.shape
    bands = -(-rows // BAND_ROWS)
    counts = np.zeros((_PARTS, bands), np.int64)
    _count(splats, float(columns), float(rows), counts)
    ends = np.cumsum(counts.T).reshape(bands, _PARTS).T  # band by band, in each the parts in order
    starts = np.append(ends[0] - counts[0], ends[-1, -1])
    members = np.empty(int(starts[-1]), np.int32)
    _sort(splats, float(columns), float(rows), np.ascontiguousarray(ends - counts), members)
    _draw(splats, members, starts, disc, base, target)
