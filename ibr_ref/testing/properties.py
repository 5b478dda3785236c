"""A port as a property: right on every case that can be drawn."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, Phase, given, settings

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.examination import examine
from ibr_ref.oracle.files import export
from ibr_ref.testing.cases import cases
from ibr_ref.testing.judging import Bug, WrongError, bug_of, drawing


def assert_port(
    draw: Callable[[Case], Mapping[str, Any]],
    *,
    method: str,
    system: str | None = None,
    device: str | None = None,
    max_examples: int = 100,
    folder: str | PathLike[str] | None = None,
) -> None:
    """Raise AssertionError unless a port is right on random cases of a method; the words are of the smallest that is not.

    draw: takes an `oracle.Case` (its scene, params and inputs), returns arrays by the names that the case's folder expects:
    "color" and "depth", and any stages. system: the only one that it draws, as for `cases`. device: the profile that it
    declares; without, the loosest. folder: where the failing case is written, for `ibr-ref check` and for ports that read
    files; without, a temporary one, which the words name. Everything else is as Hypothesis' profile says. Raises ValueError
    for an unknown method, system or device.
    """
    port = drawing(draw)
    shown: list[tuple[Bug, Case]] = []

    @settings(
        max_examples=max_examples,
        deadline=None,
        phases=[phase for phase in settings().phases if phase is not Phase.explain],  # which takes minutes
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )
    @given(cases(method, system))
    def holds(case: Case) -> None:
        bug = bug_of(case, port, device)
        if bug is not None:
            shown.append((bug, case))
            raise WrongError(bug.name)

    try:
        holds()
    except WrongError:
        bug, case = shown[-1]  # the smallest is tried last
        raise AssertionError(_words(draw, replace(case, name=bug.name), bug, device, folder)) from None


def _words(
    draw: Callable[[Case], Mapping[str, Any]],
    case: Case,
    bug: Bug,
    device: str | None,
    folder: str | PathLike[str] | None,
) -> str:
    submission = drawing(draw)(case)
    problems = [str(problem) for problem in submission.problems]
    verdict = examine(case, submission.handed, profile=device, problems=problems).verdict
    place = Path(tempfile.mkdtemp(prefix="ibr_ref-") if folder is None else folder) / bug.name
    export(case, place, force=True)
    return f"{verdict.words()}\n  Case: {place}"
