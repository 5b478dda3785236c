"""Searches whose ways part at every tie and meet again: all of their states are followed at once, and only ends are chosen.

A comparison that may go either way parts a state in two (`parted`); states that come again are dropped, or one with the
bounds of both (`Explored`); of the ends that are left each is a path of the program (`one_end`). A device takes one way.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.arithmetic.choices import Choices
from ibr_ref.oracle.arithmetic.number import Number, Truth, may_and_must

MOST_STATES = 256
"""Of one lane's search; beyond, it is lost."""
ALIKE = 2.0
"""Ends that overlap are one, if its bounds are no wider than so many times those of either."""


class Ways(Choices):
    """Of all devices that bounds allow."""

    def parted(self, truth: Any) -> tuple[Bools, Bools]:
        """Where a comparison may hold, and where it may not: both, where it may go either way."""
        may, must = may_and_must(truth)
        return may, ~must

    def wholes(self, x: Any) -> tuple[Ints, Ints]:
        """Rows, and all that floor(x) may be of them; of what spans many nothing is left, and the lane is lost."""
        x = self.of(x)
        low, high = np.floor(x.low), np.floor(x.high)
        far = ~(high - low <= 4.0)
        self.give_up(x[far])
        counts = np.where(far, 0, high - low + 1.0).astype(np.int64)
        rows = np.repeat(np.arange(len(counts)), counts)
        steps = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
        return rows, low[rows].astype(np.int64) + steps

    def give_up(self, x: Number) -> None:
        """The lanes of some numbers are lost."""
        if x.lane is not None:
            self.run.lost[x.lane] = True

    def explored(self) -> Explored:
        """What tells states apart."""
        return Explored(self)

    def one_end(self, like: Any, rows: Ints, kinds: Ints, x: Any) -> tuple[Ints, Number]:
        """An end that each search may have, as many as `like` has rows.

        Ends of a kind that overlap, and are about as wide, are one.
        """
        x = self.of(x)
        order = np.lexsort((x.value, kinds, rows))
        rows, kinds, x = rows[order], kinds[order], x[order]
        while len(rows) > 1:
            hull = self.alternatives(x[:-1], x[1:])
            near = hull.deviation <= ALIKE * np.maximum(x.deviation[:-1], x.deviation[1:])
            at = np.flatnonzero(_every_other(_pairs(rows) & _pairs(kinds) & near))
            if not len(at):
                break
            x, rows, kinds = self.joined(at, hull[at], x, rows, kinds)
        return self._picked(self.of(like), rows, kinds, x)

    def joined(self, at: Ints, hull: Number, x: Number, *columns: Ints) -> tuple[Any, ...]:
        """Rows, those at `at` with the hull of them and the ones behind; of columns the first."""
        kept = np.ones(len(x), np.bool_)
        kept[at + 1] = False
        return (self.replaced(x, at, hull)[kept], *(column[kept] for column in columns))

    def _picked(self, like: Number, rows: Ints, kinds: Ints, x: Number) -> tuple[Ints, Number]:
        """One of the ends of each search: decided."""
        count = len(like)
        ends = np.bincount(rows, minlength=count)
        first = np.cumsum(ends) - ends
        chosen = np.zeros(count, np.int64)
        for bit in (
            2 ** np.arange(int(ends.max(initial=1) - 1).bit_length())[::-1]
        ):  # fewer runs than one end after another
            first_half = Truth(self, np.ones(count, np.bool_), chosen + bit >= ends, like.lane)
            chosen += np.where(first_half.decided(), 0, bit)
        some = np.flatnonzero(ends > 0)
        at = first[some] + chosen[some]
        kind = np.full(count, -1)
        kind[some] = kinds[at]
        return kind, self.replaced(Number(self, np.zeros(count), np.zeros(count), {}, like.lane), some, x[at])


class Explored:
    """The states of searches that were followed already, by keys, each with the number that belongs to it."""

    def __init__(self, do: Ways) -> None:
        self.do = do
        self.keys: Ints = np.zeros(0, np.int64)
        self.x = Number(do, np.zeros(0), np.zeros(0), {}, np.zeros(0, np.int64))
        self.counts = np.zeros(len(do.run.lost), np.int64)

    def fresh(self, keys: Ints, x: Any) -> tuple[Ints, Number]:
        """Rows to go on from, and their numbers: of those with one key one, with the bounds of all there ever were."""
        do, rows = self.do, np.argsort(keys, kind="stable")
        keys, x = keys[rows], do.of(x)[rows]
        while len(at := np.flatnonzero(_every_other(_pairs(keys)))):
            x, keys, rows = do.joined(at, do.alternatives(x[at], x[at + 1]), x, keys, rows)
        x, new = self._remembered(keys, x)
        new &= self._affordable(x, new)
        return rows[new], x[new]

    def _remembered(self, keys: Ints, x: Number) -> tuple[Number, Bools]:
        """Numbers with the bounds of those before, and which are new, or wider."""
        do, place = self.do, np.searchsorted(self.keys, keys)
        new = np.ones(len(keys), np.bool_)
        if len(self.keys):
            new = self.keys[np.minimum(place, len(self.keys) - 1)] != keys
        again, at = np.flatnonzero(~new), place[~new]
        if len(again):
            before = self.x[at]
            hull = do.alternatives(before, x[again])
            new[again] = hull.error > before.error
            x, self.x = do.replaced(x, again, hull), do.replaced(self.x, at, hull)
        first = np.ones(len(keys), np.bool_)
        first[again] = False
        keys = np.concatenate([self.keys, keys[first]])
        order = np.argsort(keys, kind="stable")
        joined: Any = np.concatenate  # of numbers it is a number
        self.keys, self.x = keys[order], joined([self.x, x[first]])[order]
        return x, new

    def _affordable(self, x: Number, new: Bools) -> Bools:
        """Rows of lanes that are not lost: those with too many states are."""
        if x.lane is None:
            return new
        self.counts += np.bincount(x.lane[new], minlength=len(self.counts))
        self.do.run.lost |= self.counts > MOST_STATES
        return np.asarray(~self.do.run.lost[x.lane], np.bool_)


def _pairs(keys: Ints) -> Bools:
    """(n - 1,) whether the next is the same."""
    return np.asarray(keys[1:] == keys[:-1], np.bool_)


def _every_other(pairs: Bools) -> Bools:
    """Those of which none shares a row with another: in a run the first, the third, ..."""
    index = np.arange(len(pairs))
    start = np.maximum.accumulate(np.where(pairs, -1, index))
    return np.asarray(pairs & ((index - start) % 2 == 1), np.bool_)
