"""Which bug is it: the program of every known one is judged on the port's arrays as the right one is.

A bug is named only if no element contradicts it. Some dozens of elements, right and wrong ones, are tried first; what
explains them, on all.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic.number import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.judgement import Handed, Judgement
from ibr_ref.oracle.referees.displacement.image import Shown, searched
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.picture import Picture
from ibr_ref.oracle.referees.displacement.replay import Port
from ibr_ref.oracle.referees.displacement.stages import STAGES, Stages
from ibr_ref.oracle.verdict import Cause

FEW, SOME, EVERY = 6, 40, 97
"""Wrong elements that are tried first, those that are tried next, and of the right ones each which."""


def causes(case: Case, device: Device, handed: Handed, wrong: Judgement) -> tuple[Cause, ...]:
    """The bugs that explain every element of a stage.

    Bugs of the stage first, then, where none of them does, those of its neighbours. Of a picture by itself, of all stages.
    """
    off = wrong.wrong.reshape(-1)
    samples = _samples(off)
    for stages in _suspected(wrong.stage):
        left = [m for m in MUTANTS if m.stage in stages]
        for sample in samples:
            left = [m for m in left if not _leaves(case, device, handed, wrong.stage, m.port, sample)]
        if left:
            return tuple(Cause(name=m.name, says=m.fault) for m in left)
    return ()


def _suspected(stage: str) -> Sequence[tuple[str, ...]]:
    """Which stages' bugs are suspects, in turn."""
    if stage == "image":
        return (STAGES,)
    at = STAGES.index(stage)
    return ((stage,), tuple(s for s in STAGES[max(at - 1, 0) : at + 2] if s != stage))


def _samples(off: Bools) -> list[Bools | None]:
    """A few wrong elements, some with right ones between them, all."""
    wrong = np.flatnonzero(off)
    parts: list[Bools | None] = []
    for count, right in ((FEW, False), (SOME, True)):
        part = np.zeros(len(off), np.bool_)
        part[wrong[:: max(1, len(wrong) // count)][: 2 * count]] = True
        if right:
            part[::EVERY] = True
        parts.append(part)
    return [*parts, None]


def _leaves(case: Case, device: Device, handed: Handed, stage: str, kind: type[Any], among: Bools | None) -> int:
    """How many elements a program does not explain, of those `among`."""
    model = Model(case, device, kind)
    with np.errstate(all="ignore"):
        if stage == "image":
            picture = Picture(model, among)
            accepted = searched(picture, Shown.of(picture, handed)).accepted
            return int((~accepted if among is None else ~accepted & among).sum())
        if stage in ("vertex", "raster") and among is not None:
            among = None  # as soon done for all
        judgement = Stages(Port(model=model, handed=handed, among=among)).judge(stage, clean=True)
        return int(judgement.wrong.sum())
