"""Two bugs together, where no single one explains a stage; and which one comes nearest, where no two do.

A pair is one program: a class that derives from both, so that it is tried where they override different methods. It is
named only if that leaves no element, each of the two is needed for as many as no chance explains, and shows by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ibr_ref.array_types import Bools
from ibr_ref.oracle.faults.kinds import Mutant, PlainPort
from ibr_ref.oracle.findings import Cause, Nearest
from ibr_ref.oracle.judgement import Explanation
from ibr_ref.oracle.programs.program import own_names
from ibr_ref.oracle.referees.suspects import MOST_ROWS, Inquiry, Left, Suspects, ranked

PROMISING, FIRST = 12, 3
"""Bugs by the gain at a few elements, and of these by that at some: the last are tried with every other."""
AND = " and "
"""Between the names of two bugs."""


class Likely(Protocol):
    """Of suspects those that are worth a judgement."""

    def __call__(self, suspects: Sequence[Mutant], *, partly: bool) -> Sequence[Mutant]:
        """partly: also those that can explain only a part."""


@dataclass(frozen=True, kw_only=True)
class Known:
    """What two are drawn from, and when they are believed."""

    right: type[PlainPort]
    """The right program."""
    pool: Sequence[Mutant]
    evidence: int
    """Elements for which each of the two is needed."""
    shows: Callable[[Mutant], bool]
    """By itself. What does not may turn another bug into one that is not known: nothing tells the two from that."""


def causes_of(mutants: Sequence[Mutant]) -> tuple[Cause, ...]:
    """As a verdict names them, once each."""
    return tuple({m.name: Cause(name=m.name, says=m.fault) for m in mutants}.values())


def composed(right: type[PlainPort], a: Mutant, b: Mutant, stage: str) -> Mutant | None:
    """A port with both bugs, wrong from that stage on.

    None where both override the same method, or take the same number for another.
    """
    if own_names(a.port, right) & own_names(b.port, right) or {*_taken(a)} & {*_taken(b)}:
        return None
    fields = {"taken": {**_taken(a), **_taken(b)}, "read_by": (*_read_by(a), *_read_by(b)), "__module__": __name__}
    kind = type("Both", (a.port, b.port), fields)
    return Mutant(name=f"{a.name}{AND}{b.name}", fault=f"{a.fault} {b.fault}", stage=stage, port=kind)


def _pair(inquiry: Inquiry, right: type[PlainPort], a: Mutant, b: Mutant) -> Mutant | None:
    return composed(right, a, b, min((a.stage, b.stage), key=inquiry.place))


def named_together(inquiry: Inquiry, right: type[PlainPort], mutants: Sequence[Mutant], name: str) -> Iterator[Mutant]:
    """The pairs of that name."""
    for a in mutants:
        if name.startswith(f"{a.name}{AND}"):
            others = (b for b in mutants if name == f"{a.name}{AND}{b.name}")
            yield from filter(None, (_pair(inquiry, right, a, b) for b in others))


def together(suspects: Suspects, known: Known, likely: Likely) -> Explanation:
    """The pairs that explain every element of a stage that no single one of the pool does; or the one that leaves least."""
    pool, limit = known.pool, suspects.spent + MOST_ROWS
    best = _best(suspects, likely(pool, partly=True), limit)
    found: dict[frozenset[str], Cause] = {}
    for first, left in best:
        if min(_count(left.nearer), _count(left.wrong & suspects.wrong)) < known.evidence:
            continue
        others = {
            pair: b
            for b in pool
            if b is not first and (pair := _pair(suspects.inquiry, known.right, first, b)) is not None
        }
        samples = suspects.samples_of(left.wrong, [left.wrong, left.nearer, ~suspects.wrong])
        survivors, _ = suspects.survivors(likely([*others], partly=False), samples, limit)
        for pair in survivors:
            second = others[pair]
            needed = _both_needed(suspects, pair, left, second, known.evidence)
            if needed and known.shows(first) and known.shows(second):
                names = first.name, second.name
                found.setdefault(frozenset(names), Cause(name=pair.name, says=pair.fault, together=names))
    nearest = None if found or not best else _nearest(suspects, *best[0])
    return Explanation(causes=tuple(found.values()), nearest=nearest)


def _best(suspects: Suspects, pool: Sequence[Mutant], limit: int) -> list[tuple[Mutant, Left]]:
    """The suspects of which the most is hoped, and what they leave of all elements; those that leave least first."""
    promising = ranked({mutant: suspects.promise.get(mutant, 0) for mutant in pool}, PROMISING)
    for sample in suspects.samples()[1:]:
        looked_at = _looked_at(suspects, promising, sample, limit, PROMISING)
        promising = ranked({mutant: left.gain for mutant, left in looked_at.items()}, PROMISING)
    known = _looked_at(suspects, promising, None, limit, FIRST)
    return sorted(((m, left) for m, left in known.items() if left.gain > 0), key=lambda pair: _count(pair[1].wrong))


def _looked_at(
    suspects: Suspects, mutants: Sequence[Mutant], among: Bools | None, limit: int, most: int
) -> dict[Mutant, Left]:
    """What they leave of the elements `among`, each of the first that contradict no stage before."""
    found: dict[Mutant, Left] = {}
    for mutant in mutants:
        if len(found) < most and suspects.spent < limit and (left := suspects.left(mutant, among)) is not None:
            found[mutant] = left
    return found


def _both_needed(suspects: Suspects, pair: Mutant, first: Left, second: Mutant, evidence: int) -> bool:
    """Whether both are for enough elements that they explain together for certain."""
    both, other = suspects.left(pair, None), suspects.left(second, None)
    if both is None:
        return False
    without = suspects.wrong if other is None else other.wrong
    return min(_count(both.sure & first.wrong), _count(both.sure & without)) >= evidence


def _nearest(suspects: Suspects, mutant: Mutant, left: Left) -> Nearest | None:
    """What it leaves, and the first element of that."""
    judgement, count = suspects.judgement, _count(left.wrong)
    if not 0 < count < _count(suspects.wrong):
        return None
    index = np.unravel_index(int(np.argmax(left.wrong)), judgement.wrong.shape)
    place = judgement.place(tuple(int(i) for i in index))
    return Nearest(name=mutant.name, says=mutant.fault, left=count, element=judgement.element, index=place)


def _count(flags: Any) -> int:
    return int(np.count_nonzero(flags))


def _taken(mutant: Mutant) -> Any:
    return getattr(mutant.port, "taken", {})


def _read_by(mutant: Mutant) -> Any:
    return getattr(mutant.port, "read_by", ())
