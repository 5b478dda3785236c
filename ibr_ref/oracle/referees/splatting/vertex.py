"""Stage vertex: replayed from the port's atlas, or from the case's own depths and colours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import TINY, UNIT, Device
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.reads import fed
from ibr_ref.oracle.referees.splatting.lighting import Shades, shades
from ibr_ref.oracle.referees.splatting.place import Placed, placed
from ibr_ref.oracle.referees.splatting.table import Table, table
from ibr_ref.oracle.referees.splatting.verdict import judgement
from ibr_ref.splatting.contract import STAGES

ARRAYS = ("vertex.source", "vertex.window", "vertex.depth", "vertex.width", "vertex.color")
"""In order of computation: the law of the width is taken at the distance of a point that has been placed."""
LEADERS = ("vertex.width", "vertex.window", "vertex.depth")
"""What tells whether the port has kept a point: the first of them that it handed in."""


def judge(case: Case, device: Device, handed: Handed) -> Judgement:
    """Every point: dropped or kept, with all its numbers; and lit, with its highlight or without."""
    points = table(case, device, handed)
    where = placed(case, device, points)
    kept, decisions = outcomes(where, handed)
    bad = {name: kept[name] for name in ARRAYS if name in kept}
    width = np.full(len(points.rows), np.nan)
    for name, bounds in numbers(where).items():
        if name in handed:
            for bound in bounds:
                width = np.fmax(width, np.where(where.kept, 2.0 * bound.error, np.nan))
    undecided = where.doubtful.copy() if decisions else np.zeros(len(width), np.bool_)
    if "vertex.source" in handed:
        bad["vertex.source"] = wrong_source(points, handed)
    if "vertex.color" in handed:
        found = np.asarray(handed["vertex.color"], np.float64)
        lit = [(table, shades(case, device, where.world, table.codes, table.albedo)) for table in points.lightings]
        wrong = [wrong_color(colors, found) & points.usable for _, colors in lit]
        best = min(range(len(lit)), key=lambda i: int(wrong[i].sum()))
        (points, colors), bad["vertex.color"] = lit[best], wrong[best]
        undecided |= colors.split & (np.abs(colors.color.value - colors.other.value).max(axis=1) > 1.0 / 255.0)
        width = np.fmax(width, 2.0 * colors.color.error.max(axis=1))
    ordered = {name: bad[name] & points.usable for name in ARRAYS if name in bad}
    return judgement("vertex", "vertex", ordered, undecided, width, fed("splatting", ordered, handed))


def numbers(where: Placed) -> dict[str, tuple[Bounded, ...]]:
    """The stage's continuous arrays but for the colour, column by column."""
    return {"vertex.window": (where.x, where.y), "vertex.depth": (where.depth,), "vertex.width": (where.width,)}


def outcomes(where: Placed, handed: Handed) -> tuple[dict[str, Bools], bool]:
    """Arrays that contradict both outcomes, kept and dropped; and whether there are any that a decision shows in.

    Where both outcomes are legal, the port's own width, or else its window, tells which one it is held to.
    """
    given = {name: np.asarray(handed[name], np.float64) for name in numbers(where) if name in handed}
    if not given:
        return {}, False
    leader = next(name for name in LEADERS if name in given)
    says = given[leader] > 0.0 if leader == "vertex.width" else np.isfinite(_rows(given[leader])).any(axis=1)
    kept = np.where(where.doubtful, says, where.kept)
    bad = {}
    for name, bounds in numbers(where).items():
        if name in given:
            found = _rows(given[name])
            within = np.logical_and.reduce([bound.allows(found[:, k]) for k, bound in enumerate(bounds)])
            left = STAGES[name].left
            dropped = ((found == left) | (np.isnan(found) & np.isnan(left))).all(axis=1)
            bad[name] = ~np.where(kept, within & np.isfinite(found).all(axis=1), dropped)
    return bad, True


def _rows(array: NDArray[np.float64]) -> NDArray[np.float64]:
    return array.reshape(len(array), -1)


def wrong_source(points: Table, handed: Handed) -> Bools:
    """Image, row, column, as integers."""
    images = np.repeat(np.arange(len(points.starts) - 1), np.diff(points.starts))
    expected = np.stack([images, points.rows, points.columns], axis=1)
    return np.asarray((np.asarray(handed["vertex.source"]) != expected).any(axis=1), np.bool_)


def wrong_color(colors: Shades, found: NDArray[np.float64]) -> Bools:
    """All channels must agree with the same branch."""
    agrees = np.zeros(len(found), np.bool_)
    for color, legal in colors.branches:
        # Stored as a float32 once more; what is less than a normal number is 0 where denormals are flushed.
        agrees |= legal & color.widened(UNIT * np.abs(color.value) + TINY).allows(found).all(axis=1)
    return ~agrees
