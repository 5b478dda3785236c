"""Replay of stage project where one map is softened: coordinates, blockers, penumbrae, shadows, each from those before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import stored
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.maps import VISIBLE
from ibr_ref.oracle.referees.shadows.project import Coordinate, Outcomes, handed, outcomes_of

NAMES = ("project.coord", "project.blocker", "project.penumbra", "project.shadow")


class Agreement(NamedTuple):
    """Of arrays in their order, up to the first that is refuted, by their names."""

    legal: dict[str, Bools]
    """(n,) whether fragments may have what the port has."""
    nothing: dict[str, Bools]
    """(H W,) whether pixels have what is where nothing is."""
    undecided: Bools
    """(H W,)."""
    width: Floats
    """(H W,) of what is legal."""


Steps = Callable[[Any, Any, Any, Ints], Any]
"""Of the program, the map, where fragments are on it, and which: what one array has of them."""


def agreement(given: Inputs, names: list[str], fragments: Bools, bare: Bools) -> Agreement:
    """Of each fragment that a pixel may show; fragments (n,) and pixels (H W,) are those that the port's depth leaves."""
    seen, pixel = given.seen, given.seen.pixel
    undecided, width = seen.wild.copy(), np.zeros(len(seen.empty))
    legal, nothing = {}, {}
    for name in names:
        own = found_of(given, name)
        agrees, off, open_ = fragments_of(given, name, own[pixel])
        legal[name] = fragments & agrees
        nothing[name] = bare & (own.reshape(len(own), -1) == 0.0).all(axis=1)
        undecided[pixel[open_]] = True
        np.maximum.at(width, pixel, off)
        if given.refuted(seen.any_of(pixel, legal[name], nothing[name])):
            break
    return Agreement(legal, nothing, undecided, width)


def found_of(given: Inputs, name: str) -> Floats:
    """(H W, ...) the port's own array."""
    array = np.asarray(given.handed[name]).astype(np.float64)
    return array.reshape(array.shape[0] * array.shape[1], *array.shape[2:])


def fragments_of(given: Inputs, name: str, found: Floats) -> tuple[Bools, Floats, Bools]:
    """(n,) each: whether what a port has of fragments is legal, how wide that is, and whether another outcome shows."""
    if name == "project.coord":
        at = given.coordinate(0)
        legal = np.logical_and.reduce([axis.allows(found[:, k]) for k, axis in enumerate(at.axes)])
        off = np.max([np.broadcast_to(2.0 * axis.error, legal.shape) for axis in at.axes], axis=0)
        return legal, off, np.zeros(len(legal), np.bool_)
    fragment, outcome, lost, enclosed = outcomes(given, name)
    legal = np.zeros(len(found), np.bool_)
    legal[fragment[outcome.allows(found[fragment])]] = True
    legal[lost] = True
    low, high, off = np.full(len(found), np.inf), np.full(len(found), -np.inf), np.zeros(len(found))
    np.minimum.at(low, fragment, outcome.low)
    np.maximum.at(high, fragment, outcome.high)
    np.maximum.at(off, fragment, np.broadcast_to(2.0 * outcome.error, outcome.value.shape))
    open_ = high - low > off + VISIBLE
    open_[enclosed] = (high - low > VISIBLE)[enclosed]
    open_[lost] = True
    return legal, off, open_


def place(given: Inputs) -> Coordinate:
    """Where fragments are on the map: the port's own, or as they are made."""
    at = given.coordinate(0)
    return at if "project.coord" not in given.handed else handed(found_of(given, "project.coord")[given.seen.pixel], at)


def outcomes(given: Inputs, name: str) -> Outcomes:
    """Of an array, made from the port's own ones."""
    at = place(given)
    return outcomes_of(given.model, given.map(0), at, _steps(given, name))


def _steps(given: Inputs, name: str) -> Steps:
    """How an array follows from the nearest ones before it that the port has handed in."""
    seen, own = given.seen, {}
    for other in NAMES[1 : NAMES.index(name)]:
        if other in given.handed:
            found = found_of(given, other)[seen.pixel]
            if np.isfinite(found).all():
                own[other] = found
    index = NAMES.index(name) - 1

    def steps(program: Any, texels: Any, at: Any, rows: Ints) -> Any:
        casts = seen.caster[rows]
        if not own or name == "project.blocker":
            return program.softened(texels, at, casts)[index]
        return _from_own(given, program, texels, at, rows, own, name)

    return steps


def _from_own(given: Inputs, program: Any, texels: Any, at: Any, rows: Ints, own: dict[str, Floats], name: str) -> Any:
    """Lit is what has no blocker; the rest from the port's own blockers or penumbrae."""
    first = own.get("project.blocker", own.get("project.penumbra"))
    assert first is not None
    some = np.flatnonzero(first[rows] != 0.0)
    lane = np.arange(len(rows))[some]

    def number(other: str) -> Any:
        return given.model.number(stored(own[other][rows[some]], given.device), lane)

    r = at[2][some]
    if name == "project.penumbra":
        return program.do.spread(program.penumbra(number("project.blocker"), r), some, len(rows), 0.0)
    scale = number("project.penumbra") if "project.penumbra" in own else program.penumbra(number("project.blocker"), r)
    shadow = program.percentage(texels, [x[some] for x in at[:3]], scale)
    return program.do.spread(shadow, some, len(rows), 0.0)
