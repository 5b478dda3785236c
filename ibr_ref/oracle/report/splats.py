"""The shift of the sample points that explains most of a port's wrong winners among splats.

A pixel is explained where its sample point, shifted, lies in the splat that the port has there, and in none of those of the
reference that lie nearer; of a pixel without a splat: in none of the reference's.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.cases import Case

WINNER = "raster.splat"
STEP = 0.125
"""Of the shifts that are tried, in pixels."""
FARTHEST = 2.0
MOST = 2000
"""Wrong pixels that are looked at to find it."""


def shifts(case: Case, handed: Mapping[str, Any], wrong: Bools) -> Floats:
    """(H, W, 2) columns and rows: the shift where it explains the port's winner, NaN elsewhere."""
    winners = _Winners(case, handed)
    at = np.argwhere(wrong)
    found = np.full((*wrong.shape, 2), np.nan)
    best = _best(winners, at[:: -(-len(at) // MOST)])
    if best.any():
        explained = at[winners.explained(at, best)]
        found[explained[:, 0], explained[:, 1]] = best
    return found


def _best(winners: _Winners, at: Ints) -> Floats:
    """The middle of the shifts that explain most; (0, 0) where no shift explains more than none does."""
    steps = np.arange(-FARTHEST, FARTHEST + STEP, STEP)
    tried = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    counts = np.array([winners.explained(at, shift).sum() for shift in tried])
    unmoved = counts[~tried.any(axis=1)][0]
    if counts.max() <= unmoved:
        return np.zeros(2)
    middle: Floats = tried[counts == counts.max()].mean(axis=0)
    return middle


class _Winners:
    """What the reference has at pixels, and what the port has."""

    def __init__(self, case: Case, handed: Mapping[str, Any]) -> None:
        stages = case.frame.stages
        # The port's own vertices, where it handed them in: the raster is judged on them.
        self.window, self.width, self.depth = (
            np.asarray(handed.get(name, stages[name]), np.float64)
            for name in ("vertex.window", "vertex.width", "vertex.depth")
        )
        self.round = case.params.shape == "disc"
        self.ours, self.theirs = (np.asarray(a[WINNER], np.int64) for a in (stages, handed))

    def explained(self, at: Ints, shift: Floats) -> Bools:
        """(n,) of pixels (n, 2), row and column."""
        sample = at[:, ::-1] + 0.5 + shift
        ours, theirs = self.ours[at[:, 0], at[:, 1]], self.theirs[at[:, 0], at[:, 1]]
        hides = (theirs < 0) | (self._depth(ours) < self._depth(theirs))
        inside = (theirs < 0) | self._covers(theirs, sample)
        return inside & ~(hides & self._covers(ours, sample))

    def _known(self, splat: Ints) -> Bools:
        return np.asarray((splat >= 0) & (splat < len(self.width)), np.bool_)

    def _depth(self, splat: Ints) -> Floats:
        return np.where(self._known(splat), self.depth[np.where(self._known(splat), splat, 0)], np.inf)

    def _covers(self, splat: Ints, sample: Floats) -> Bools:
        known = self._known(splat)
        at = np.where(known, splat, 0)
        off, half = sample - self.window[at], 0.5 * self.width[at]
        reach = np.sqrt((off * off).sum(axis=1)) if self.round else np.abs(off).max(axis=1)
        return np.asarray(known & (reach <= half), np.bool_)
