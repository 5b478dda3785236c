"""What registration is trained at: places all over the caster's range, and the maps that are rendered there."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.scene.roberts import R2
from ibr_ref.shadows import maps, pace
from ibr_ref.shadows.residuals import Places

_SAMPLES = 4
"""Coverage of 4 x 4 samples a texel: outlines then move smoothly."""

TRAINING, OTHERS = 0.0, 0.5
"""Phases of two sequences of places."""


def _fractions(side: int, phase: float) -> Floats:
    """(side^2, 2) places in a cell, one in each of side x side squares."""
    steps = np.arange(side * side)
    jitter = [(phase + (steps + 1) * share) % 1.0 for share in R2]
    return np.stack([(steps % side + jitter[0]) / side, (steps // side + jitter[1]) / side], axis=1)


def smoothed(images: Floats) -> Floats:
    """Images (N, S, S) under the binomial filter 1 2 1 along both axes."""
    padded = np.pad(images, ((0, 0), (1, 1), (1, 1)), mode="edge")
    across = (padded[:, :, :-2] + 2.0 * padded[:, :, 1:-1] + padded[:, :, 2:]) / 4.0
    return (across[:, :-2] + 2.0 * across[:, 1:-1] + across[:, 2:]) / 4.0


def rendered(view: maps.View, offsets: Floats, size: int) -> Floats:
    """(N, S, S) silhouettes, smoothed."""
    levels = maps.levels(_SAMPLES)
    return smoothed(np.stack([levels[maps.mask(view, offset, size, _SAMPLES)] for offset in offsets]))


def _cells() -> list[tuple[int, int]]:
    """(j, i) of the four cells, in order."""
    return [(j, i) for j in range(2) for i in range(2)]


def offsets(positions: Floats, side: int, phase: float) -> Floats:
    """(4 side^2, 2) side x side places in each of the four cells of the positions (3, 3, 2)."""
    weights = pace.weights(_fractions(side, phase), None)
    found = []
    for j, i in _cells():
        around = pace.cell_of(positions, i, j).reshape(4, 2)
        found.append(sum(weights[:, k, None] * around[k] for k in range(4)))
    return np.concatenate(found)


def spread(positions: Floats, count: int) -> Floats:
    """(N, 2) places evenly over the whole range of the positions (3, 3, 2): for judging, not for training."""
    steps = np.arange(count) + 1.0
    shares = np.stack([(0.25 + steps * share) % 1.0 for share in R2], axis=1)
    low, high = positions[0, 0], positions[2, 2]
    return np.asarray(low * (1.0 - shares) + high * shares)


def places(view: maps.View, positions: Floats, depths: Floats | None, size: int, side: int, phase: float) -> Places:
    """The caster rendered at those places, and the maps' weights in the mix there: depths (3, 3) as in `pace`."""
    fractions = _fractions(side, phase)
    around = [None if depths is None else pace.cell_of(depths, i, j) for j, i in _cells()]
    weights = np.concatenate([pace.weights(fractions, of_cell) for of_cell in around])
    return Places(np.arange(5) * len(fractions), weights, rendered(view, offsets(positions, side, phase), size))
