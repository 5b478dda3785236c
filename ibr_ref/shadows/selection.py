"""Which of several sets of control points goes on: that which serves places best that none of them was made for.

At these places the caster is rendered, as the frame's maps are, and beside it what the warp makes of the nine maps: the
intersection over union of the two silhouettes is what a placement reaches, in the mean and at worst.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.metrics import iou
from ibr_ref.shadows import maps
from ibr_ref.shadows.spans import spans
from ibr_ref.shadows.warp import Nine, locate, warp_stage

Array = NDArray[np.float64]

LARGEST = 512
"""Texels a side of the maps that are compared: of larger ones smaller copies."""


_DRAWS, _DRAWN = 512, 24
"""How many times how many of the places are drawn."""

_RARELY = 10
"""Draws: what is behind in no more of them is as good as what never is."""


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
    found: Array
    """(N,) IoU."""

    @property
    def reach(self) -> Reach:
        """In two numbers."""
        return Reach(self.name, sum(self.found.tolist()) / len(self.found), float(self.found.min()))


class Pace(NamedTuple):
    """How maps are mixed between the nine places."""

    depths: Array | None
    """(3, 3) of the caster; None: the even pace."""
    nearest: bool
    """By three warps instead of six."""


class HeldOut:
    """The caster at places (N, 2), rendered, beside the nine maps."""

    def __init__(self, view: maps.View, positions: Array, size: int, k: int, pace: Pace, offsets: Array) -> None:
        size = min(size, LARGEST)
        self.positions, self.offsets, self.pace, self.levels = positions, offsets, pace, maps.levels(k)
        self.texels = np.stack([np.stack([maps.mask(view, o, size, k) for o in line]) for line in positions])
        self.spans = spans(self.texels, self.levels, 0.0)
        self.truths = [self.levels[maps.mask(view, offset, size, k)] for offset in offsets]

    def tried(self, name: str, controls: Array) -> Tried:
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
    """Index of the candidate that is least often behind any rival, in the mean or at worst, at places drawn by chance.

    The first `registered` of them must earn it, as what they gain on others by chance they lose again elsewhere: one of
    them is taken where it hardly ever is behind, or half as often as the best of the simpler ones, which is not behind
    itself. Of those that hardly ever are behind the one with the highest mean is taken, the first of equals.
    """
    drawn = np.random.RandomState(0).randint(0, len(candidates[0].found), (_DRAWS, _DRAWN))
    means = np.stack([r.found[drawn].mean(axis=1) for r in rivals]).max(axis=0)
    worsts = np.stack([r.found[drawn].min(axis=1) for r in rivals]).max(axis=0)
    behind = [
        int(((c.found[drawn].mean(axis=1) < means) | (c.found[drawn].min(axis=1) < worsts)).sum()) for c in candidates
    ]

    def least(indices: Sequence[int]) -> int:
        return min(indices, key=lambda i: (max(behind[i], _RARELY), -candidates[i].reach.mean, i))

    simple = least(range(registered, len(candidates)))
    if not registered:
        return simple
    better = least(range(registered))
    return better if behind[better] <= max(_RARELY, behind[simple] // 2) else simple
