"""What the programs of bugs make of a port's stage, at some of its elements or at all."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.judgement import Handed, Judgement, spread_out

FEW, SOME = 6, 40
"""Wrong elements that are tried first, up to twice as many; and next, with as many right ones."""
MOST_ROWS = 100_000
"""Of programs that are run in one search, forks too; what is not tried by then is not named, and the verdict says so."""


class Replay(Protocol):
    """A port's stages, judged by one program."""

    @property
    def cost(self) -> int:
        """Of what was judged so far, setting up and all, in rows of a program as long as a march."""

    def names(self, stage: str) -> tuple[str, ...]:
        """What of a stage was handed in."""

    def judge(self, stage: str) -> Judgement:
        """One stage."""


class Replays(Protocol):
    """By a program, of all elements or of those `among`; not thorough: of a contradicted stage the rest may be left out."""

    def __call__(self, kind: type[Any], among: Bools | None, *, thorough: bool) -> Replay:
        """A port's stages."""


@dataclass(frozen=True, kw_only=True)
class Inquiry:
    """What a method's known bugs are, and how they are judged."""

    mutants: Sequence[Mutant]
    arrays: Mapping[str, tuple[str, ...]]
    """For each stage, in the pipeline's order, those that are compared in it; of the last, and of "image", none need be."""
    replay: Replays
    sampled: Collection[str]
    """The stages of which some elements are sooner judged than all."""

    def place(self, stage: str) -> int:
        """In the pipeline. A picture by itself is resolve's too."""
        return [*self.arrays].index("resolve" if stage == "image" else stage)

    def before(self, stage: str, mutant: Mutant) -> list[str]:
        """The stages that a bug may contradict before that one: from its own on."""
        last = self.place(stage)
        return [*self.arrays][min(self.place(mutant.stage), last) : last]

    def hidden_in(self, stage: str, handed: Handed) -> list[str]:
        """Stages whose bugs this one may show: those before it of which not all is handed in, up to one that is whole."""
        order = [*self.arrays]
        at, found = order.index(stage), []
        while at and not all(name in handed for name in self.arrays[order[at - 1]]):
            at -= 1
            found.append(order[at])
        return found


@dataclass(frozen=True, eq=False)
class Left:
    """(n,) what a program leaves of a stage's elements."""

    wrong: Bools
    """It contradicts them."""
    nearer: Bools
    """Of those that the right program contradicts: it does not, or not before a later array."""
    sure: Bools
    """Of the same: it certainly does not."""
    against: Bools
    """It contradicts them, and the right program does not."""

    @property
    def explains(self) -> bool:
        """Whether it contradicts none, and some that is wrong is certainly explained."""
        return bool(not self.wrong.any() and self.sure.any())

    @property
    def gain(self) -> int:
        """How many elements it comes nearer than the right program, less those that speak against it."""
        return int(np.count_nonzero(self.nearer)) - int(np.count_nonzero(self.against))


class Suspects:
    """Programs of bugs, on a wrong stage of a port."""

    def __init__(self, inquiry: Inquiry, wrong: Judgement) -> None:
        """The cost of all that is judged counts from here on."""
        self.inquiry, self.stage, self.judgement = inquiry, wrong.stage, wrong
        self.wrong, self._blame = wrong.wrong.reshape(-1), wrong.blame.reshape(-1)
        self.spent = 0
        self.promise: dict[Mutant, int] = {}
        """Of those that were tried, at how many of the elements that were looked at first they come nearer."""

    def samples(self) -> list[Bools | None]:
        """A few wrong elements, some with right ones among them."""
        return self.samples_of(self.wrong, [self.wrong, ~self.wrong])

    def samples_of(self, first: Bools, then: Sequence[Bools]) -> list[Bools | None]:
        """(n,) a few of the first, some of each of those that follow."""
        if self.stage not in self.inquiry.sampled:
            return []
        return [spread_out([first], FEW), spread_out(then, SOME)]

    def survivors(
        self,
        mutants: Sequence[Mutant],
        samples: Sequence[Bools | None],
        limit: int,
        tried: Callable[[], None] = lambda: None,
    ) -> tuple[list[Mutant], bool]:
        """Those that explain each of the samples, then all elements; and whether all were tried within the limit.

        tried: told of each that is tried first.
        """
        left = [*mutants]
        for number, sample in enumerate((*samples, None)):
            found: list[Mutant] = []
            for mutant in left:
                if self.spent >= limit:
                    return (found if sample is None else []), False
                if number == 0:
                    tried()
                if self.explains(mutant, sample):
                    found.append(mutant)
            left = found
        return left, True

    def explains(self, mutant: Mutant, among: Bools | None) -> bool:
        """Whether a program contradicts no element `among`; of all elements, it must certainly explain a wrong one too."""
        left = self.left(mutant, among, thorough=among is not None)
        self.promise.setdefault(mutant, 0 if left is None else left.gain)
        return left is not None and (left.explains if among is None else not left.wrong.any())

    def left(self, mutant: Mutant, among: Bools | None, *, thorough: bool = True) -> Left | None:
        """What a program leaves of the elements `among`; None: it contradicts the stages from its bug on.

        What a wrong program takes for no input at all is not judged.
        """
        replay = self.inquiry.replay(mutant.port, among, thorough=thorough)
        with np.errstate(all="ignore"):
            result = self._left(replay, mutant)
        self.spent += replay.cost
        if result is None or among is None:
            return result
        return Left(*(each & among for each in (result.wrong, result.nearer, result.sure, result.against)))

    def _left(self, replay: Replay, mutant: Mutant) -> Left | None:
        for stage in self.inquiry.before(self.stage, mutant):
            if replay.names(stage) and replay.judge(stage).wrong.any():
                return None
        judgement = replay.judge(self.stage)
        wrong = judgement.wrong.reshape(-1)
        if wrong.size != len(self.wrong):  # it has another number of elements
            none = np.zeros_like(self.wrong)
            return None if wrong.any() else Left(none, self.wrong, self.wrong, none)
        nearer = self.wrong & (~wrong | (self._place_of(judgement) > self._blame))
        sure = self.wrong & ~wrong & ~judgement.undecided.reshape(-1)
        return Left(wrong, nearer, sure, wrong & ~self.wrong)

    def _place_of(self, judgement: Judgement) -> Ints:
        """(n,) the first array that disagrees, as the right program's judgement counts them."""
        order = {name: i for i, name in enumerate(self.judgement.arrays)}
        places = np.array([*(order.get(name, 0) for name in judgement.arrays), 0])
        return np.asarray(places[judgement.blame.reshape(-1)])


def ranked(gains: Mapping[Mutant, int], most: int) -> list[Mutant]:
    """The best of those that gain anything, in their order where they tie."""
    found = sorted((-gain, i, mutant) for i, (mutant, gain) in enumerate(gains.items()) if gain > 0)
    return [mutant for _, _, mutant in found[:most]]
