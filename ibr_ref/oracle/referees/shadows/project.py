"""Stage project: where a fragment is on the map, and what the map may say of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded, converted
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.referees.shadows.enclosed import enclosed
from ibr_ref.oracle.referees.shadows.footprint import reads
from ibr_ref.oracle.referees.shadows.maps import Map
from ibr_ref.oracle.referees.shadows.model import Model
from ibr_ref.oracle.referees.shadows.transform import centered


@dataclass(frozen=True, eq=False)
class Coordinate:
    """(n,) s, t and r (clamped), and q_w."""

    s: Bounded
    t: Bounded
    r: Bounded
    w: Bounded
    spoiled: Bools
    """(n,) the port's own is no number."""

    @property
    def axes(self) -> tuple[Bounded, Bounded, Bounded]:
        """s, t, r."""
        return self.s, self.t, self.r


@dataclass(frozen=True, eq=False)
class Shadow:
    """(n,) what one light sample's map may say: a range, and perhaps another."""

    first: Bounded
    """With every decision as exact arithmetic makes it."""
    other: Bounded
    """All that it may be with another outcome of some of them."""
    open: Bools
    """Whether that is legal."""
    spoiled: Bools
    """What it is made of is no number, or there were too many outcomes to follow: anything is legal."""
    fragment: Ints
    """(m,) of each outcome."""
    outcome: Bounded
    """(m,)."""

    def allows(self, found: Floats) -> Bools:
        """Whether a port's number is legal."""
        legal = np.array(self.spoiled)
        legal[self.fragment[self.outcome.allows(found[self.fragment])]] = True
        return legal


def coordinate(model: Model, sample: int, world: Sequence[Bounded]) -> Coordinate:
    """Of fragments (n,), on the map of a sample."""
    program = model.program
    with np.errstate(all="ignore"):
        found = program.coordinates(model.numbers(world, "world"), program.places[sample])
    s, t, r, w = (model.bounded(x) for x in found)
    return Coordinate(s, t, r, w, np.zeros(len(w.value), np.bool_))


def handed(found: Floats, legal: Coordinate) -> Coordinate:
    """The port's own coordinates (n, 3), besides those that are legal; a projective fetch divides by q_w once more."""
    usable = np.isfinite(found)
    s, t, r = (
        converted(np.where(usable[:, k], found[:, k], 0.0), legal.w.device, own) for k, own in enumerate(legal.axes)
    )
    return Coordinate(s, t, r, legal.w, np.asarray(~usable.all(axis=1)))


def shadow(model: Model, texels: Map, at: Coordinate, caster: Bools) -> Shadow:
    """What the map says of fragments; caster (n,): they are the caster's own."""
    axes = [at.s, at.t, at.r, at.w]
    exact = np.asarray(model.exact.shadowed(texels.firm.value, [axis.value for axis in axes], caster), np.float64)
    found = outcomes_of(
        model, texels, at, lambda program, image, places, rows: program.shadowed(image, places, caster[rows])
    )
    spoiled = np.zeros(len(caster), np.bool_)
    spoiled[found.lost] = True
    return _ordered(found.fragment, found.outcome, exact, spoiled)


class Outcomes(NamedTuple):
    """What a program makes of a map."""

    fragment: Ints
    """(m,) of each outcome."""
    outcome: Bounded
    """(m,)."""
    lost: Ints
    """Fragments of which anything is legal."""
    enclosed: Ints
    """Fragments that have one outcome around all others."""


def outcomes_of(model: Model, texels: Map, at: Coordinate, steps: Callable[[Any, Any, Any, Ints], Any]) -> Outcomes:
    """steps(program, image, places, rows) makes one number of each of the fragments `rows`."""
    axes, every = [at.s, at.t, at.r, at.w], np.arange(len(at.spoiled))
    runs = [_followed(model, model.program, texels.firm, axes, every, steps)]
    open_texels = (texels.low < texels.firm.low) | (texels.high > texels.firm.high)
    soft = model.program.soft  # whose regions are anywhere around
    if open_texels.any():
        near = every if soft else np.flatnonzero(reads(open_texels, at.s, at.t))
        image = centered(texels.low, texels.high, at.s.device)
        runs.append(_followed(model, model.program, image, axes, near, steps))
    many = np.unique(np.concatenate([run[2] for run in runs]))
    if soft and len(many):
        runs = [(*run[:2], many[:0]) for run in runs]
        runs.append(_followed(model, enclosed(model, texels), texels.drawn, axes, many, steps))
    fragment = np.concatenate([run[0] for run in runs])
    found = [model.bounded(run[1]) for run in runs]
    value, error = np.concatenate([x.value for x in found]), np.concatenate([x.error for x in found])
    lost = np.array(at.spoiled)
    if texels.spoiled.any():
        lost |= True if soft else reads(texels.spoiled, at.s, at.t)
    lost[np.concatenate([run[2] for run in runs])] = True
    return Outcomes(fragment, Bounded(value, error, at.s.device), np.flatnonzero(lost), many)


def _followed(
    model: Model,
    program: Any,
    image: Bounded,
    axes: Sequence[Bounded],
    among: Ints,
    steps: Callable[[Any, Any, Any, Ints], Any],
) -> tuple[Ints, Number, Ints]:
    """Fragments and outcomes, and the fragments that have too many."""
    machine, texels = model.machine, model.number(image)

    def run(origin: Ints) -> dict[str, Any]:
        lane, rows = np.arange(len(origin)), among[origin]
        at = [model.number(axis[rows], lane) for axis in axes]
        return {"found": machine.of(steps(program, texels, at, rows))}

    with np.errstate(all="ignore"):
        found, lost = machine.follow(run, len(among))
    return among[found["origin"]], found["found"], among[lost]


def _ordered(fragment: Ints, outcome: Bounded, exact: Floats, spoiled: Bools) -> Shadow:
    """Outcomes with the likeliest apart: that which exact arithmetic has, or the nearest."""
    count = len(exact)
    away = np.where(outcome.allows(exact[fragment]), -1.0, 0.0) + np.abs(outcome.value - exact[fragment])
    order = np.lexsort((np.nan_to_num(away, nan=np.inf), fragment))
    fresh = np.r_[True, np.diff(fragment[order]) > 0] if len(order) else np.zeros(0, np.bool_)
    first = np.zeros(count, np.int64)
    first[fragment[order[fresh]]] = order[fresh]
    rest = order[~fresh]
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, fragment[rest], outcome.low[rest])
    np.maximum.at(high, fragment[rest], outcome.high[rest])
    open_ = low <= high
    likeliest = outcome[first]
    other = centered(np.where(open_, low, likeliest.low), np.where(open_, high, likeliest.high), outcome.device)
    return Shadow(likeliest, other, open_, spoiled, fragment, outcome)
