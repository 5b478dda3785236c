"""Which bug is it: the program of every known one is judged on the port's arrays as the right one is.

A bug is named only if no element contradicts it, and some that is wrong is certainly explained by it. Some dozens of
elements, right and wrong ones, are tried first; what explains them, on all.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ibr_ref.array_types import Bools
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.findings import Cause
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement

FEW, SOME = 6, 40
"""Wrong elements that are tried first, up to twice as many; and next, with as many right ones."""
MOST_ROWS = 100_000
"""Of programs that are run in all, forks too; what is not tried by then is not named, and the verdict says so."""


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
        """Whether the bug of that name explains every element of a stage; one that there is not explains none."""
        suspects = _Suspects(self, wrong)
        return any(suspects.explains(mutant, None) for mutant in self.mutants if mutant.name == name)


def _named(mutants: Sequence[Mutant]) -> tuple[Cause, ...]:
    return tuple(Cause(name=m.name, says=m.fault) for m in mutants)


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
