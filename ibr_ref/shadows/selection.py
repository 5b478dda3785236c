"""Which of several sets of control points goes on: that which serves places best that none of them was made for.

At these places the caster is rendered, as the frame's maps are, and beside it what the warp makes of the nine maps: the
intersection over union of the two silhouettes is what a placement reaches, in the mean and at worst.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.metrics import iou
from ibr_ref.shadows import maps
from ibr_ref.shadows.spans import spans
from ibr_ref.shadows.warp import Nine, locate, warp_stage

LARGEST = 512
"""Texels a side of the maps that are compared: of larger ones smaller copies."""


_DRAWS, _DRAWN = 512, 24
"""How many times how many of the places are drawn."""

_HARDLY, _SELDOM = 10, 64
"""Of the draws, 2 % and an eighth."""


class Reach(NamedTuple):
    """What a placement reaches at places that it was not made for."""

    name: str
    mean: float
    """IoU of warped and rendered silhouettes, 0 to 1."""
    worst: float
    """The same at the worst place."""


class Tried(NamedTuple):
    """A placement at all places."""

    name: str
    found: Floats
    """(N,) IoU."""

    @property
    def reach(self) -> Reach:
        """In two numbers."""
        return Reach(self.name, sum(self.found.tolist()) / len(self.found), float(self.found.min()))


class Pace(NamedTuple):
    """How maps are mixed between the nine places."""

    depths: Floats | None
    """(3, 3) of the caster; None: the even pace."""
    nearest: bool
    """By three warps instead of six."""


class HeldOut:
    """The caster at places (N, 2), rendered, beside the nine maps."""

    def __init__(self, view: maps.View, positions: Floats, size: int, k: int, pace: Pace, offsets: Floats) -> None:
        size = min(size, LARGEST)
        self.positions, self.offsets, self.pace, self.levels = positions, offsets, pace, maps.levels(k)
        self.texels = np.stack([np.stack([maps.mask(view, o, size, k) for o in line]) for line in positions])
        self.spans = spans(self.texels, self.levels, 0.0)
        self.truths = [self.levels[maps.mask(view, offset, size, k)] for offset in offsets]

    def tried(self, name: str, controls: Floats) -> Tried:
        """Of control points (3, 3, R, C, 2)."""
        nine = Nine(self.texels, self.levels, self.spans, controls, 0.0)
        found = []
        for offset, truth in zip(self.offsets, self.truths, strict=True):
            cell, fraction = locate(self.positions, offset)
            image = warp_stage(nine, cell, fraction, self.pace.depths, self.pace.nearest).image
            found.append(iou(image, truth))
        return Tried(name, np.array(found))

    def nearest_map(self) -> Tried:
        """Of the nearest of the nine maps, without a warp."""
        found = []
        for offset, truth in zip(self.offsets, self.truths, strict=True):
            (i, j), (s, t) = locate(self.positions, offset)
            image = self.levels[self.texels[j + int(t >= 0.5), i + int(s >= 0.5)]]
            found.append(iou(image, truth))
        return Tried("nearest of the nine maps", np.array(found))


def best_of(candidates: Sequence[Tried], rivals: Sequence[Tried], registered: int) -> int:
    """Index of the candidate to take; rivals are what it should not be behind, in the mean and at worst.

    Asked is how often it would be behind any of them over places drawn by chance. The first `registered` candidates must
    earn it, as what they gain by chance at the one place they lose at the other: of those that hardly ever are behind in
    the mean, and seldom at worst, the one with the highest mean is taken. If there is none, what is least often behind; a
    simple placement is not behind itself, so that another one must be so less than half as often.
    """
    drawn = np.random.RandomState(0).randint(0, len(candidates[0].found), (_DRAWS, _DRAWN))
    means = np.stack([r.found[drawn].mean(axis=1) for r in rivals]).max(axis=0)
    worsts = np.stack([r.found[drawn].min(axis=1) for r in rivals]).max(axis=0)
    in_mean = [c.found[drawn].mean(axis=1) < means for c in candidates]
    at_worst = [c.found[drawn].min(axis=1) < worsts for c in candidates]
    behind = [int((m | w).sum()) for m, w in zip(in_mean, at_worst, strict=True)]
    earned = [i for i in range(registered) if in_mean[i].sum() <= _HARDLY and at_worst[i].sum() <= _SELDOM]
    if earned:
        return max(earned, key=lambda i: (candidates[i].reach.mean, -i))

    def least(indices: Sequence[int]) -> int:
        return min(indices, key=lambda i: (behind[i], -candidates[i].reach.mean, i))

    simple = least(range(registered, len(candidates)))
    better = least(range(registered)) if registered else simple
    return better if 2 * behind[better] < behind[simple] else simple
