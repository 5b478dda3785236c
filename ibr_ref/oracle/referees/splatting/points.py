"""Stage vertex, and its points on their way to the rasterizer."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.affine.rows import TINY, UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.programs.splatting.vertex import GAUSSIAN
from ibr_ref.oracle.referees.outcomes import judged, stored
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.splatting.model import Branch, Model, Placed
from ibr_ref.oracle.referees.splatting.table import Table, joined_columns
from ibr_ref.oracle.referees.splatting.verdict import judgement
from ibr_ref.splatting.contract import STAGES

ARRAYS = ("vertex.source", "vertex.window", "vertex.depth", "vertex.width", *GAUSSIAN, "vertex.color")
PLACES = ("vertex.window", "vertex.depth", "vertex.width", *GAUSSIAN)
"""What a splat is made of."""
VISIBLE = 1.0 / 255.0
"""Colours farther apart than one byte show."""


def judge_vertex(port: Port, among: Bools | None = None) -> Judgement:
    """Every point, or those `among`: dropped or kept, with all its numbers; and lit, with its highlight or without."""
    model, handed, every = port.model, port.handed, port.table
    given = {name: np.asarray(handed[name], np.float64) for name in ARRAYS if has(model, handed, name)}
    index = np.arange(len(every)) if among is None else np.flatnonzero(among)
    points, placed = (every, port.placed) if among is None else port.some(index)
    found = {name: array[index] for name, array in given.items()}
    bad: dict[str, Bools] = {}
    width = np.full(len(points), np.nan)
    undecided = np.zeros(len(points), np.bool_)
    names = [name for name in PLACES if name in found]
    if names:
        bad, width = _placed(placed, {name: found[name] for name in names})
        undecided = placed.possible & ~placed.sure
    if "vertex.source" in found:
        bad["vertex.source"] = (found["vertex.source"] != _sources(model, points)).any(axis=1)
    contradicted = among is not None and any(wrong.any() for wrong in bad.values())
    if "vertex.color" in found and not contradicted:
        lit = [model.colors(lighting, placed.world) for lighting in lightings(model, points)]
        wrong = [~allowed(branches, found["vertex.color"]) & points.usable for branches in lit]
        best = min(range(len(lit)), key=lambda i: int(wrong[i].sum()))
        bad["vertex.color"], branches = wrong[best], lit[best]
        for other in branches[1:]:
            apart = np.abs(branches[0].color.value - other.color.value).max(axis=1)
            undecided |= other.legal & (apart > VISIBLE)
        width = np.fmax(width, 2.0 * branches[0].color.deviation.max(axis=1))
    ordered = {name: _spread(len(every), index, bad[name] & points.usable) for name in ARRAYS if name in bad}
    undecided, width = _spread(len(every), index, undecided), _spread(len(every), index, width)
    return judgement(
        "vertex", "vertex", ordered, undecided, width, fed("splatting", ordered, handed, str(model.case.params.shape))
    )


def lightings(model: Model, points: Table) -> list[Table]:
    """Points with each set of normals that they may be lit with: that of ellipses is what they have their shapes by."""
    return [points] if model.elliptic else points.lightings


def has(model: Model, handed: Handed, name: str) -> bool:
    """Whether an array was handed in that the case has: Gaussians are those of ellipses alone."""
    return name in handed and (model.elliptic or name not in GAUSSIAN)


def _spread(count: int, index: Ints, values: Any) -> Any:
    """Of some points, in a row of all."""
    result = np.full(count, np.nan if values.dtype.kind == "f" else False, values.dtype)
    result[index] = values
    return result


def _placed(placed: Placed, found: dict[str, Floats]) -> tuple[dict[str, Bools], Floats]:
    """Where arrays contradict both outcomes, kept and dropped; and how wide what is legal is."""
    count = len(placed.sure)
    numbers = {"vertex.window": placed.window, "vertex.depth": [placed.depth], "vertex.width": [placed.width]}
    if placed.gaussian is not None:
        *covariance, amplitude, distance = placed.gaussian.T
        numbers |= dict(zip(GAUSSIAN, (covariance, [amplitude], [distance]), strict=True))
    kept, dropped = np.flatnonzero(placed.possible), np.flatnonzero(~placed.sure)
    agrees, width = [], np.full(count, np.nan)
    for name, array in found.items():
        rows, left = array.reshape(count, -1), STAGES[name].left
        within = np.all([x.allows(rows[:, k]) & np.isfinite(rows[:, k]) for k, x in enumerate(numbers[name])], axis=0)
        nothing = ((rows == left) | (np.isnan(rows) & np.isnan(left))).all(axis=1)
        agrees.append(np.concatenate([within[kept], nothing[dropped]]))
        for x in numbers[name]:
            width = np.fmax(width, np.where(placed.possible, 2.0 * x.deviation, np.nan))
    right, blame = judged(np.concatenate([kept, dropped]), agrees, count)
    return {name: ~right & (blame == i) for i, name in enumerate(found)}, width


def _sources(model: Model, points: Table) -> Ints:
    """Image, row, column, as integers."""
    parts = [model.program.source(n, points.rows[s], points.columns[s]) for n, s in points.shares()]
    return np.concatenate(parts) if parts else np.zeros((0, 3), np.int64)


def allowed(branches: list[Branch], found: Floats) -> Bools:
    """All channels must agree with the same branch."""
    agrees = np.zeros(len(found), np.bool_)
    for branch in branches:
        x = branch.color
        # Stored as a float32 once more; what is less than a normal number is 0 where denormals are flushed.
        legal = Number(x.do, x.value, x.deviation + UNIT * np.abs(x.value) + TINY)
        agrees |= branch.legal & legal.allows(found).all(axis=1)
    return agrees


# --- What later stages are fed with ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Port:
    """A port's arrays, with the program that they are judged by."""

    model: Model
    handed: Handed
    right: Port | None = None
    """By the right program."""
    chosen: list[Any] = field(default_factory=list)
    """What was asked for last of some of the points."""
    given_normals: bool = False
    """The points have the case's normals, whatever was handed in."""

    @cached_property
    def table(self) -> Table:
        """The points with what was handed in of an atlas."""
        if self.right and self.model.fetches_of:
            return self.right.table
        changed = any(name.startswith("atlas.") for name in self.handed)
        found = self.model.table(self.handed) if changed else self.model.own
        return found.lightings[-1] if self.given_normals else found

    @property
    def ways(self) -> list[Port]:
        """It alone; of ellipses, which have their shapes by normals, also with the case's where the port's are others."""
        if not self.model.elliptic or self.given_normals or len(self.table.lightings) == 1:
            return [self]
        right = self.right and replace(self.right, given_normals=True, chosen=[])
        return [self, replace(self, right=right, given_normals=True, chosen=[])]

    @cached_property
    def placed(self) -> Placed:
        """Theirs."""
        if self.right and self.model.places_of:
            return self.right.placed
        return self.model.placed(self.table)

    def some(self, index: Ints) -> tuple[Table, Placed]:
        """Some of the points; of a suspect that has them where they are, those of the right program."""
        if self.right and self.model.places_of and self.model.fetches_of:
            return self.right.some(index)
        if not self.chosen or not np.array_equal(self.chosen[0], index):
            points = self.table.take(index)
            self.chosen[:] = [index, points, self.model.placed(points)]
        return self.chosen[1], self.chosen[2]

    @property
    def fed(self) -> Table:
        """The points for a later stage: the port's, or where those cannot be computed with, the case's."""
        return self.table if self.table.usable.all() else self.model.own

    @cached_property
    def landed(self) -> Placed:
        """The points as the port has them, where it handed them in, else as they are."""
        own = self.placed if self.fed is self.table else self.model.own_places
        return landed(self.model, self.fed, own, self.handed)


def landed(model: Model, points: Table, own: Placed, handed: Handed) -> Placed:
    """A point is kept as the port's width says, or its window position; where these are NaN, it is not drawn."""
    given = {name: np.asarray(handed[name], np.float64) for name in PLACES if has(model, handed, name)}
    if not given:
        return own
    do, kept = model.machine, np.ones(len(points), np.bool_)
    for array in given.values():
        kept &= np.isfinite(array.reshape(len(kept), -1)).all(axis=1)
    window, depth, width = own.window, own.depth, own.width
    if "vertex.window" in given:
        window = [stored(do, c, x) for c, x in zip(given["vertex.window"].T, own.window, strict=True)]
    if "vertex.depth" in given:
        depth = stored(do, given["vertex.depth"], own.depth)
    if "vertex.width" in given:
        width = stored(do, given["vertex.width"], own.width)
        kept &= given["vertex.width"] > 0.0
    twins = _twins(model, points, given)
    return Placed(window, depth, width, kept, kept, twins, _gaussian(model, given, own), own.world)


def _gaussian(model: Model, given: dict[str, Floats], own: Placed) -> Number | None:
    """(V, 5) of ellipses, with what was handed in."""
    if own.gaussian is None:
        return None
    columns = own.gaussian.T
    for name, first in zip(GAUSSIAN, (0, 3, 4), strict=True):
        if name in given:
            found = given[name].reshape(len(columns[0]), -1).T
            for k, array in enumerate(found, first):
                columns[k] = stored(model.machine, array, columns[k])
    return joined_columns(columns)


def _twins(model: Model, points: Table, given: dict[str, Floats]) -> Ints | None:
    """(V,) for each point the first one that is the same: of the same pixel, depth and camera, and handed in the same.

    Whatever a device does, it does the same for both, so that they tie. None: the port's own numbers are not known.
    """
    if len(given) < len(PLACES if model.elliptic else PLACES[: -len(GAUSSIAN)]):
        return None
    cameras = [_seen_by(image.camera) for image in model.case.scene.images]
    if len(set(cameras)) == len(cameras):
        return None
    keys = np.array([cameras.index(camera) for camera in cameras])[points.image]
    columns = [keys, points.rows, points.columns, points.depth.value]
    columns += [array.reshape(len(keys), -1).T for array in given.values()]
    rows = np.ascontiguousarray(np.vstack(columns).T, np.float64)
    _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True, equal_nan=False)
    return np.asarray(first[inverse.reshape(-1)], np.int64)


def _seen_by(camera: Any) -> bytes:
    """What a point of a reference camera hangs on."""
    return b"".join(np.asarray(m, np.float64).tobytes() for m in (camera.world_from_view, camera.intrinsics))
