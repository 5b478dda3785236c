"""Which bug a port shows on a case."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.declaration import Declaration, declared
from ibr_ref.oracle.device import LOOSEST
from ibr_ref.oracle.files import Submission, submission_from_arrays
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.trials import FREEDOMS, judge

Port = Callable[[Case], Submission]
"""Draws a case. Raises PortError where it does not."""


class PortError(Exception):
    """Raised by a port that draws nothing at all; the message says how it ended."""


class WrongError(AssertionError):
    """Tells Hypothesis of a case on which a port is wrong."""


class Bug(NamedTuple):
    """What is taken for one bug: where the verdict on it begins."""

    method: str
    stage: str
    """The first wrong stage; "submission" for files that cannot be used, "port" for a port that does not draw."""
    array: str
    """The first of its arrays that disagrees, the file, or how the port ended."""

    @property
    def name(self) -> str:
        """As a folder may be called."""
        words = f"{self.method}-{self.array if self.array.startswith(self.stage) else f'{self.stage}-{self.array}'}"
        return "".join(c if c.isalnum() or c in "._-" else "-" for c in words)[:64]


def drawing(draw: Callable[[Case], Mapping[str, Any]]) -> Port:
    """A function as a port: it returns arrays by the names that a case's folder expects, "color" and any stages."""

    def port(case: Case) -> Submission:
        arrays = dict(draw(case))
        color, depth = arrays.pop("color", None), arrays.pop("depth", None)
        return submission_from_arrays(case, color=color, depth=depth, stages=arrays)

    return port


# A port's numbers may be anything.
@np.errstate(all="ignore")
def bug_of(case: Case, port: Port, device: str | None, known: Collection[Bug] = ()) -> Bug | None:
    """The first bug that the port shows on the case and that is not known; None where it is right, or only wrong as known.

    device: the profile that the port declares; without, its own, or the loosest. Each stage is judged on the port's own
    arrays of those before it, so that a known bug hides none in later stages. Small biases that the picture alone can show
    are not looked for.
    """
    try:
        submission = port(case)
    except PortError as error:
        return _unless_known(Bug(case.method, "port", str(error)), known)
    if submission.problems:
        return _unless_known(Bug(case.method, "submission", submission.problems[0].file), known)
    declaration = declared(device) if device else submission.declaration
    wrong = _wrong(case, submission, declaration, to_first_wrong=not known)
    if wrong and declaration.profile is None:
        # It may be right on a device that no profile is, and that `tightest` would have looked for.
        wrong = _wrong(case, submission, Declaration(None, {**FREEDOMS, **declaration.numbers}), not known) and wrong
    stages = [judgement for judgement in wrong if judgement.stage != "image"]  # a wrong stage shows in the picture
    found = (_bug(case, judgement) for judgement in stages or wrong)
    return next((bug for bug in found if bug not in known), None)


def _wrong(case: Case, submission: Submission, declaration: Declaration, to_first_wrong: bool) -> list[Judgement]:
    device = declaration.device(declaration.profile or LOOSEST)
    return [j for j in judge(case, submission.handed, device, to_first_wrong=to_first_wrong) if j.wrong.any()]


def _unless_known(bug: Bug, known: Collection[Bug]) -> Bug | None:
    return None if bug in known else bug


def _bug(case: Case, judgement: Judgement) -> Bug:
    first = int(judgement.blame[judgement.wrong].min())
    return Bug(case.method, judgement.stage, judgement.arrays[max(first, 0)])
