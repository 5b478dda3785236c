"""Automatic control points: registration of warped on rendered maps, coarse to fine, from two simple placements.

The paper places them by hand and leaves this open (section 5). The caster is rendered at training places all over its
range; the points move until the maps that are warped there come near to the rendered ones. Two placements are started
from: lines that divide the silhouette's bounding box, R of them downwards, and R of them across; other places than those
trained at tell which of the two goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.shadows import maps, residuals
from ibr_ref.shadows.controls import bounds, on_lattice, turned
from ibr_ref.shadows.folds import unfolded
from ibr_ref.shadows.registration import Task, register
from ibr_ref.shadows.residuals import Places

Array = NDArray[np.float64]
Progress = Callable[[str, int, int], None]
"""Called as work goes on, with what is being done, how many steps are done, and of how many."""


class Level(NamedTuple):
    """A step from coarse to fine."""

    size: int
    """Texels a side; never more than the maps themselves have."""
    side: int
    """Training places along either axis of a cell of the 3 x 3 positions."""
    steps: int
    """Of Gauss-Newton, at most."""


class Recipe(NamedTuple):
    """How much work is spent."""

    starts: tuple[Level, ...]
    """From each of the placements."""
    finish: tuple[Level, ...]
    """From the better one."""


RECIPES = {
    "fast": Recipe((Level(64, 2, 12),), (Level(128, 2, 8),)),
    "best": Recipe((Level(64, 3, 40), Level(128, 3, 40)), (Level(256, 3, 40),)),
}

_SAMPLES = 4
"""Coverage of 4 x 4 samples a texel: outlines then move smoothly."""

_MOST_POINTS = 4096
"""R C: the equations of more would take gigabytes."""

_TRAINING, _OTHERS = 0.0, 0.5
"""Phases of two sequences of places."""

_R2 = (0.7548776662466927, 0.5698402909980532)
"""Roberts' sequence in two dimensions: powers of 1 / 1.3247..., the root of x^3 = x + 1."""


def _fractions(side: int, phase: float) -> Array:
    """(side^2, 2) places in a cell, one in each of side x side squares."""
    steps = np.arange(side * side)
    jitter = [(phase + (steps + 1) * share) % 1.0 for share in _R2]
    return np.stack([(steps % side + jitter[0]) / side, (steps // side + jitter[1]) / side], axis=1)


def _smoothed(images: Array) -> Array:
    """Images (N, S, S) under the binomial filter 1 2 1 along both axes."""
    padded = np.pad(images, ((0, 0), (1, 1), (1, 1)), mode="edge")
    across = (padded[:, :, :-2] + 2.0 * padded[:, :, 1:-1] + padded[:, :, 2:]) / 4.0
    return (across[:, :-2] + 2.0 * across[:, 1:-1] + across[:, 2:]) / 4.0


def _rendered(view: maps.View, offsets: Array, size: int) -> Array:
    """(N, S, S) silhouettes, smoothed."""
    levels = maps.levels(_SAMPLES)
    return _smoothed(np.stack([levels[maps.mask(view, offset, size, _SAMPLES)] for offset in offsets]))


def places(view: maps.View, positions: Array, size: int, side: int, phase: float) -> Places:
    """The caster rendered at side x side places in each of the four cells of the positions (3, 3, 2)."""
    s, t = _fractions(side, phase).T
    weights = np.stack([(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t], axis=1)
    offsets = []
    for j in range(2):
        for i in range(2):
            around = positions[j : j + 2, i : i + 2].reshape(4, 2)
            offsets.append(sum(weights[:, k, None] * around[k] for k in range(4)))
    targets = _rendered(view, np.concatenate(offsets), size)
    return Places(np.arange(5) * len(s), np.tile(weights, (4, 1)), targets)


class _Work:
    """One run: what is made once for each level, and the count of steps that are done."""

    def __init__(
        self, view: maps.View, positions: Array, silhouettes: Array, recipe: Recipe, progress: Progress | None
    ) -> None:
        self.view, self.positions, self.silhouettes, self.progress = view, positions, silhouettes, progress
        self.done, self.total = 0, sum(level.steps for level in 2 * recipe.starts + recipe.finish)
        self.tasks: dict[Level, Task] = {}

    def task(self, level: Level, phase: float = _TRAINING) -> Task:
        """At the maps' own size the maps themselves are registered, with the steps in their outlines: .01 at worst."""
        own = self.silhouettes.shape[2]
        size = min(level.size, own)
        if size == own:
            images = _smoothed(self.silhouettes.reshape(9, own, own))
        else:
            images = _rendered(self.view, self.positions.reshape(9, 2), size)
        return Task(images.reshape(9, -1), places(self.view, self.positions, size, level.side, phase))

    def run(self, points: Array, levels: tuple[Level, ...], what: str) -> Array:
        for level in levels:
            if level not in self.tasks:
                self.tasks[level] = self.task(level)
            after = self.done + level.steps
            points = register(points, self.tasks[level], level.steps, lambda: self._step(what))
            self.done = after
        return points

    def _step(self, what: str) -> None:
        if self.progress:
            self.progress(what, self.done, self.total)
        self.done += 1


def place(
    quality: str,
    view: maps.View,
    positions: Array,
    silhouettes: Array,
    grid: tuple[int, int],
    progress: Progress | None,
) -> Array:
    """Controls (3, 3, R, C, 2) by one of `RECIPES`, on the lattice of the window.

    view: what the maps are rendered of, at any size; positions (3, 3, 2) of the nine maps; silhouettes (3, 3, S, S):
    theirs, 0 to 1, as sharp as the maps. The border stays on the border; no triangle folds, in the nine grids or at any
    place between them. Where there is nothing to register (a map without a silhouette), or too much (more points than
    _MOST_POINTS), the first of the simple placements is returned.
    """
    recipe, size, (rows, columns) = RECIPES[quality], silhouettes.shape[2], grid
    starts = [bounds(silhouettes, rows, columns), turned(bounds(silhouettes, columns, rows))]
    if rows * columns > _MOST_POINTS or not (silhouettes > 0.0).any(axis=(2, 3)).all():
        return on_lattice(starts[0], size)
    work = _Work(view, positions, silhouettes, recipe, progress)
    names = ("control points, rows downwards", "control points, rows across")
    placed = [work.run(start, recipe.starts, name) for start, name in zip(starts, names, strict=True)]
    others = work.task(recipe.starts[-1], _OTHERS)
    better = min(range(2), key=lambda i: residuals.cost(others.images, others.places, placed[i]))
    points = work.run(placed[better], recipe.finish, "control points")
    if progress:
        progress("control points", work.total, work.total)
    points = on_lattice(points, size)
    return points if unfolded(points) else on_lattice(starts[better], size)
