"""The oracle on the GLSL ports: from a case's folder to the verdict, on every case; right ports pass, broken ones do not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from ibr_ref import oracle
from ibr_ref.oracle import PROFILES, Examination, Outcome
from ibr_ref.oracle.examination import judge

MOST_UNDECIDED = 0.005
"""Of the pixels, by the profile that a case is meant for: the specification's."""


def examined(name: str, device: Any, work: Path) -> Examination:
    """Export, draw from the folder, read what was written, judge by the tightest profile that explains it."""
    pytest.importorskip("moderngl")
    from tests.ports.__main__ import draw, write
    from tests.ports.case_folder import read_case

    oracle.export(oracle.build(name), work / "cases" / name)
    given = read_case(work / "cases" / name)
    write(draw(given, device), given, work / "port")
    case = oracle.load_case(work / "cases" / name)
    submission = oracle.load_submission(work / "port", case)
    assert submission.profile == "gl"
    return oracle.check(case, replace(submission, profile=None))


@pytest.mark.parametrize("name", oracle.names())
def test_the_port_passes(name: str, device: Any, tmp_path: Path, record_property: Any) -> None:
    examination = examined(name, device, tmp_path)
    verdict, case = examination.verdict, examination.case
    assert verdict.outcome is Outcome.PASS, verdict.words()
    assert [stage.stage for stage in verdict.stages][-1] == "image"
    assert len(verdict.stages) >= 4, "hardly a stage was handed in: the test says little"
    own = judge(case, {"color": examination.handed["color"]}, PROFILES[case.profile])[-1]
    assert own.undecided.mean() <= MOST_UNDECIDED
    for stage in verdict.stages:
        print(f"{name}, {stage.stage}: width {stage.median_width}, {stage.undecided} of {stage.elements} undecided")
    print(f"{name}: {verdict.profile} by {device.renderer}; undecided by {case.profile} {own.undecided.mean():.3%}")
