"""Which bug is it: the program of every known one is judged on the port's arrays as the right one is.

A bug is named only if no element contradicts it, and some that is wrong is certainly explained by it. Some dozens of
elements, right and wrong ones, are tried first; what explains them, on all. The right program with other numbers than the
case's is tried the same way: those that ports have by mistake, and where nothing explains a stage those that fit its
results, which the plain program finds.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.faults.kinds import Mutant, PlainPort
from ibr_ref.oracle.faults.taken import LOOKS_LIKE, Setting, suspects
from ibr_ref.oracle.findings import Cause
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement
from ibr_ref.oracle.referees.fitted import fitted

FEW, SOME = 6, 40
"""Wrong elements that are tried first, up to twice as many; and next, with as many right ones."""
MOST_ROWS = 100_000
"""Of programs that are run in all, forks too; what is not tried by then is not named, and the verdict says so."""
EVIDENCE = 16
"""Of the dozens of numbers that are tried one explains a few elements by chance."""
LOOKED_AT = 256
"""Wrong elements, and right ones, at which a number is fitted; results that jump are looked at everywhere."""
SLACK = 16.0
"""How far a port's results may be from the plain ones where a number is fitted, in units of theirs; it is judged after."""


class Replay(Protocol):
    """A port's stages, judged by one program."""

    @property
    def cost(self) -> int:
        """Of what was judged so far, setting up and all, in rows of a program as long as a march."""

    def names(self, stage: str) -> tuple[str, ...]:
        """What of a stage was handed in."""

    def judge(self, stage: str) -> Judgement:
        """One stage."""


@dataclass(frozen=True, kw_only=True)
class Inquiry:
    """What a method's known bugs are, and how they are judged."""

    mutants: Sequence[Mutant]
    arrays: Mapping[str, tuple[str, ...]]
    """For each stage, in the pipeline's order, those that are compared in it; of the last, and of "image", none need be."""
    replay: Callable[[type[Any], Bools | None], Replay]
    """By a program, of all elements or of those `among`."""
    sampled: Collection[str]
    """The stages of which some elements are sooner judged than all."""

    def before(self, stage: str, mutant: Mutant) -> list[str]:
        """The stages that a bug may contradict before that one: from its own on. A picture by itself is resolve's too."""
        order = [*self.arrays]
        last = order.index("resolve" if stage == "image" else stage)
        return order[min(order.index(mutant.stage), last) : last]

    def hidden_in(self, stage: str, handed: Handed) -> list[str]:
        """Stages whose bugs this one may show: those before it of which not all is handed in, up to one that is whole."""
        order = [*self.arrays]
        at, found = order.index(stage), []
        while at and not all(name in handed for name in self.arrays[order[at - 1]]):
            at -= 1
            found.append(order[at])
        return found

    def causes(self, wrong: Judgement, *tiers: Collection[str]) -> Explanation:
        """The bugs that explain every element of a stage: those of the first of the tiers of stages that has some."""
        suspects, tried = _Suspects(self, wrong), 0
        for stages in tiers:
            left = [m for m in self.mutants if m.stage in stages]
            for number, sample in enumerate((*suspects.samples(), None)):
                survivors: list[Mutant] = []
                for mutant in left:
                    if suspects.spent >= MOST_ROWS:
                        found = tuple(survivors) if sample is None else ()
                        return Explanation(causes=_named(found), given_up_after=tried)
                    tried += number == 0
                    if suspects.explains(mutant, sample):
                        survivors.append(mutant)
                left = survivors
            if left:
                return Explanation(causes=_named(left))
        return Explanation(causes=())

    def recognizes(self, wrong: Judgement, name: str) -> bool:
        """Whether the suspect of that name explains every element of a stage; one that there is not explains none."""
        suspects = _Suspects(self, wrong)
        return any(suspects.explains(mutant, None) for mutant in self.mutants if mutant.name == name)


def _named(mutants: Sequence[Mutant]) -> tuple[Cause, ...]:
    return tuple({m.name: Cause(name=m.name, says=m.fault) for m in mutants}.values())


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """What a case has that a port may have otherwise, and how it is drawn then."""

    case: Case
    port: type[PlainPort]
    """The right program."""
    settings: Sequence[Setting]
    handed: Handed
    draw: Callable[[Any, Bools], Mapping[str, Any]] = lambda program, among: program.render()
    """A program's arrays, at least where elements are looked at."""
    evidence: int = EVIDENCE
    """Wrong elements from which on a number is believed."""

    def listed(self) -> list[Mutant]:
        """The right program with numbers that ports have by mistake."""
        return suspects(self.port, self.case, self.settings)

    def fitting(self, wrong: Judgement) -> Iterator[list[list[Mutant]]]:
        """And with those that its results look like: of each number some values, those of the fewest digits first."""
        every, some = np.ones_like(wrong.wrong), _spread_out(wrong.wrong)
        continuous = [each for each in self.settings if not isinstance(each.value(self.case), int)]
        jumps = {each.jumps for each in continuous}
        first = {jump: self._drawn(self.port, wrong, every if jump else some) for jump in jumps}
        for setting in continuous:
            among = every if setting.jumps else some
            values = self._fitted(setting, wrong, among, first[setting.jumps])
            yield [setting.suspects(self.port, self.case, value, LOOKS_LIKE) for value in values]

    def recognizes(self, inquiry: Inquiry, wrong: Judgement, name: str) -> bool:
        """Whether the bug or the number of that name explains every element of a stage."""
        told, _, value = name.partition(LOOKS_LIKE)
        found = [
            mutant
            for setting in self.settings
            if value and setting.name == told
            for mutant in setting.suspects(self.port, self.case, float(value), LOOKS_LIKE)
        ]
        return replace(inquiry, mutants=[*inquiry.mutants, *self.listed(), *found]).recognizes(wrong, name)

    def _fitted(self, setting: Setting, wrong: Judgement, among: Bools, first: Floats) -> list[float]:
        def draw(value: float) -> Floats | None:
            allowed = setting.allows(self.case, value)
            return self._drawn(setting.port(self.port, value), wrong, among) if allowed else None

        names = self._compared(wrong)
        target, slack = _row(self.handed, names, among), _slack(self.handed, names, among)
        with np.errstate(all="ignore"):
            return fitted(float(setting.value(self.case)), first, draw, target, slack, jumps=setting.jumps)

    def _drawn(self, kind: type[Any], wrong: Judgement, among: Bools) -> Floats:
        """(n,) what a program makes of a stage, in doubles."""
        with np.errstate(all="ignore"):
            program = kind(self.case.scene, self.case.params, Policy(float_bits=64), self.case.inputs)
            return _row(self.draw(program, among), self._compared(wrong), among)

    def _compared(self, wrong: Judgement) -> list[str]:
        return [name for name in wrong.arrays if name in self.handed and not isinstance(self.handed[name], tuple)]


def explained(
    inquiry: Inquiry,
    numbers: Numbers,
    wrong: Judgement,
    *tiers: Collection[str],
    likely: Callable[[Sequence[Mutant]], Sequence[Mutant]] = lambda suspects: suspects,
) -> Explanation:
    """The bugs and the numbers that explain every element of a stage.

    likely: of suspects those that are worth a judgement.
    """

    def tried(suspects: Sequence[Mutant]) -> Explanation:
        return replace(inquiry, mutants=likely(suspects)).causes(wrong, *tiers)

    def first(values: Sequence[Sequence[Mutant]]) -> tuple[Cause, ...]:
        return next((causes for each in values if (causes := tried(each).causes)), ())

    found = tried(inquiry.mutants)
    if wrong.wrong.sum() < numbers.evidence:
        return found
    causes = [*found.causes, *tried(numbers.listed()).causes]
    if not causes:
        causes = [cause for values in numbers.fitting(wrong) for cause in first(values)]
    return replace(found, causes=tuple(causes))


def _spread_out(wrong: Bools) -> Bools:
    """Wrong elements and right ones, from everywhere."""
    among = np.zeros(wrong.size, np.bool_)
    for some in (np.flatnonzero(wrong), np.flatnonzero(~wrong)):
        among[some[:: max(1, len(some) // LOOKED_AT)]] = True
    return among.reshape(wrong.shape)


def _some(array: Any, among: Bools) -> Any:
    """Of an array's elements, where they are those that are judged; else all."""
    array = np.asarray(array)
    return array[among] if array.shape[: among.ndim] == among.shape else array


def _row(arrays: Mapping[str, Any], names: Sequence[str], among: Bools) -> Floats:
    """(n,) the numbers of arrays, colours from 0 to 1."""
    some = [_some(arrays[name], among) for name in names]
    rows = [x.astype(np.float64).reshape(-1) / (255.0 if x.dtype == np.uint8 else 1.0) for x in some]
    return np.concatenate([np.zeros(0), *rows])


def _slack(arrays: Mapping[str, Any], names: Sequence[str], among: Bools) -> Floats:
    """(n,) how far they may be from plain ones."""
    some = [_some(arrays[name], among) for name in names]
    rows = [
        np.full(x.size, 0.5 / 255.0) if x.dtype == np.uint8 else SLACK * UNIT * np.fmax(np.abs(x.reshape(-1)), UNIT)
        for x in some
    ]
    return np.concatenate([np.zeros(0), *rows])


class _Suspects:
    """What the programs of bugs make of a port's stage."""

    def __init__(self, inquiry: Inquiry, wrong: Judgement) -> None:
        self.inquiry, self.stage, self.wrong = inquiry, wrong.stage, wrong.wrong.reshape(-1)
        self.spent = 0

    def samples(self) -> list[Bools | None]:
        """A few wrong elements, some with right ones among them."""
        if self.stage not in self.inquiry.sampled:
            return []
        off, on = np.flatnonzero(self.wrong), np.flatnonzero(~self.wrong)
        few, some = np.zeros((2, len(self.wrong)), np.bool_)
        few[off[:: max(1, len(off) // FEW)][: 2 * FEW]] = True
        some[off[:: max(1, len(off) // SOME)][: 2 * SOME]] = True
        some[on[:: max(1, len(on) // SOME)][: 2 * SOME]] = True
        return [few, some]

    def explains(self, mutant: Mutant, among: Bools | None) -> bool:
        """Whether a program contradicts no element `among`; of all elements, it must certainly explain a wrong one too.

        Nor may it in the stages from its bug on: what a wrong program takes for no input at all is not judged.
        """
        replay = self.inquiry.replay(mutant.port, among)
        with np.errstate(all="ignore"):
            result = self._explained(replay, mutant, among)
        self.spent += replay.cost
        return result

    def _explained(self, replay: Replay, mutant: Mutant, among: Bools | None) -> bool:
        for stage in self.inquiry.before(self.stage, mutant):
            if replay.names(stage) and replay.judge(stage).wrong.any():
                return False
        judgement = replay.judge(self.stage)
        if judgement.wrong.size != len(self.wrong):  # it has another number of elements
            return not judgement.wrong.any()
        sure = among is not None or (self.wrong & ~judgement.undecided.reshape(-1)).any()
        return bool(sure and not judgement.wrong.any())
