"""Which bug a port shows on a case."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.declaration import Declaration, declared
from ibr_ref.oracle.device import LOOSEST, Device
from ibr_ref.oracle.files import Submission, submission_from_arrays
from ibr_ref.oracle.judgement import Explains, Handed, Judgement, Recognizes
from ibr_ref.oracle.referees import referee
from ibr_ref.oracle.referees.reads import reads_of, system_of
from ibr_ref.oracle.trials import FREEDOMS, judge

Port = Callable[[Case], Submission]
"""Draws a case. Raises PortError where it does not."""


class PortError(Exception):
    """Raised by a port that draws nothing at all; the message says how it ended."""


class WrongError(AssertionError):
    """Tells Hypothesis of a case on which a port is wrong."""


class Bug(NamedTuple):
    """What is taken for one bug: where the verdict on it begins, and what is known to cause it."""

    method: str
    stage: str
    """The first wrong stage; "submission" for files that cannot be used, "port" for a port that does not draw."""
    array: str
    """The first of its arrays that disagrees, the file, or how the port ended."""
    causes: tuple[str, ...] = ()
    """Names of known bugs, of which each explains it; none: no bug that is known, or the method names none."""

    @property
    def name(self) -> str:
        """As a folder may be called."""
        words = f"{self.method}-{self.array if self.array.startswith(self.stage) else f'{self.stage}-{self.array}'}"
        words = "-".join([words, *self.causes[:1], *["or-another"][: len(self.causes[1:])]])
        return "".join(c if c.isalnum() or c in "._-" else "-" for c in words)[:64].rstrip("-")

    @property
    def place(self) -> tuple[str, str, str]:
        """Where it shows."""
        return self[:3]


class Judged(NamedTuple):
    """What a wrong stage was judged from."""

    device: Device
    handed: Handed
    wrong: Judgement


class Failure(NamedTuple):
    """A bug on a case, and how it came out."""

    bug: Bug
    judged: Judged | None = None
    """None: there was nothing to judge."""


def drawing(draw: Callable[[Case], Mapping[str, Any]]) -> Port:
    """A function as a port: it returns arrays by the names that a case's folder expects, "color" and any stages."""

    def port(case: Case) -> Submission:
        arrays = dict(draw(case))
        color, depth = arrays.pop("color", None), arrays.pop("depth", None)
        return submission_from_arrays(case, color=color, depth=depth, stages=arrays)

    return port


def bug_of(case: Case, port: Port, device: str | None, known: Collection[Bug] = ()) -> Bug | None:
    """The first bug that the port shows on the case and that is not known; None where it is right, or only wrong as known.

    device: the profile that the port declares; without, its own, or the loosest. Each stage is judged on the port's own
    arrays of those before it, so that a known bug hides none in later stages. Small biases that the picture alone can show
    are not looked for. The bug has no causes: to look for them takes seconds (`with_causes`).
    """
    failure = failure_of(case, port, device, known)
    return None if failure is None else failure.bug


def failure_of(case: Case, port: Port, device: str | None, known: Collection[Bug] = ()) -> Failure | None:
    """The same, with what has been judged."""
    return shown(case, port, device, known).unknown


class Shown(NamedTuple):
    """What a port shows on a case."""

    unknown: Failure | None
    """The first failure that is no known bug."""
    wrong: bool
    """Whether there is any, known or not."""


# A port's numbers may be anything.
@np.errstate(all="ignore")
def shown(case: Case, port: Port, device: str | None, known: Collection[Bug] = ()) -> Shown:
    """The first bug that is not known, and whether the port is wrong at all."""
    wrong = False
    for failure in _failures(case, port, device, known):
        if not _is_known(case, failure, known):
            return Shown(failure, True)
        wrong = True
    return Shown(None, wrong)


def _failures(case: Case, port: Port, device: str | None, known: Collection[Bug]) -> Iterator[Failure]:
    """All that is wrong; without known ones the first alone."""
    try:
        submission = port(case)
    except PortError as error:
        yield Failure(Bug(case.method, "port", str(error)))
        return
    if submission.problems:
        yield Failure(Bug(case.method, "submission", submission.problems[0].file))
        return
    declaration = declared(device) if device else submission.declaration
    to_first_wrong = not known
    wrong = _wrong(case, submission, declaration, to_first_wrong)
    if wrong and declaration.profile is None:
        # It may be right on a device that no profile is, and that `tightest` would have looked for.
        loosest = Declaration(None, {**FREEDOMS, **declaration.numbers})
        if not _wrong(case, submission, loosest, to_first_wrong):
            return
    stages = [judgement for judgement in wrong if judgement.stage != "image"]  # a wrong stage shows in the picture
    for judgement in stages or wrong:
        yield Failure(_bug(case, judgement), Judged(_device(declaration), submission.handed, judgement))


@np.errstate(all="ignore")
def with_causes(case: Case, failure: Failure) -> Bug:
    """The bug with the known bugs that explain it, where the method has any."""
    judge_of = referee(case.method)
    if failure.judged is None or not isinstance(judge_of, Explains):
        return failure.bug
    found = judge_of.causes(case, *failure.judged)
    return failure.bug._replace(causes=() if found is None else tuple(cause.name for cause in found.causes))


def _is_known(case: Case, failure: Failure, known: Collection[Bug]) -> bool:
    """Whether it shows where a known bug does, and is not another one there: known bugs that were named can be told."""
    here = [bug for bug in known if bug.place == failure.bug.place]
    judge_of = referee(case.method)
    judged = failure.judged
    if judged is None or not isinstance(judge_of, Recognizes) or not all(bug.causes for bug in here):
        return bool(here)
    causes = sorted({cause for bug in here for cause in bug.causes})
    return any(judge_of.recognizes(case, *judged, cause) for cause in causes)


def _wrong(case: Case, submission: Submission, declaration: Declaration, to_first_wrong: bool) -> list[Judgement]:
    judge_of = referee(case.method)
    handed, device = submission.handed, _device(declaration)
    if _whole(case, handed):
        found = judge_of.judge_stages(case, device, handed, to_first_wrong=to_first_wrong)
    else:
        found = judge(case, handed, device, to_first_wrong=to_first_wrong)
    return [judgement for judgement in found if judgement.wrong.any()]


def _whole(case: Case, handed: Handed) -> bool:
    """Whether every array is there that the picture is made of: where each is right, so is the picture."""
    expected = {"color", "depth", *case.frame.stages}
    return expected & {*reads_of(case.method, system_of(case.method, case.params))} <= {*handed}


def _device(declaration: Declaration) -> Device:
    return declaration.device(declaration.profile or LOOSEST)


def _bug(case: Case, judgement: Judgement) -> Bug:
    first = int(judgement.blame[judgement.wrong].min())
    return Bug(case.method, judgement.stage, judgement.arrays[max(first, 0)])
