"""Splats of constant depth against each other, on numbers with bounds: which may win a pixel, and how many cover it.

The program says where a splat's borders are and what the depth test lets through; rasterizing is every device's own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.borders import CROSSING
from ibr_ref.oracle.accept.winners import winners
from ibr_ref.oracle.arithmetic.number import Number, may_and_must
from ibr_ref.oracle.programs.splatting.raster import Fragments

CHUNK = 1 << 21
"""Pairs of a splat and a pixel that are looked at together: some 100 MB."""
CUTS = 2.0
"""By as many borders a corner of a square is made at the most."""
MOST_PAIRS = 1 << 27
"""More than these are not looked at: widths far beyond the law's, which were wrong before, would take minutes."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """Points on their way to the rasterizer, (V,) each."""

    window: list[Number]
    """x and y; means nothing where the point is dropped. So do depth and width."""
    depth: Number
    width: Number
    sure: Bools
    """Drawn by every legal device."""
    possible: Bools
    """Drawn by some."""
    twins: Ints | None = None
    """The earliest point that is drawn exactly as this one is; None: not known."""
    gaussian: Number | None = None
    """(V, 5) xx, xy, yy, amplitude and distance of ellipses."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """(n,) splats at pixels."""

    pixel: Ints
    """row * width + column."""
    splat: Ints
    """The vertex."""
    certain: Bools
    """Covered whatever the device does."""

    def take(self, index: Any) -> Pairs:
        """Some of them."""
        return Pairs(self.pixel[index], self.splat[index], self.certain[index])


@dataclass(frozen=True, eq=False)
class Contest:
    """What may be seen of the splats. P pixels, n pairs of a pixel and a splat that may win it."""

    pixel: Ints
    splat: Ints
    empty: Bools
    """(P,) whether it may show nothing."""
    least: Ints
    """(P,) splats that count as overdraw, at least."""
    most: Ints
    """(P,) at the most."""
    depth: Number
    """(V,) as the depth buffer holds it."""
    judged: bool = True
    """False: there were too many pairs, and nothing is known."""


def recut(program: Any, points: Drawn) -> Drawn:
    """What devices may cut at the picture's borders: a quad there has corners anew, sums p (1 - t) + q t of its own.

    They lie where they did, and the quad's depth is theirs, but for the roundings of x, y or z, and of w, at each of two
    borders, and one quotient. A piece covers pixels' centres: none is narrower than half a pixel across the border.
    """
    camera, device = program.scene.camera, points.depth.do.device
    if not device.clip_border:
        return points
    window, unit = [], (2.0 * CUTS * CROSSING * device.operation + device.quotient) * UNIT
    reaches, half = np.zeros(len(points.sure), np.bool_), 0.5 * points.width.high + 1.0
    for x, size in zip(points.window, (camera.width, camera.height), strict=True):
        reaches |= (x.low - half < 0.0) | (x.high + half > size)
    for x, size in zip(points.window, (camera.width, camera.height), strict=True):
        off = np.where(reaches, unit * (np.abs(x.value) + 0.5 * size), 0.0)
        window.append(Number(x.do, x.value, x.deviation + off))
    off = np.where(reaches, unit * np.abs(points.depth.value), 0.0)
    depth = Number(points.depth.do, points.depth.value, points.depth.deviation + off)
    return replace(points, window=window, depth=depth)


def contest(program: Any, points: Drawn) -> Contest:
    """All splats against each other in the program's picture."""
    points = recut(program, points)
    camera = program.scene.camera
    pixels, depth = camera.width * camera.height, program.stored_depth(points.depth)
    splats, spans, counts = _spanned(program, points)
    least, most = np.zeros((2, pixels), np.int64)
    if int(counts.sum()) > MOST_PAIRS:
        none = np.zeros(0, np.int64)
        return Contest(none, none, np.ones(pixels, np.bool_), least, most, depth, judged=False)
    right = program.right("passes", "counted")
    low, high, sure = depth.low, depth.high, points.sure[splats.vertex]
    nearest, found = np.full(pixels, np.inf), []
    for pairs in _covered(program, splats, spans, counts, sure):
        most += np.bincount(pairs.pixel, minlength=pixels)
        least += np.bincount(pairs.pixel[pairs.certain], minlength=pixels)
        if right:
            blocks = pairs.take(pairs.certain & (high[pairs.splat] < 1.0))
            np.minimum.at(nearest, blocks.pixel, high[blocks.splat])
            pairs = pairs.take((low[pairs.splat] <= nearest[pairs.pixel]) & (low[pairs.splat] < 1.0))
        found.append(pairs)
    fields = ([getattr(p, name) for p in found] for name in ("pixel", "splat", "certain"))
    pairs = Pairs(*(np.concatenate(parts) for parts in fields)) if found else Pairs(*np.zeros((3, 0), np.int64))
    if not right:
        return _tested(program, pairs, points.twins, depth, least, most)
    pairs = pairs.take(low[pairs.splat] <= nearest[pairs.pixel])
    result = winners(pairs.pixel, pairs.certain, low[pairs.splat], high[pairs.splat], pixels)
    wins = result.possible & ~_later(pairs, low, high, points.twins)
    return Contest(pairs.pixel[wins], pairs.splat[wins], result.empty, least, most, depth)


def covering(program: Any, points: Drawn, pixels: Ints) -> tuple[Any, Pairs]:
    """The splats that are drawn, and all pairs of one of them and a pixel that it may cover, of those asked for, growing."""
    points = recut(program, points)
    splats, spans, counts = _spanned(program, points)
    asked = np.zeros(program.scene.camera.width * program.scene.camera.height, np.bool_)
    asked[pixels] = True
    found = [
        pairs.take(asked[pairs.pixel]) for pairs in _covered(program, splats, spans, counts, points.sure[splats.vertex])
    ]
    none = Pairs(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0, np.bool_))
    fields = ([getattr(p, name) for p in (none, *found)] for name in ("pixel", "splat", "certain"))
    return splats, Pairs(*(np.concatenate(parts) for parts in fields))


def _spanned(program: Any, points: Drawn) -> tuple[Any, list[Any], Ints]:
    """The splats that may be drawn, their columns and rows (`_ends`), and how many pixels that are."""
    live = np.flatnonzero(points.possible & (points.width.high > 0.0))
    splats = program.splats(live, [c[live] for c in points.window], points.width[live], points.depth[live])
    if points.gaussian is not None:
        splats = splats._replace(gaussian=points.gaussian[splats.vertex])
    spans = [_ends(axis) for axis in program.spans(splats)]
    return splats, spans, np.prod([np.maximum(stop - first, 0) for first, stop, _, _ in spans], axis=0)


def _ends(span: tuple[Number, Number]) -> tuple[Ints, Ints, Ints, Ints]:
    """The first pixel that may be covered, the one after the last; and the same of those that certainly are."""
    first, end = (x.do.of(x) for x in span)
    found = (np.ceil(first.low), np.floor(end.high), np.floor(first.high), np.ceil(end.low))
    a, b, c, d = (np.nan_to_num(x).astype(np.int64) for x in found)
    return a, b, c, d


def _covered(program: Any, splats: Any, spans: Any, counts: Ints, sure: Bools) -> Iterator[Pairs]:
    """All pairs that may be, in pieces; earlier splats first."""
    (left, right, sure_left, sure_right), (top, _, sure_top, sure_bottom) = spans
    ends, first = np.cumsum(counts), 0
    while first < len(counts):
        before = int(ends[first - 1]) if first else 0
        last = max(first + 1, int(np.searchsorted(ends, before + CHUNK, side="right")))
        many = counts[first:last]
        splat = np.repeat(np.arange(first, last), many)
        step = np.arange(len(splat)) - np.repeat(ends[first:last] - many - before, many)
        columns = np.maximum(right - left, 1)[splat]
        row, column = top[splat] + step // columns, left[splat] + step % columns
        certain = sure[splat] & (column >= sure_left[splat]) & (column < sure_right[splat])
        certain &= (row >= sure_top[splat]) & (row < sure_bottom[splat])
        if program.params.shape != "square":
            may, must = may_and_must(program.inside(splats, Fragments(splat, row, column)))
            certain &= must
            splat, row, column, certain = splat[may], row[may], column[may], certain[may]
        yield Pairs(row * program.scene.camera.width + column, splats.vertex[splat], certain)
        first = last


def _later(pairs: Pairs, low: Floats, high: Floats, twins: Ints | None) -> Bools:
    """Pairs that lose a tie which is no matter of rounding: LESS keeps the earlier of equal depths.

    Depths are equal on every device where the splats are twins, and on one that keeps the very numbers if these are equal.
    """
    pixel, splat, certain = pairs.pixel, pairs.splat, pairs.certain
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


def _tested(program: Any, pairs: Pairs, twins: Ints | None, depth: Number, least: Ints, most: Ints) -> Contest:
    """By another depth test, splat after splat: as long as it is certain what each does. Beyond, any may win."""
    order = np.lexsort((pairs.splat, pairs.pixel))
    pairs, pixels = pairs.take(order), len(least)
    places, starts, many = np.unique(pairs.pixel, return_index=True, return_counts=True)
    winner, known = np.full(pixels, -1), np.ones(pixels, np.bool_)
    fewest, highest = np.zeros((2, pixels), np.int64)
    names = np.arange(len(depth)) if twins is None else twins
    for turn in range(many.max(initial=0)):
        left = many > turn
        places, starts, many = places[left], starts[left], many[left]
        here, old = starts + turn, winner[places]
        new = pairs.splat[here]
        do, alike = depth.do, (old >= 0) & (names[new] == names[old])  # equal, whatever they are
        value, error = (
            np.where(old >= 0, x[old], nothing) for x, nothing in ((depth.value, 1.0), (depth.deviation, 0.0))
        )
        mine = Number(do, np.where(alike, value, depth.value[new]), np.where(alike, 0.0, depth.deviation[new]))
        truth = program.passes(mine, Number(do, value, np.where(alike, 0.0, error)))
        may, must = may_and_must(truth)
        must = must & pairs.certain[here]
        fewest[places] += may_and_must(program.counted(must))[0] & known[places] & pairs.certain[here]
        highest[places] += may_and_must(program.counted(may | ~known[places]))[0]
        known[places] &= may == must
        winner[places[must]] = new[must]
    open_ = ~known[pairs.pixel]
    rows = np.flatnonzero(known & (winner >= 0))
    pixel, splat = np.concatenate([rows, pairs.pixel[open_]]), np.concatenate([winner[rows], pairs.splat[open_]])
    counts = (least, most) if program.right("counted") else (fewest, highest)
    return Contest(pixel, splat, ~known | (winner < 0), *counts, depth)
