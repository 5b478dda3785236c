"""Which bug is it: the program of every known one is judged on the port's arrays as the right one is.

A bug is named only if no element contradicts it, and some that is wrong is certainly explained by it. Some dozens of
elements, right and wrong ones, are tried first; what explains them, on all. The right program with other numbers than the
case's is tried the same way: those that ports have by mistake, and where nothing explains a stage those that fit its
results, which the plain program finds. Where none of all these does, two of them may together (`pairs.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.colors import as_numbers
from ibr_ref.oracle.faults.kinds import Mutant, PlainPort
from ibr_ref.oracle.faults.taken import LOOKS_LIKE, Setting, suspects
from ibr_ref.oracle.faults.vectors import Vector
from ibr_ref.oracle.findings import Cause
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement, spread_out
from ibr_ref.oracle.referees.fitted import fitted, fitted_vector
from ibr_ref.oracle.referees.pairs import Known, Likely, causes_of, named_together, together
from ibr_ref.oracle.referees.suspects import MOST_ROWS, Inquiry, Suspects

EVIDENCE = 16
"""Of the dozens of numbers that are tried one explains a few elements by chance."""
LOOKED_AT = 256
"""Wrong elements, and right ones, at which a number is fitted; results that jump are looked at everywhere."""
SLACK = 16.0
"""How far a port's results may be from the plain ones where a number is fitted, in units of theirs; it is judged after."""


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """What a case has that a port may have otherwise, and how it is drawn then."""

    case: Case
    port: type[PlainPort]
    """The right program."""
    settings: Sequence[Setting]
    handed: Handed
    vectors: Sequence[Vector] = ()
    draw: Callable[[Any, Bools], Mapping[str, Any]] = lambda program, among: program.render()
    """A program's arrays, at least where elements are looked at."""
    evidence: int = EVIDENCE
    """Wrong elements from which on a number is believed."""

    def listed(self) -> list[Mutant]:
        """The right program with numbers and vectors that ports have by mistake."""
        of_vectors = [mutant for vector in self.vectors for mutant in vector.listed(self.port)]
        return [*suspects(self.port, self.case, self.settings), *of_vectors]

    def fitting(self, wrong: Judgement) -> Iterator[list[list[Mutant]]]:
        """And with those that its results look like: of each number some values, those of the fewest digits first."""
        flat = wrong.wrong.reshape(-1)
        every, some = np.ones_like(wrong.wrong), spread_out([flat, ~flat], LOOKED_AT).reshape(wrong.wrong.shape)
        continuous = [each for each in self.settings if not isinstance(each.value(self.case), int)]
        jumps = {each.jumps for each in continuous}
        first = {jump: self._drawn(self.port, wrong, every if jump else some) for jump in jumps}
        for setting in continuous:
            among = every if setting.jumps else some
            values = self._fitted(setting, wrong, among, first[setting.jumps])
            yield [setting.suspects(self.port, self.case, value, LOOKS_LIKE) for value in values]
        for vector in self.vectors:
            yield [vector.suspects(self.port, value, LOOKS_LIKE) for value in self._vectors(vector, wrong, some)]

    def recognizes(self, inquiry: Inquiry, wrong: Judgement, name: str) -> bool:
        """Whether the bug or the number of that name explains every element of a stage."""
        told, _, value = name.partition(LOOKS_LIKE)
        found = [
            mutant
            for setting in self.settings
            if value and setting.name == told
            for mutant in setting.suspects(self.port, self.case, float(value), LOOKS_LIKE)
        ]
        found += [mutant for vector in self.vectors for mutant in vector.of_name(self.port, name)]
        every, by = [*inquiry.mutants, *self.listed(), *found], Suspects(inquiry, wrong)
        alone = (mutant for mutant in every if mutant.name == name)
        return any(by.explains(mutant, None) for mutant in (*alone, *named_together(inquiry, self.port, every, name)))

    def shows(self, mutant: Mutant, wrong: Judgement) -> bool:
        """Whether a bug by itself changes results of a stage, as many as are evidence."""
        every = np.ones_like(wrong.wrong)
        plain, other = (self._drawn(kind, wrong, every) for kind in (self.port, mutant.port))
        if plain.shape != other.shape:
            return True
        with np.errstate(invalid="ignore"):
            apart = np.abs(plain - other) > SLACK * UNIT * np.abs(plain)
        return int(np.count_nonzero(apart | (np.isnan(plain) != np.isnan(other)))) >= self.evidence

    def _fitted(self, setting: Setting, wrong: Judgement, among: Bools, first: Floats) -> list[float]:
        def draw(value: float) -> Floats | None:
            allowed = setting.allows(self.case, value)
            return self._drawn(setting.port(self.port, value), wrong, among) if allowed else None

        target, slack = self._target(wrong, among)
        with np.errstate(all="ignore"):
            return fitted(float(setting.value(self.case)), first, draw, target, slack, jumps=setting.jumps)

    def _vectors(self, vector: Vector, wrong: Judgement, among: Bools) -> list[Floats]:
        def draw(value: Floats) -> Floats | None:
            return self._drawn(vector.port(self.port, value), wrong, among) if vector.allows(value) else None

        target, slack = self._target(wrong, among)
        with np.errstate(all="ignore"):
            return fitted_vector(vector.value, draw, target, slack)

    def _target(self, wrong: Judgement, among: Bools) -> tuple[Floats, Floats]:
        """(n,) what the port has of a stage, and how far that may be from plain results."""
        names = self._compared(wrong)
        return _row(self.handed, names, among), _slack(self.handed, names, among)

    def _drawn(self, kind: type[Any], wrong: Judgement, among: Bools) -> Floats:
        """(n,) what a program makes of a stage, in doubles."""
        with np.errstate(all="ignore"):
            program = kind(self.case.scene, self.case.params, Policy(float_bits=64), self.case.inputs)
            return _row(self.draw(program, among), self._compared(wrong), among)

    def _compared(self, wrong: Judgement) -> list[str]:
        return [name for name in wrong.arrays if name in self.handed and not isinstance(self.handed[name], tuple)]


def _all(suspects: Sequence[Mutant], *, partly: bool) -> Sequence[Mutant]:
    return suspects


def explained(
    inquiry: Inquiry, numbers: Numbers, wrong: Judgement, *tiers: Collection[str], likely: Likely = _all
) -> Explanation:
    """The bugs and the numbers that explain every element of a stage; where none does, pairs of them, or what comes nearest.

    tiers: of stages; those of the first are named that has some.
    """
    suspects, enough = Suspects(inquiry, wrong), wrong.wrong.sum() >= numbers.evidence

    def tried(mutants: Sequence[Mutant]) -> Explanation:
        return _first_tier(suspects, likely(mutants, partly=False), tiers)

    def first(values: Sequence[Sequence[Mutant]]) -> tuple[Cause, ...]:
        return next((causes for each in values if (causes := tried(each).causes)), ())

    found, listed = tried(inquiry.mutants), numbers.listed() if enough else []
    causes = [*found.causes, *tried(listed).causes] if enough else [*found.causes]
    if not causes and enough:
        causes = [cause for values in numbers.fitting(wrong) for cause in first(values)]
    if causes or found.given_up_after is not None:
        return replace(found, causes=tuple(causes))
    stages = {stage for tier in tiers for stage in tier}
    pool = [mutant for mutant in (*inquiry.mutants, *listed) if mutant.stage in stages]
    known = Known(right=numbers.port, pool=pool, evidence=numbers.evidence, shows=lambda m: numbers.shows(m, wrong))
    return together(suspects, known, likely)


def _first_tier(suspects: Suspects, mutants: Sequence[Mutant], tiers: Sequence[Collection[str]]) -> Explanation:
    """Those of the first tier that has some."""
    limit, tried = suspects.spent + MOST_ROWS, 0

    def count() -> None:
        nonlocal tried
        tried += 1

    for stages in tiers:
        of_it = [mutant for mutant in mutants if mutant.stage in stages]
        found, whole = suspects.survivors(of_it, suspects.samples(), limit, count)
        if found or not whole:
            return Explanation(causes=causes_of(found), given_up_after=None if whole else tried)
    return Explanation(causes=())


def _some(array: Any, among: Bools) -> Any:
    """Of an array's elements, where they are those that are judged; else all."""
    array = np.asarray(array)
    return array[among] if array.shape[: among.ndim] == among.shape else array


def _row(arrays: Mapping[str, Any], names: Sequence[str], among: Bools) -> Floats:
    """(n,) the numbers of arrays, colours from 0 to 1."""
    return np.concatenate([np.zeros(0), *(as_numbers(_some(arrays[name], among)).reshape(-1) for name in names)])


def _slack(arrays: Mapping[str, Any], names: Sequence[str], among: Bools) -> Floats:
    """(n,) how far they may be from plain ones."""
    some = [_some(arrays[name], among) for name in names]
    rows = [
        np.full(x.size, 0.5 / 255.0) if x.dtype == np.uint8 else SLACK * UNIT * np.fmax(np.abs(x.reshape(-1)), UNIT)
        for x in some
    ]
    return np.concatenate([np.zeros(0), *rows])
