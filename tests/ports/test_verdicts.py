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


BROKEN = {
    "the threshold on the wrong difference": (
        "displacement-slope",
        "displacement.frag",
        ("hit.position.z - hit.before > STEEP_THRESHOLD", "hit.before - hit.position.z > STEEP_THRESHOLD"),
        "march",
    ),
    "the sign of the shadow's bias": (
        "displacement-city",
        "displacement.frag",
        ("point.z + SHADOW_BIAS < height", "point.z - SHADOW_BIAS < height"),
        "shade",
    ),
    "the sign of the depths' bias": (
        "shadows-direct",
        "shadows_project.frag",
        ("rounded(r - bias)", "rounded(r + bias)"),
        "project",
    ),
    "the rows of the mesh exchanged": (
        "shadows-bent",
        "shadows_warp.vert",
        ("vec2 second = lerp(in_c, in_d, fraction.x);", "vec2 second = lerp(in_d, in_c, fraction.x);"),
        "warp",
    ),
    "the size as a radius": (
        "splatting-sprites",
        "splatting.vert",
        ("gl_PointSize = size;", "gl_PointSize = 2.0 * size;"),
        "raster",
    ),
    "the distance instead of its square": (
        "splatting-lamp",
        "splatting.vert",
        ("law.y * (d * d)", "law.y * d"),
        "vertex",
    ),
}
"""One deliberate edit each: the case, the file, what is replaced by what, and the stage in which it must be found."""


@pytest.mark.parametrize("mistake", BROKEN)
def test_a_broken_port_fails_in_the_right_stage(
    mistake: str, device: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from tests.ports import gl

    name, file, (right, wrong), stage = BROKEN[mistake]
    read = gl.source
    assert read(file).count(right) == 1
    monkeypatch.setattr(gl, "source", lambda each: read(each).replace(right, wrong) if each == file else read(each))
    verdict = examined(name, device, tmp_path).verdict
    print(verdict.words())
    assert verdict.outcome is Outcome.FAIL
    assert verdict.first_wrong_stage == stage
    assert verdict.witness is not None
