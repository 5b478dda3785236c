"""Ellipses that are averaged, on numbers with bounds: which may be added up at a pixel, and the weight of each.

Whether a splat covers a pixel, and whether it is of the nearest one's surface, may go either way; of a pixel every choice is
an outcome of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.arithmetic.number import Number, may_and_must
from ibr_ref.oracle.pipeline.splats import Drawn, Pairs, covering, recut
from ibr_ref.oracle.programs.splatting.raster import Fragments

MOST_OPEN = 6
"""Splats of a pixel that may be added or not; beyond, its outcomes are not followed."""


@dataclass(frozen=True, eq=False)
class Blended:
    """m outcomes of pixels, and n splats that are added up in one of them each."""

    row: Ints
    """(m,) the pixel and its nearest splat, among those asked for."""
    lost: Bools
    """(m,) there are more than can be followed, and this is none of them."""
    weight: Number
    """(m,) sum."""
    count: Ints
    """(m,) splats."""
    of: Ints
    """(n,) growing: whose they are."""
    splat: Ints
    """(n,) the vertex."""
    share: Number
    """(n,) weights."""


@dataclass(frozen=True, eq=False)
class _Joined:
    """(n,) splats at the pixel of an outcome."""

    row: Ints
    pair: Ints
    open: Bools
    """May be added or not; the others are."""

    def take(self, index: Any) -> _Joined:
        """Some of them."""
        return _Joined(self.row[index], self.pair[index], self.open[index])


def blended(program: Any, points: Drawn, pixel: Ints, winner: Ints, named: Ints) -> Blended:
    """Outcomes of pixels (r,) with their nearest splats (r,), -1 none; named: what the second pass takes these for."""
    splats, pairs = covering(program, points, np.unique(pixel))
    order = np.lexsort((pairs.splat, pairs.pixel))
    pairs = pairs.take(order)
    joined = _joined(program, points, pairs, pixel, winner, named)
    opened = np.bincount(joined.row[joined.open], minlength=len(pixel))
    lost = opened > MOST_OPEN
    joined = joined.take(~(joined.open & lost[joined.row]))
    ways = 1 << np.where(lost, 0, opened)
    row = np.repeat(np.arange(len(pixel)), ways)
    of, index = _chosen(joined, row, ways)
    pair = joined.pair[index]
    local = np.searchsorted(splats.vertex, pairs.splat)
    width = program.scene.camera.width
    share = program.do.of(program.weight(splats, Fragments(local, pairs.pixel // width, pairs.pixel % width)))
    share = share.absorbed()[pair]
    count = np.bincount(of, minlength=len(row))
    weight = program.do.of(program.summed(share, of, len(row)))
    anything = np.where(lost[row], np.inf, 0.0)
    return Blended(row, lost[row], weight.off_by(anything), count, of, pairs.splat[pair], share)


def _joined(program: Any, points: Drawn, pairs: Pairs, pixel: Ints, winner: Ints, named: Ints) -> _Joined:
    """Each outcome with the splats that may be added up in it."""
    first, stop = (np.searchsorted(pairs.pixel, pixel, side=side) for side in ("left", "right"))
    many = np.where(winner >= 0, stop - first, 0)
    row = np.repeat(np.arange(len(pixel)), many)
    pair = first[row] + np.arange(len(row)) - np.repeat(np.cumsum(many) - many, many)
    splat, nearest = pairs.splat[pair], winner[row]
    distance = points.gaussian.T[4]  # type: ignore[union-attr]
    may, must = may_and_must(program.blends(distance[splat], distance[named[row]]))
    same = splat == nearest
    if points.twins is not None:
        same |= points.twins[splat] == points.twins[nearest]
    certain = (pairs.certain[pair] | same) & (must | same) & may
    if program.right("passes"):  # what is nearer than the winner, and may be there, is not
        depth = program.stored_depth(recut(program, points).depth)
        may &= same | pairs.certain[pair] | ~(depth.high[splat] < depth.low[nearest])
    kept = np.flatnonzero(may)
    return _Joined(row[kept], pair[kept], ~certain[kept])


def _chosen(joined: _Joined, row: Ints, ways: Ints) -> tuple[Ints, Ints]:
    """Whose they are, and which: of outcome after outcome those that are added, by the bits of its turn."""
    first = np.searchsorted(joined.row, np.arange(len(ways)))
    stop = np.searchsorted(joined.row, np.arange(len(ways)), side="right")
    before: Ints = np.cumsum(joined.open) - joined.open
    bit: Ints = before - before[first[joined.row]] if len(joined.row) else before
    many = (stop - first)[row]
    of = np.repeat(np.arange(len(row)), many)
    index = first[row][of] + np.arange(len(of)) - np.repeat(np.cumsum(many) - many, many)
    turn = np.arange(len(row)) - (np.cumsum(ways) - ways)[row]
    added = ~joined.open[index] | ((turn[of] >> np.where(joined.open[index], bit[index], 0)) & 1 == 1)
    return of[added], index[added]
