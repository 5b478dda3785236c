"""Which bugs a picture looks like: every program is drawn at some of its pixels, as one device draws it, and compared.

To judge a picture by a suspect takes a second, and the bugs of all stages are suspects. What is left out here can only lose
a name: those that look alike are judged with all that is legal before one is named.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.colors import as_numbers
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.programs.displacement import Port as Program

LOOKED_AT = 96
"""Wrong pixels at most."""
FAR = 16.0 / 255.0
"""A colour that is farther off is as wrong as any: where two devices hit other places, pictures of one program are apart."""
DEEP = 1.0 / 64.0
"""Of window depth, the same."""
LIKE = 0.5
"""Of how far off the right program is: a bug that comes no nearer explains something else, or nothing."""
PARTLY = 0.95
"""The same for one of two bugs, which comes nearer where the other does not show."""
MOST = 16
"""Bugs that are judged."""


def likely(case: Case, handed: Handed, wrong: Bools, mutants: Sequence[Mutant], share: float = LIKE) -> list[Mutant]:
    """Bugs whose pictures come near to the port's at wrong pixels (H, W), the nearest first.

    share: of how far off the right program is, at most.
    """
    off, at = np.flatnonzero(wrong), np.zeros(wrong.shape, np.bool_)
    at.reshape(-1)[off[np.linspace(0, len(off) - 1, min(len(off), LOOKED_AT)).astype(np.int64)]] = True
    limit = share * _apart(case, handed, at, Program)
    apart = [(_apart(case, handed, at, mutant.port), mutant) for mutant in mutants]
    near = sorted((pair for pair in apart if pair[0] <= limit), key=lambda pair: pair[0])
    return [mutant for _, mutant in near[:MOST]]


def _apart(case: Case, handed: Handed, at: Bools, kind: type[Any]) -> float:
    """How far a program's picture is from the port's in the mean of some pixels, 0 to 1."""
    with np.errstate(all="ignore"):
        program = kind(case.scene, case.params, Policy(), case.inputs)
        drawn = program.render(at | program.rows(at))
        apart = np.abs(as_numbers(drawn["color"])[at] - as_numbers(handed["color"])[at]).max(axis=1) / FAR
        if "depth" in handed:
            apart = np.fmax(apart, np.abs(np.asarray(drawn["depth"], np.float64)[at] - handed["depth"][at]) / DEEP)
    return float(np.nan_to_num(np.minimum(apart, 1.0), nan=1.0).mean())
