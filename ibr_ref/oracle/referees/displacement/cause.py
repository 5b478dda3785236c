"""Which bug is it: the program of every known one is judged on the port's arrays as the right one is.

A bug is named only if no element contradicts it, and some that is wrong is certainly explained by it. Some dozens of
elements, right and wrong ones, are tried first; what explains them, on all.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic.number import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.programs.displacement import Port as Program
from ibr_ref.oracle.programs.displacement.raster import Raster
from ibr_ref.oracle.programs.displacement.vertex import Vertex
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.replay import Port
from ibr_ref.oracle.referees.displacement.stages import STAGES, Stages
from ibr_ref.oracle.verdict import Cause

FEW, SOME = 6, 40
"""Wrong elements that are tried first, up to twice as many; and next, with as many right ones."""
MOST = 8
"""Suspects that are tried on all elements: where more are left, none is named."""

FACES = frozenset(dir(Vertex)) | frozenset(dir(Raster))
"""What vertex processing and rasterization call: a program that changes none of it has the right one's fragments."""


def causes(case: Case, device: Device, handed: Handed, wrong: Judgement) -> tuple[Cause, ...] | None:
    """The bugs that explain every element of a stage; None: not looked for, or too many to try them on all elements.

    Bugs of the stage first, then, where none of them does, those of its neighbours. None of a picture by itself: the bugs
    of all stages would be suspects, a second each.
    """
    if wrong.stage not in STAGES:
        return None
    suspects = Suspects(case, device, handed, wrong)
    for stages in _suspected(wrong.stage):
        left = [m for m in MUTANTS if m.stage in stages]
        samples = suspects.samples()
        for sample in samples:
            left = [m for m in left if suspects.explains(m, sample)]
        if samples and len(left) > MOST:
            return None
        left = [m for m in left if suspects.explains(m, None)]
        if left:
            return tuple(Cause(name=m.name, says=m.fault) for m in left)
    return ()


def _suspected(stage: str) -> Sequence[tuple[str, ...]]:
    """Which stages' bugs are suspects, in turn."""
    at = STAGES.index(stage)
    return ((stage,), tuple(s for s in STAGES[max(at - 1, 0) : at + 2] if s != stage))


class Suspects:
    """What the programs of bugs make of a port's stage."""

    def __init__(self, case: Case, device: Device, handed: Handed, wrong: Judgement) -> None:
        self.case, self.device, self.handed = case, device, handed
        self.stage, self.wrong = wrong.stage, wrong.wrong.reshape(-1)
        self.right = Stages(Port(model=Model(case, device), handed=handed))

    def samples(self) -> list[Bools | None]:
        """A few wrong elements, some with right ones among them."""
        if self.stage in ("vertex", "raster"):  # as soon done for all
            return []
        off = np.flatnonzero(self.wrong)
        on = np.flatnonzero(~self.wrong)
        few, some = np.zeros((2, len(self.wrong)), np.bool_)
        few[off[:: max(1, len(off) // FEW)][: 2 * FEW]] = True
        some[off[:: max(1, len(off) // SOME)][: 2 * SOME]] = True
        some[on[:: max(1, len(on) // SOME)][: 2 * SOME]] = True
        return [few, some]

    def explains(self, mutant: Mutant, among: Bools | None) -> bool:
        """Whether a program contradicts no element `among`, and certainly explains a wrong one of them.

        Nor may it in the stages from its bug on: what a wrong program takes for no input at all is not judged.
        """
        kind: type[Any] = mutant.port
        stages = Stages(Port(model=Model(self.case, self.device, kind), handed=self.handed, among=among))
        if _draws_the_same_faces(kind):
            stages.take_fragments(self.right)
        last = STAGES.index(self.stage)
        first = min(STAGES.index(mutant.stage), last)
        with np.errstate(all="ignore"):
            for stage in STAGES[first:last]:
                if stages.names(stage) and stages.judge(stage, clean=True).wrong.any():
                    return False
            judgement = stages.judge(self.stage, clean=True)
        if judgement.wrong.size != len(self.wrong):  # it draws another number of faces
            return not judgement.wrong.any()
        sure = self.wrong & ~judgement.undecided.reshape(-1)
        if among is not None:
            sure &= among
        return bool(not judgement.wrong.any() and sure.any())


def _draws_the_same_faces(kind: type[Any]) -> bool:
    """Whether nothing is changed that the fragments hang on."""
    changed = {name for each in kind.__mro__ if not issubclass(Program, each) for name in vars(each)}
    return not changed & FACES - {"__doc__", "__module__"}
