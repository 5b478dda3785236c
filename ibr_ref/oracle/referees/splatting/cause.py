"""The known bugs that explain a wrong stage, or a picture by itself."""

from __future__ import annotations

from typing import Any

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.faults.splatting import MUTANTS
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement
from ibr_ref.oracle.referees.causes import Inquiry
from ibr_ref.oracle.referees.splatting.model import Model, model_of
from ibr_ref.oracle.referees.splatting.stages import ARRAYS, Stages


def causes(case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
    """The bugs that explain every element of a stage.

    Bugs of the stage first, then, where none of them does, those that may hide in it; of a picture those of all stages.
    """
    inquiry = _inquiry(case, device, handed)
    if wrong.stage == "image":
        return inquiry.causes(wrong, ARRAYS)
    return inquiry.causes(wrong, (wrong.stage,), inquiry.hidden_in(wrong.stage, handed))


def recognizes(case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
    """Whether the bug of that name explains every element of a stage, or of a picture."""
    return _inquiry(case, device, handed).recognizes(wrong, cause)


def _inquiry(case: Case, device: Device, handed: Handed) -> Inquiry:
    right = Stages(model_of(case, device), handed)

    def replay(kind: type[Any], among: Bools | None) -> Stages:
        return Stages(Model(case, device, kind, right.port.model), handed, among, right)

    return Inquiry(
        mutants=MUTANTS, arrays={**ARRAYS, "image": ()}, replay=replay, sampled=("normals", "vertex", "image")
    )
