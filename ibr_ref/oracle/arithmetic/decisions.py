"""Decisions that may go either way: a lane takes one outcome where it is needed, and a fork of it runs the program again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ibr_ref.affine.rows import SLOPES
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.arithmetic.number import Number, Truth
from ibr_ref.oracle.arithmetic.runs import MOST_DECISIONS, Runs
from ibr_ref.oracle.arithmetic.symbols import all_of, flat, over_symbols, together, united

MOST_PATHS = 64
"""Paths of one lane; beyond, it is lost: whatever a port makes of it is accepted, and it counts as undecided."""

Outcomes = dict[str, Any]
"""Results, a row for each path of each lane, with "origin", the lane's number."""


class Decisions(Runs):
    """The outcomes of a program's decisions on many lanes, and what is left to be run again."""

    def __init__(self) -> None:
        super().__init__()
        self.journal: list[tuple[str, Any]] | None = None

    @staticmethod
    def lane(*operands: Any) -> Any:
        """The lanes that operands share."""
        return next((x.lane for x in operands if x.lane is not None), None)

    def combined(self, operation: Callable[..., Floats], a: Number, b: Number, *arguments: Any) -> Number:
        """What a compiled operation on two numbers gives."""
        shape = together(a.shape, b.shape)
        names, at_a, at_b = united(a.names, b.names)
        rows = operation(flat(a.rows, shape), flat(b.rows, shape), at_a, at_b, *arguments)
        if len(shape) != 1:
            rows = rows.reshape(len(rows), *shape)
        return Number.of_rows(self, rows, names[: len(rows) - SLOPES], a.lane if a.lane is not None else b.lane)

    def begin(self, origin: Ints) -> None:
        """Start a program on lanes of which nothing is decided yet."""
        self.run.begin(origin)

    def told(self, step: str, x: Any) -> Any:
        """What a trace tells of: written down where one is kept."""
        if self.journal is not None:
            self.journal.append((step, x))
        return x

    def decide(self, truth: Truth) -> Bools:
        """Outcomes; the lanes where both are possible take the given one, or true, and leave false to a fork."""
        may, must = np.broadcast_arrays(truth.may, truth.must)
        outcome = np.array(must, np.bool_)
        is_open = may & ~must
        if truth.lane is None:  # of the whole case, not of a lane: as the values have it
            return np.where(is_open, True if truth.margin is None else truth.margin > 0.0, must)
        rows = np.flatnonzero(is_open)
        if not len(rows):
            return outcome
        run, lane = self.run, truth.lane[rows]
        full = run.asked[lane] >= MOST_DECISIONS
        run.lost[lane[full]], outcome[rows[full]] = True, True
        rows, lane = rows[~full], lane[~full]
        at = run.asked[lane]
        fresh = at >= run.known[lane]
        new, place = lane[fresh], at[fresh]
        if len(new):
            other = run.taken[new].copy()
            other[np.arange(len(new)), place] = False
            run.forks.append((run.origin[new], other, place + 1))
            run.taken[new, place], run.known[new] = True, place + 1
        outcome[rows] = run.taken[lane, at]
        run.asked[lane] += 1
        return outcome

    def follow(self, program: Callable[[Ints], dict[str, Any]], count: int) -> tuple[Outcomes, Ints]:
        """All legal outcomes of a program of lane origins, with "origin"; and the lanes that are lost."""
        run, origin, taken, known = self.run, np.arange(count), None, None
        names, run.following = run.names, True
        paths, lost, parts = np.zeros(count, np.int64), np.zeros(count, np.bool_), []
        while True:
            run.begin(origin, taken, known)
            run.rows += len(origin)
            run.names = dict(names)  # another run's symbols have other names, a fork's the same
            parts.append({"origin": origin, **program(origin)})
            lost[origin[run.lost]] = True
            paths += np.bincount(origin, minlength=count)
            if not run.forks:
                break
            origin, taken, known = (np.concatenate(each) for each in zip(*run.forks, strict=True))
            lost |= paths + np.bincount(origin, minlength=count) > MOST_PATHS
            origin, taken, known = (each[~lost[origin]] for each in (origin, taken, known))
            if not len(origin):
                break
        run.following = False
        outcomes = {name: joined([part[name] for part in parts]) for name in parts[0]}
        return outcomes, np.flatnonzero(lost)


def joined(parts: list[Any]) -> Any:
    """Rows one after the other: arrays, numbers, or lists of numbers."""
    if len(parts) == 1:
        return parts[0]
    if isinstance(parts[0], list):
        return [joined(list(each)) for each in zip(*parts, strict=True)]
    if not isinstance(parts[0], Number):
        return np.concatenate(parts)

    names = all_of(*(part.names for part in parts))
    rows = np.concatenate([over_symbols(part.rows, part.names, names) for part in parts], axis=1)
    return Number.of_rows(parts[0].do, rows, names, None)
