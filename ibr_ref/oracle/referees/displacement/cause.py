"""The known bugs that explain a wrong stage, or a picture by itself."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ibr_ref.array_types import Bools
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.faults.taken import suspects
from ibr_ref.oracle.judgement import Explanation, Handed, Judgement
from ibr_ref.oracle.programs.displacement import Port as Program
from ibr_ref.oracle.programs.displacement.raster import Raster
from ibr_ref.oracle.programs.displacement.vertex import Vertex
from ibr_ref.oracle.programs.program import overridden
from ibr_ref.oracle.referees.causes import Inquiry
from ibr_ref.oracle.referees.displacement.likely import likely
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.replay import ARRAYS, Port
from ibr_ref.oracle.referees.displacement.stages import Stages
from ibr_ref.searches import SEARCHES

FACES = (frozenset(dir(Vertex)) | frozenset(dir(Raster))) - {"taken"}
"""What vertex processing and rasterization call: a program that changes none of it has the right one's fragments."""
NUMBERS = ("linear_steps", "binary_steps", "steep_threshold", "min_steps", "max_steps", "distance_layers")
"""Parameters of searches."""
LIT = ("shadow_steps", "shadow_bias")
"""Those of self-shadow."""
EVIDENCE = 16
"""Wrong elements from which on a parameter is believed: of the dozen numbers that are tried one explains a few by chance."""


def causes(case: Case, device: Device, handed: Handed, wrong: Judgement) -> Explanation | None:
    """The bugs that explain every element of a stage.

    Bugs of the stage first, then, where none of them does, those that may hide in it. Of a picture those of all stages whose
    pictures are like it. Where no bug does, the right program with another parameter.
    """
    inquiry = _inquiry(case, device, handed)
    found = _found(case, handed, wrong, inquiry)
    if found.causes or wrong.wrong.sum() < EVIDENCE:
        return found
    causes = _found(case, handed, wrong, replace(inquiry, mutants=_taken(case))).causes
    return replace(found, causes=causes)


def _found(case: Case, handed: Handed, wrong: Judgement, inquiry: Inquiry) -> Explanation:
    """Those of the suspects that explain it."""
    if wrong.stage == "image":
        few = likely(case, handed, wrong.wrong, inquiry.mutants)
        return replace(inquiry, mutants=few).causes(wrong, inquiry.arrays)
    hidden = inquiry.hidden_in(wrong.stage, handed)
    if wrong.stage == "shade" and "color" in wrong.arrays:  # by the depth test another polygon's are shown
        hidden.append("resolve")
    return inquiry.causes(wrong, (wrong.stage,), hidden)


def recognizes(case: Case, device: Device, handed: Handed, wrong: Judgement, cause: str) -> bool:
    """Whether the bug of that name explains every element of a stage; one that there is not explains none."""
    inquiry = _inquiry(case, device, handed)
    if all(mutant.name != cause for mutant in inquiry.mutants):
        inquiry = replace(inquiry, mutants=_taken(case))
    return inquiry.recognizes(wrong, cause)


def _taken(case: Case) -> list[Mutant]:
    """The right program with other parameters, those that the case reads."""
    reads = SEARCHES[case.params.method].reads
    stages = {name: "march" for name in NUMBERS if name in reads}
    if case.params.shadow_steps:
        stages |= dict.fromkeys(LIT, "shade")
    return suspects(Program, case.params, stages)


def _inquiry(case: Case, device: Device, handed: Handed) -> Inquiry:
    right = Stages(Port(model=Model(case, device), handed=handed))

    def replay(kind: type[Any], among: Bools | None) -> Stages:
        stages = Stages(Port(model=Model(case, device, kind), handed=handed, among=among))
        if _draws_the_same_faces(kind):
            stages.take_fragments(right)
        return stages

    return Inquiry(
        mutants=[mutant for mutant in MUTANTS if mutant.applies(case.system)],
        arrays={**ARRAYS, "resolve": (), "image": ()},
        replay=replay,
        sampled=("march", "shade", "resolve", "image"),
    )


def _draws_the_same_faces(kind: type[Any]) -> bool:
    """Whether nothing is changed that the fragments hang on."""
    return not overridden(kind, Program) & FACES
