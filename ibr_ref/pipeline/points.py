"""Point rasterization: square and round splats of constant depth, through the depth test, in submission order.

A splat of width w at the window position c, rounded to 1/256 pixel, covers the pixels whose centres lie in
[c - w/2, c + w/2) on both axes; a disc, of these, those with dx^2 + dy^2 <= w^2/4. The width is not rounded.

The splats are sorted into bands of rows, keeping their order; a band belongs to one thread, which draws its splats one
after another: one writer per pixel, no locks, and the winner is that of drawing in order for any number of threads.

Arrays: x, y, width, height, depths, left, right, top, stop: (N,), one a splat, or those of a part of the list; members and
starts as in `Shares`, members of one band alone where a band is drawn; the buffers splat, depth, overdraw and second as in
`Target`. Rows and columns are those of the buffers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices, Ints
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.bands import stride_of
from ibr_ref.pipeline.memory import arrays
from ibr_ref.pipeline.merge import passes
from ibr_ref.pipeline.sampling import clamped
from ibr_ref.pipeline.triangles import SUBPIXELS

_BAND_SHIFT = np.uint32(3)
BAND_ROWS = 8
"""Rows of a band: the buffers of one, of a common picture, fit into the L2 cache."""

_SUBPIXELS = float(SUBPIXELS)
_PARTS = 32  # into which a list of splats is cut, to be sorted by all threads


class Splats(NamedTuple):
    """What is drawn, one row a splat."""

    x: NDArray[np.float64]
    """(N,) window x of the centres; NaN: not drawn."""
    y: NDArray[np.float64]
    """(N,) window y."""
    depth: NDArray[np.float64]
    """(N,) window depth, <= 1."""
    width: NDArray[np.float64]
    """(N,) pixels, >= 0."""


class Spans(NamedTuple):
    """The pixels [left, right) x [top, stop) of each splat's square, (N,) each."""

    left: NDArray[np.int32]
    right: NDArray[np.int32]
    top: NDArray[np.int32]
    stop: NDArray[np.int32]


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
    top: int
    """The row of the picture that the buffers begin with."""


def target_for(width: int, height: int, keep: bool, top: int = 0) -> Target:
    """Cleared buffers for `height` rows of a picture from `top` on; with `keep` those of the stages too."""
    picture, noted = (height, width), (height if keep else 0, width)
    splat, depth = arrays([(np.int32, picture), (np.float64, picture)])
    overdraw, second = arrays([(np.int32, noted), (np.float64, noted)])
    target = Target(splat, depth, overdraw, second, top)
    target.splat.fill(-1)
    target.depth.fill(1.0)
    target.overdraw.fill(0)
    target.second.fill(np.inf)
    return target


@device
def snapped(x: float) -> float:
    """To the nearest 1/256 pixel, ties to even."""
    return np.rint(x * _SUBPIXELS) / _SUBPIXELS


@device
def span(center: float, width: float, begin: float, size: float) -> tuple[np.int32, np.int32]:
    """The pixels [first, stop) whose centres lie in [center - width/2, center + width/2), counted from `begin`.

    Of `size` pixels from there on. Clamped as floats, as int(nan) is INT_MIN; NaN covers nothing.
    """
    first = np.ceil(center - width / 2.0 - 0.5) - begin
    stop = np.ceil(center + width / 2.0 - 0.5) - begin
    return np.int32(clamped(first, 0.0, size)), np.int32(clamped(stop, 0.0, size))


@device
def _fill_spans(center: Floats, width: Floats, begin: float, size: float, low: Indices, high: Indices) -> None:
    """What splats cover along one axis; whole arrays, few of them and no branches, so that LLVM turns it into SIMD."""
    for i in range(len(center)):
        low[i], high[i] = span(snapped(center[i]), width[i], begin, size)


@device
def _bands(left: int, right: int, top: int, stop: int) -> tuple[np.uint32, np.uint32]:
    """The bands [first, stop) that a splat covers anything in, none of them negative."""
    first = np.uint32(top) >> _BAND_SHIFT
    empty = (left >= right) | (top >= stop)
    return first, first if empty else (np.uint32(stop - np.int32(1)) >> _BAND_SHIFT) + np.uint32(1)


@device
def _set_up_part(
    x: Floats, y: Floats, width: Floats, height: Floats, begin: float, columns: float, rows: float, left: Indices,
    right: Indices, top: Indices, stop: Indices, counts: Ints,
) -> None:  # fmt: skip
    """Spans of a part of the list, and its counts (bands,)."""
    _fill_spans(x, width, 0.0, columns, left, right)
    _fill_spans(y, height, begin, rows, top, stop)
    for i in range(len(x)):
        band, end = _bands(left[i], right[i], top[i], stop[i])
        while band < end:
            counts[band] += 1
            band += np.uint32(1)


@kernel
def _set_up(
    x: Floats, y: Floats, width: Floats, height: Floats, begin: float, columns: float, rows: float, spans: Spans,
    counts: Ints,
) -> None:  # fmt: skip
    """What each splat covers, and how many of each part of the list each band has a share in: counts (parts, bands)."""
    left, right, top, stop = spans
    parts = len(counts)
    chunk = (len(width) + parts - 1) // parts
    for part in prange(parts):
        first, last = min(len(width), part * chunk), min(len(width), (part + 1) * chunk)
        _set_up_part(
            x[first:last], y[first:last], width[first:last], height[first:last], begin, columns, rows,
            left[first:last], right[first:last], top[first:last], stop[first:last], counts[part],
        )  # fmt: skip


@device
def _sort_part(
    left: Indices, right: Indices, top: Indices, stop: Indices, first: int, last: int, ends: Ints, members: Indices
) -> None:
    """Members of the splats [first, last); ends (bands,): where this part's next one goes in each band."""
    for i in range(first, last):
        band, end = _bands(left[i], right[i], top[i], stop[i])
        while band < end:
            members[ends[band]] = i
            ends[band] += 1
            band += np.uint32(1)


@kernel
def _sort(spans: Spans, ends: Ints, members: Indices) -> None:
    """Members of each band, in order; `ends` (parts, bands): where each part's share starts, moved to its end."""
    left, right, top, stop = spans
    parts = len(ends)
    chunk = (len(left) + parts - 1) // parts
    for part in prange(parts):
        first, last = min(len(left), part * chunk), min(len(left), (part + 1) * chunk)
        _sort_part(left, right, top, stop, first, last, ends[part], members)


@device
def _test(
    row: int | np.uint32, column: int | np.uint32, z: float, index: np.int32, splat: Indices, depth: Floats
) -> None:
    """Depth test and write, without a branch: about every second one passes, which no processor can predict."""
    stored = depth[row, column]
    nearer = passes(z, stored)
    depth[row, column] = z if nearer else stored
    splat[row, column] = index if nearer else splat[row, column]


@device
def _draw_squares(
    spans: Spans, depths: Floats, members: Indices, first_row: int, last_row: int, base: int, splat: Indices,
    depth: Floats,
) -> None:  # fmt: skip
    """Draw the squares of a band, in order, into its rows [first_row, last_row).

    Those of up to 2 x 2 pixels, the usual ones, are tested at their four corners, some of which may be the same pixel:
    a second test of it fails.
    """
    left, right, top, stop = spans
    for member in members:
        i = np.uint32(member)  # unsigned: an index that might be negative costs a comparison each time
        z, index = depths[i], np.int32(base + member)
        first_column, last_column = np.uint32(left[i]), np.uint32(right[i] - 1)
        upper, lower = np.uint32(max(top[i], first_row)), np.uint32(min(stop[i], last_row) - 1)
        if last_column - first_column < 2 and lower - upper < 2:
            _test(upper, first_column, z, index, splat, depth)
            _test(upper, last_column, z, index, splat, depth)
            _test(lower, first_column, z, index, splat, depth)
            _test(lower, last_column, z, index, splat, depth)
        else:
            for row in range(upper, lower + np.uint32(1)):
                for column in range(first_column, last_column + np.uint32(1)):
                    _test(row, column, z, index, splat, depth)


@device
def covers(disc: bool, column: int, row: int, x: float, y: float, width: float) -> bool:
    """Whether a disc covers a pixel of its square; a square covers them all."""
    dx, dy = column + 0.5 - x, row + 0.5 - y
    return (not disc) | (dx * dx + dy * dy <= width * width / 4.0)


@device
def _draw_discs(
    splats: Splats, spans: Spans, members: Indices, first_row: int, last_row: int, base: int, begin: int,
    splat: Indices, depth: Floats,
) -> None:  # fmt: skip
    """Draw the discs of a band, in order, into its rows [first_row, last_row)."""
    xs, ys, depths, widths = splats
    for i in members:
        x, y, width, z = snapped(xs[i]), snapped(ys[i]), widths[i], depths[i]
        for row in range(max(spans.top[i], first_row), min(spans.stop[i], last_row)):
            for column in range(spans.left[i], spans.right[i]):
                if covers(True, column, row + begin, x, y, width):
                    _test(row, column, z, np.int32(base + i), splat, depth)


@device
def _note_band(
    splats: Splats, spans: Spans, members: Indices, disc: bool, first_row: int, last_row: int, begin: int,
    depth: Floats, overdraw: Indices, second: Floats,
) -> None:  # fmt: skip
    """Before a band is drawn, note for the stages how many of its members cover each pixel, and the second-nearest of all.

    `depth` (last_row - first_row, W) holds the nearest so far, a copy of the buffer's rows.
    """
    xs, ys, depths, widths = splats
    for i in members:
        x, y, width, z = snapped(xs[i]), snapped(ys[i]), widths[i], depths[i]
        for row in range(max(spans.top[i], first_row), min(spans.stop[i], last_row)):
            for column in range(spans.left[i], spans.right[i]):
                if covers(disc, column, row + begin, x, y, width):
                    nearest = depth[row - first_row, column]
                    if overdraw[row, column] > 0:
                        second[row, column] = min(second[row, column], max(z, nearest))
                    overdraw[row, column] += 1
                    depth[row - first_row, column] = min(z, nearest)


@device
def _draw_band(
    splats: Splats, spans: Spans, members: Indices, disc: bool, first_row: int, base: int, target: Target
) -> None:
    """Note, if the stages are kept, and draw the rows of a band from first_row on."""
    last_row = min(target.splat.shape[0], first_row + BAND_ROWS)
    if len(target.overdraw) > 0:
        nearest = target.depth[first_row:last_row].copy()
        _note_band(
            splats, spans, members, disc, first_row, last_row, target.top, nearest, target.overdraw, target.second
        )
    if disc:
        _draw_discs(splats, spans, members, first_row, last_row, base, target.top, target.splat, target.depth)
    else:
        _draw_squares(spans, splats.depth, members, first_row, last_row, base, target.splat, target.depth)


@kernel
def _draw(splats: Splats, spans: Spans, members: Indices, starts: Ints, disc: bool, base: int, target: Target) -> None:
    """All bands, in an order that gives every thread an even sample of the picture."""
    bands = len(starts) - 1
    stride = stride_of(bands)
    for turn in prange(bands):
        band = (turn * stride) % bands
        _draw_band(splats, spans, members[starts[band] : starts[band + 1]], disc, band * BAND_ROWS, base, target)


class Shares(NamedTuple):
    """What splats cover, and which of them each band of rows has to draw."""

    spans: Spans
    members: NDArray[np.int32]
    """Indices of splats: band by band, in each in submission order."""
    starts: NDArray[np.int64]
    """(bands + 1,) where each band's members start."""


def share_out(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    width: NDArray[np.float64],
    height: NDArray[np.float64],
    columns: int,
    rows: int,
    begin: int,
) -> Shares:
    """Sort boxes (N,) around window positions, which are snapped, into the bands of columns x rows pixels.

    begin: the row of the picture that the first of these is; spans are counted from it.
    """
    bands = -(-rows // BAND_ROWS)
    spans = Spans(*arrays([(np.int32, (len(x),))] * 4))
    counts = np.zeros((_PARTS, bands), np.int64)
    _set_up(x, y, width, height, float(begin), float(columns), float(rows), spans, counts)
    ends = np.cumsum(counts.T).reshape(bands, _PARTS).T  # band by band, in each the parts in order
    starts = np.append(ends[0] - counts[0], ends[-1, -1])
    (members,) = arrays([(np.int32, (int(starts[-1]),))])
    _sort(spans, np.ascontiguousarray(ends - counts), members)
    return Shares(spans, members, starts)


def draw_splats(splats: Splats, disc: bool, base: int, target: Target) -> None:
    """Draw splats into `target`, over what has been drawn before; the first of them has the index `base` there."""
    rows, columns = target.splat.shape
    spans, members, starts = share_out(splats.x, splats.y, splats.width, splats.width, columns, rows, target.top)
    _draw(splats, spans, members, starts, disc, base, target)
