"""The verdict on what a port handed in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.declaration import Declaration
from ibr_ref.oracle.examination import Examination, examine
from ibr_ref.oracle.files import Submission, empty, stale
from ibr_ref.oracle.findings import Outcome


def check(
    case: Case, submission: Submission, *, profile: str | Declaration | None = None, name_causes: bool = True
) -> Examination:
    """Judge a submission by the device that is given, or declared by the port, or the tightest that explains it.

    A wrong submission of which nothing was drawn, or whose image is that of another built-in case of the method, makes the
    verdict INCONCLUSIVE: the port did not draw this one. Raises ValueError for an unknown device.
    """
    problems = [str(problem) for problem in submission.problems]
    missing = [] if problems else empty(case, submission.handed, submission.files)
    examination = examine(
        case,
        submission.handed,
        profile=submission.declaration if profile is None else profile,
        problems=problems,
        name_causes=name_causes and not missing,
    )
    if examination.verdict.outcome is not Outcome.FAIL:
        return examination
    if not missing and (image := examination.judgement("image")) is not None and image.wrong.any():
        missing = [other for other in [stale(case, submission.handed, _others(case))] if other is not None]
    if not missing:
        return examination
    reasons = tuple(map(str, missing))
    verdict = examination.verdict.model_copy(update={"outcome": Outcome.INCONCLUSIVE, "reasons": reasons})
    return replace(examination, verdict=verdict)


def _others(case: Case) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Pictures of the method's other built-in cases of that size; of other methods all kernels would have to be compiled."""
    size = case.scene.camera.width, case.scene.camera.height
    for name in names(case.method):
        if name != case.name and _size(name) == size:
            yield name, _picture(name)


@cache
def _size(name: str) -> tuple[int, int]:
    """Width and height of a built-in case; asked for at every wrong image, and some cases take seconds to build."""
    camera = build(name).scene.camera
    return camera.width, camera.height


@cache
def _picture(name: str) -> NDArray[np.float64]:
    return build(name).frame.color
