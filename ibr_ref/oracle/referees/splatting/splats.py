"""Stage raster in bounded numbers: which splats may win which pixels, and how many may cover them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.winners import winners
from ibr_ref.oracle.device import UNIT
from ibr_ref.oracle.referees.splatting.place import Landed
from ibr_ref.oracle.referees.splatting.spans import Axis, axis

CHUNK = 1 << 21
"""Pairs of a splat and a pixel that are looked at together: some 100 MB."""
MOST_PAIRS = 1 << 27
"""More than these are not looked at: widths far beyond the law's, which were wrong before, would take minutes."""

SETUP_QUOTIENTS, SETUP_OPERATIONS = 2.0, 5.0
"""Of a rasterizer's depth against z / w of the vertex stage: a division in either; the viewport's product and sum, and the
plane's two products and sum. All of them on numbers of at most 1."""


@dataclass(frozen=True, eq=False)
class Contest:
    """What may be seen of the splats. P pixels, n pairs of a pixel and a splat that may win it."""

    pixel: Ints
    """(n,) row * width + column."""
    splat: Ints
    """(n,) the vertex."""
    empty: Bools
    """(P,) whether it may show nothing."""
    least: Ints
    """(P,) splats that cover it, at least."""
    most: Ints
    """(P,) at the most."""
    depth: Bounded
    """(V,) as the depth buffer holds it."""
    judged: bool = True
    """False: there were too many pairs, and nothing is known."""


def buffered(depth: Bounded) -> Bounded:
    """Window depths as the depth buffer holds them, from those of the vertex stage.

    The conventions' depth buffer holds the very number, rounded to a float32; a rasterizer computes its own.
    """
    device, value = depth.device, depth.value
    if not device.subpixel_any:
        with np.errstate(invalid="ignore"):
            exactly = (depth.error == 0.0) & (value == value.astype(np.float32))
            return depth.widened(np.where(exactly, 0.0, UNIT * np.abs(value)))
    units = SETUP_QUOTIENTS * device.quotient + SETUP_OPERATIONS * device.operation
    scale = 1.0 if device.minus_one else np.abs(value)
    return depth.widened(units * UNIT * scale + device.depth_step)


def contest(points: Landed, shape: str, width: int, height: int, twins: Ints | None = None) -> Contest:
    """All splats against each other in a picture. twins: (V,) the earliest point that is drawn exactly as this one is."""
    depth = buffered(points.depth)
    drawn = np.flatnonzero(points.possible & (points.width.high > 0.0))
    across = axis(points.x[drawn], points.width[drawn], width)
    down = axis(points.y[drawn], points.width[drawn], height)
    counts = np.maximum(across.stop - across.first, 0) * np.maximum(down.stop - down.first, 0)
    least, most = np.zeros((2, width * height), np.int64)
    if int(counts.sum()) > MOST_PAIRS:
        nothing = np.empty(0, np.int64)
        return Contest(nothing, nothing, np.ones(len(least), np.bool_), least, most, depth, judged=False)
    nearest = np.full(width * height, np.inf)
    found = []
    low, high, sure = depth.low[drawn], depth.high[drawn], points.sure[drawn]
    for pairs in _pairs(across, down, counts, points.width[drawn], shape, sure):
        splat, row, column, certain = pairs
        pixel = row * width + column
        most += np.bincount(pixel, minlength=len(most))
        least += np.bincount(pixel[certain], minlength=len(least))
        blocks = certain & (high[splat] < 1.0)
        np.minimum.at(nearest, pixel[blocks], high[splat[blocks]])
        seen = (low[splat] <= nearest[pixel]) & (low[splat] < 1.0)
        found.append((pixel[seen], splat[seen], certain[seen]))
    pixel, splat, certain = (
        np.concatenate([pairs[k] for pairs in found]) if found else np.empty(0, dtype)
        for k, dtype in enumerate((np.int64, np.int64, np.bool_))
    )
    seen = low[splat] <= nearest[pixel]
    pixel, splat, certain = pixel[seen], splat[seen], certain[seen]
    result = winners(pixel, certain, low[splat], high[splat], width * height)
    wins = result.possible & ~_later(pixel, splat, certain, low, high, None if twins is None else twins[drawn])
    return Contest(pixel[wins], drawn[splat[wins]], result.empty, least, most, depth)


def _pairs(
    across: Axis, down: Axis, counts: Ints, width: Bounded, shape: str, sure: Bools
) -> Iterator[tuple[Ints, Ints, Ints, Bools]]:
    """Splat, row, column, and whether it is certainly covered, of all pairs that may be; in pieces."""
    ends = np.cumsum(counts)
    first = 0
    while first < len(counts):
        before = int(ends[first - 1]) if first else 0
        last = max(first + 1, int(np.searchsorted(ends, before + CHUNK, side="right")))
        many = counts[first:last]
        splat = np.repeat(np.arange(first, last), many)
        step = np.arange(len(splat)) - np.repeat(ends[first:last] - many - before, many)
        columns = np.maximum(across.stop - across.first, 1)[splat]
        row = down.first[splat] + step // columns
        column = across.first[splat] + step % columns
        certain = sure[splat] & _inside(across, splat, column) & _inside(down, splat, row)
        if shape == "disc":
            inner, outer = _disc(across, down, width, splat, row, column)
            splat, row, column, certain = splat[outer], row[outer], column[outer], (certain & inner)[outer]
        yield splat, row, column, certain
        first = last


def _inside(axis: Axis, splat: Ints, index: Ints) -> Bools:
    return np.asarray((index >= axis.sure_first[splat]) & (index < axis.sure_stop[splat]))


def _disc(across: Axis, down: Axis, width: Bounded, splat: Ints, row: Ints, column: Ints) -> tuple[Bools, Bools]:
    """dx^2 + dy^2 <= w^2/4: for certain, perhaps. In floats: a difference, two squares and a sum; a square and a quarter."""
    device = width.device
    (near_x, far_x), (near_y, far_y) = (
        _offsets(axis, splat, index.astype(np.float64) + 0.5) for axis, index in ((across, column), (down, row))
    )
    off = 5.0 * device.operation * UNIT  # differences count twice in squares, one rounding of squares, two of the sum
    least = np.maximum(width.low[splat] / 2.0 - device.splat_border, 0.0) ** 2 * (1.0 - 2.0 * device.operation * UNIT)
    most = (width.high[splat] / 2.0 + device.splat_border) ** 2 * (1.0 + 2.0 * device.operation * UNIT)
    inner = (far_x * far_x + far_y * far_y) * (1.0 + off) <= least
    outer = (near_x * near_x + near_y * near_y) * (1.0 - off) <= most
    return inner, outer


def _offsets(axis: Axis, splat: Ints, center: Floats) -> tuple[Floats, Floats]:
    """Least and largest distance of pixels' centres from where the splat's centre may lie."""
    low, high = axis.low[splat], axis.high[splat]
    near = np.maximum(0.0, np.maximum(low - center, center - high))
    return near, np.maximum(np.abs(center - low), np.abs(center - high))


def _later(pixel: Ints, splat: Ints, certain: Bools, low: Floats, high: Floats, twins: Ints | None) -> Bools:
    """Pairs that lose a tie which is no matter of rounding: LESS keeps the earlier of equal depths.

    Depths are equal on every device where the splats are twins, and on one that keeps the very numbers if these are equal.
    """
    exactly = low[splat] == high[splat]
    loses = np.zeros(len(pixel), np.bool_)
    if twins is not None:
        order = np.lexsort((splat, twins[splat], pixel))
        again = (np.diff(pixel[order]) == 0) & (np.diff(twins[splat[order]]) == 0)
        loses[order[1:][again]] = True
    if exactly.any():
        order = np.lexsort((splat, ~certain, low[splat], pixel))
        order = order[exactly[order]]
        same = (np.diff(pixel[order]) == 0) & (np.diff(low[splat[order]]) == 0.0)
        group = np.cumsum(np.r_[True, ~same]) - 1 if len(order) else np.empty(0, np.int64)
        leader = order[np.r_[True, ~same]] if len(order) else order
        leads = leader[group]
        loses[order[certain[leads] & (splat[leads] < splat[order])]] = True
    return loses
