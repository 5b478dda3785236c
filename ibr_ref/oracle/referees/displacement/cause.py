"""Which bug is it: the program of every known one is judged on the port's arrays as the right one is.

A bug is named only if no element contradicts it, and some that is wrong is certainly explained by it. Some dozens of
elements, right and wrong ones, are tried first; what explains them, on all.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.findings import Cause
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement
from ibr_ref.oracle.programs.displacement import Port as Program
from ibr_ref.oracle.programs.displacement.raster import Raster
from ibr_ref.oracle.programs.displacement.vertex import Vertex
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.replay import ARRAYS, Port
from ibr_ref.oracle.referees.displacement.stages import STAGES, Stages

FEW, SOME = 6, 40
"""Wrong elements that are tried first, up to twice as many; and next, with as many right ones."""
MOST_ROWS = 100_000
"""Of programs that are run in all, forks too; what is not tried by then is not named, and the verdict says so."""
START = 500
"""What setting up a program costs, in rows."""

FACES = frozenset(dir(Vertex)) | frozenset(dir(Raster))
"""What vertex processing and rasterization call: a program that changes none of it has the right one's fragments."""


def causes(case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
    """The bugs that explain every element of a stage; None: not looked for.

    Bugs of the stage first, then, where none of them does, those that may hide in it. None of a picture by itself: the bugs
    of all stages would be suspects, a second each.
    """
    if wrong.stage not in STAGES:
        return None
    suspects, tried = Suspects(case, device, handed, wrong), 0
    for stages in (wrong.stage,), _hidden_in(wrong, handed):
        left = [m for m in MUTANTS if m.stage in stages and m.applies(case.system)]
        for number, sample in enumerate((*suspects.samples(), None)):
            survivors: list[Mutant] = []
            for mutant in left:
                if suspects.rows >= MOST_ROWS:
                    found = tuple(survivors) if sample is None else ()
                    return Explanation(causes=_named(found), given_up_after=tried)
                tried += number == 0
                if suspects.explains(mutant, sample):
                    survivors.append(mutant)
            left = survivors
        if left:
            return Explanation(causes=_named(left))
    return Explanation(causes=())


def recognizes(case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
    """Whether the bug of that name explains every element of a stage; one that there is not explains none."""
    if wrong.stage not in STAGES:
        return False
    suspects = Suspects(case, device, handed, wrong)
    return any(suspects.explains(mutant, None) for mutant in MUTANTS if mutant.name == cause)


def _named(mutants: Sequence[Mutant]) -> tuple[Cause, ...]:
    return tuple(Cause(name=m.name, says=m.fault) for m in mutants)


def _hidden_in(wrong: Judgement, handed: Handed) -> tuple[str, ...]:
    """The stages whose bugs this one may show: those before it of which not all is handed in, up to one that is whole.

    Colours are judged with shading, and by the depth test another polygon's are shown.
    """
    at = STAGES.index(wrong.stage)
    found = ["resolve"] if wrong.stage == "shade" and "color" in wrong.arrays else []
    while at and not all(name in handed for name in ARRAYS[STAGES[at - 1]]):
        at -= 1
        found.append(STAGES[at])
    return tuple(found)


class Suspects:
    """What the programs of bugs make of a port's stage."""

    def __init__(self, case: Case, device: Device, handed: Handed, wrong: Judgement) -> None:
        self.case, self.device, self.handed = case, device, handed
        self.stage, self.wrong = wrong.stage, wrong.wrong.reshape(-1)
        self.right = Stages(Port(model=Model(case, device), handed=handed))
        self.rows = 0

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
        with np.errstate(all="ignore"):
            result = self._explained(stages, mutant, among)
        self.rows += START + stages.model.machine.rows
        return result

    def _explained(self, stages: Stages, mutant: Mutant, among: Bools | None) -> bool:
        last = STAGES.index(self.stage)
        for stage in STAGES[min(STAGES.index(mutant.stage), last) : last]:
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
