"""Automatic control points: registration of warped on rendered maps, coarse to fine, from simple placements.

The paper places them by hand and leaves this open (section 5). The caster is rendered at training places all over its
range; the points move until the maps that are warped there come near to the rendered ones, at the pace that the frame will
have. Started from are lines that divide the silhouette's bounding box, R of them downwards, and R of them across; where a
silhouette is cut by the map's border or missing, also those that divide the caster's own box, wherever it reaches to.
What registration came to is then held against all that it was started from, and more, at places that served neither
(`shadows.selection`), and the best of all is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.shadows import folds, maps, residuals, training
from ibr_ref.shadows.controls import along, bounds, identity, on_lattice, turned
from ibr_ref.shadows.draw import grid_triangles
from ibr_ref.shadows.registration import Task, register
from ibr_ref.shadows.selection import HeldOut, Pace, Reach, best_of

Progress = Callable[[str, int, int], None]
"""Called as work goes on, with what is being done, how many steps are done, and of how many."""


class Level(NamedTuple):
    """A step from coarse to fine."""

    size: int
    """Texels a side, more where the shadow takes up little of the map; never more than the maps themselves have."""
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
    held_out: int
    """Places at which what was found is compared."""


RECIPES = {
    "fast": Recipe((Level(64, 2, 12),), (Level(128, 2, 8),), 32),
    "best": Recipe((Level(64, 3, 40), Level(128, 3, 40)), (Level(256, 3, 40),), 128),
}

_SMALL = 0.25
"""Of the map's side: a shadow that is no longer is registered finer."""

_MOST_POINTS = 4096
"""R C: the equations of more would take gigabytes."""


@dataclass(frozen=True)
class Nine:
    """What control points are placed for."""

    view: maps.View
    """What the maps are rendered of, at any size."""
    positions: Floats
    """(3, 3, 2) of the nine maps."""
    silhouettes: Floats
    """(3, 3, S, S) theirs, 0 to 1, as sharp as the maps."""
    samples: int
    """k of the maps."""
    pace: Pace

    @property
    def size(self) -> int:
        """S."""
        return int(self.silhouettes.shape[2])


class Candidate(NamedTuple):
    """Points (3, 3, R, C, 2), and how they came about."""

    name: str
    points: Floats


class _Work:
    """One run: what is made once for each level, and the count of steps that are done."""

    def __init__(self, nine: Nine, recipe: Recipe, starts: int, progress: Progress | None) -> None:
        self.nine, self.progress = nine, progress
        self.done = 0
        self.total = sum(level.steps for level in starts * recipe.starts + recipe.finish)
        self.forms, self.finer = folds.forms_of(nine.pace.depths), _finer(nine.silhouettes)
        self.tasks: dict[Level, Task] = {}

    def task(self, level: Level, phase: float = training.TRAINING) -> Task:
        """At the maps' own size the maps themselves are registered, with the steps in their outlines: .01 at worst."""
        nine, own = self.nine, self.nine.size
        size = min(level.size * self.finer, own)
        if size == own:
            images = training.smoothed(nine.silhouettes.reshape(9, own, own))
        else:
            images = training.rendered(nine.view, nine.positions.reshape(9, 2), size)
        places = training.places(nine.view, nine.positions, nine.pace.depths, size, level.side, phase)
        return Task(images.reshape(9, -1), places, self.forms)

    def run(self, points: Floats, levels: tuple[Level, ...], what: str) -> Floats:
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


def _finer(silhouettes: Floats) -> int:
    """1, 2 or 4: so many times finer a small shadow is registered, to have as many texels as a large one."""
    extents = [
        np.ptp(np.flatnonzero(image.any(axis=axis))) + 1
        for image in silhouettes.reshape(9, *silhouettes.shape[2:]) > 0.0
        for axis in (0, 1)
        if image.any()
    ]
    largest = max(extents) / silhouettes.shape[2]
    return 1 if largest > _SMALL else 2 if largest > _SMALL / 2.0 else 4


def _starts(nine: Nine, boxes: Floats | None, rows: int, columns: int) -> list[Candidate]:
    """What registration is started from."""
    found = [
        Candidate("rows downwards", bounds(nine.silhouettes, rows, columns, boxes)),
        Candidate("rows across", turned(bounds(nine.silhouettes, columns, rows, boxes))),
    ]
    if boxes is not None and (boxes.min() < 0.0 or boxes.max() > 1.0):
        found.append(Candidate("the caster's box, rows downwards", along(boxes, rows, columns)))
        found.append(Candidate("the caster's box, rows across", turned(along(boxes, columns, rows))))
    forms = folds.forms_of(nine.pace.depths)
    return [candidate for candidate in found if folds.unfolded(candidate.points, forms)]


def _finished(nine: Nine, recipe: Recipe, starts: Sequence[Candidate], progress: Progress | None) -> list[Candidate]:
    """What registration comes to, the finished one first, and before it was finished."""
    work = _Work(nine, recipe, len(starts), progress)
    placed = [work.run(start.points, recipe.starts, f"control points, {start.name}") for start in starts]
    others = work.task(recipe.starts[-1], training.OTHERS)
    better = min(range(len(placed)), key=lambda i: residuals.cost(others.images, others.places, placed[i]))
    points = work.run(placed[better], recipe.finish, "control points")
    if progress:
        progress("control points", work.total, work.total)
    coarse = [Candidate(f"registered, coarsely, {s.name}", p) for s, p in zip(starts, placed, strict=True)]
    return [Candidate(f"registered, {starts[better].name}", points), *coarse]


def snapped(points: Floats, size: int, forms: Floats = folds.EVEN) -> Floats:
    """Points on the lattice of the window; the corners of triangles that would fold by that stay where they are."""
    moved, exact = on_lattice(points, size), np.zeros(points.shape[2:4], np.bool_)
    number = np.arange(exact.size).reshape(exact.shape)
    corners = grid_triangles(np.stack([number, number], axis=-1))[..., 0]
    while (folding := folds.folding(moved, forms).any(axis=0)).any() and not exact.all():
        before = int(exact.sum())
        exact.reshape(-1)[corners[folding].astype(np.int64).ravel()] = True
        if int(exact.sum()) == before:
            break
        moved[:, :, exact] = points[:, :, exact]
    return moved


class Placed(NamedTuple):
    """What `place` gives."""

    points: Floats
    """(3, 3, R, C, 2) on the lattice of the window."""
    chosen: Reach
    others: tuple[Reach, ...]


def place(quality: str, nine: Nine, grid: tuple[int, int], progress: Progress | None) -> Placed:
    """Controls by one of `RECIPES`, what they reach, and what others do.

    The border stays on the border; no triangle folds, in the nine grids or at any place between them. Where there is
    nothing to register (no map has a silhouette), or too much (more points than _MOST_POINTS), the simple placements
    alone are compared.
    """
    boxes, forms = maps.projected_boxes(nine.view, nine.positions), folds.forms_of(nine.pace.depths)
    simple = _simple(nine, boxes, *grid)
    registered = _registered(quality, nine, boxes, grid, progress)
    if quality == "best":
        fast = place("fast", nine, grid, None)
        simple.insert(0, Candidate(f"{fast.chosen.name} (fast)", fast.points))
    candidates = [c._replace(points=snapped(c.points, nine.size, forms)) for c in (*registered, *simple)]
    offsets = training.spread(nine.positions, RECIPES[quality].held_out)
    held_out = HeldOut(nine.view, nine.positions, nine.size, nine.samples, nine.pace, offsets)
    tried = [held_out.tried(*candidate) for candidate in candidates]
    rivals = [*tried[-len(simple) :], held_out.nearest_map()]
    best = best_of(tried, rivals, len(registered))
    others = [t.reach for i, t in enumerate((*tried, rivals[-1])) if i != best]
    return Placed(candidates[best].points, tried[best].reach, tuple(others))


def _simple(nine: Nine, boxes: Floats | None, rows: int, columns: int) -> list[Candidate]:
    """What registration must be better than."""
    return [
        Candidate("bounds", bounds(nine.silhouettes, rows, columns, boxes)),
        Candidate("identity", identity(nine.silhouettes, rows, columns)),
    ]


def _registered(
    quality: str, nine: Nine, boxes: Floats | None, grid: tuple[int, int], progress: Progress | None
) -> list[Candidate]:
    """What registration comes to, the finished one first; and the caster's own box."""
    (rows, columns), found = grid, []
    starts = _starts(nine, boxes, rows, columns)
    if rows * columns <= _MOST_POINTS and starts and (nine.silhouettes > 0.0).any():
        found = _finished(nine, RECIPES[quality], starts, progress)
    if boxes is not None:
        found.append(Candidate("the caster's box", along(boxes, rows, columns)))
    return found
