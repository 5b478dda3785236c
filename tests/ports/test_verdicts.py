"""The oracle on the GLSL ports: from a case's folder to the verdict, on every case; right ports pass, broken ones do not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref import oracle
from ibr_ref.oracle import PROFILES, Case, Examination, Outcome
from ibr_ref.oracle.declaration import ANY
from ibr_ref.oracle.examination import judge
from ibr_ref.oracle.files.submission import Submission
from ibr_ref.oracle.judgement import Glances
from ibr_ref.oracle.referees import referee
from tests.oracle.displacement.test_cases import MOST_UNDECIDED, WALLS
from tests.oracle.judgements import complaints


def submitted(case: Case, device: Any, work: Path, **options: Any) -> tuple[Case, Submission]:
    """Export, draw from the folder, read what was written."""
    from ibr_ref.ports.case_folder import read_case
    from ibr_ref.ports.drawing import Drawer, drawn

    oracle.export(case, work / "cases" / case.name)
    drawer = Drawer("glsl", "", {"profile": "gl"}, lambda folder: drawn(read_case(folder), "glsl", device, **options))
    drawer.into(work / "cases" / case.name, work / "port")
    loaded = oracle.load_case(work / "cases" / case.name)
    submission = oracle.load_submission(work / "port", loaded)
    assert submission.profile == "gl"
    return loaded, submission


def examined(case: Case, device: Any, work: Path, **options: Any) -> Examination:
    """As if nothing had been declared: by the tightest profile that explains it."""
    loaded, submission = submitted(case, device, work, **options)
    return oracle.check(loaded, replace(submission, declaration=ANY))


def assert_passes(examination: Examination) -> None:
    verdict = examination.verdict
    assert verdict.outcome is Outcome.PASS, verdict.words()
    assert [stage.stage for stage in verdict.stages][-1] == "image"
    assert len(verdict.stages) >= 4, "hardly a stage was handed in: the test says little"


REAL_SIZED = ("displacement-metropolis", "splatting-kettle", "shadows-stage")


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", [name for name in oracle.names() if name not in REAL_SIZED])
def test_the_port_passes(name: str, device: Any, tmp_path: Path) -> None:
    examination = examined(oracle.build(name), device, tmp_path)
    assert_passes(examination)
    case, verdict = examination.case, examination.verdict
    own = judge(case, {"color": examination.handed["color"]}, PROFILES[case.profile])[-1]
    assert own.undecided.mean() <= WALLS.get(name, MOST_UNDECIDED)
    width = max((stage.median_width or 0.0 for stage in verdict.stages), default=0.0)
    share = f"{own.undecided.mean():.3%} undecided by {case.profile}"
    print(f"\n{name}: {verdict.profile}, {share}, median widths up to {width:.1g}; {device.renderer}")


@pytest.mark.long
@pytest.mark.parametrize("name", REAL_SIZED)
def test_the_port_passes_in_real_size(name: str, device: Any, tmp_path: Path) -> None:
    """By what it declares: all stages everywhere, and every eighth row and column of the picture by itself,
    where a whole one takes long.

    For an undeclared one a picture of that size is judged by one device after the other, which small ones are above.
    """
    case, submission = submitted(oracle.build(name), device, tmp_path)
    judge_of, own = referee(case.method), PROFILES["gl"]
    stages = judge_of.judge_stages(case, own, submission.handed)
    assert len(stages) >= 3
    assert not complaints(stages)
    picture = {name: submission.handed[name] for name in ("color", "depth")}
    if case.method == "displacement":
        assert isinstance(judge_of, Glances)
        some = np.zeros(case.frame.depth.shape, np.bool_)
        some[::8, ::8] = True
        assert judge_of.explains(case, own, picture, "image", some.reshape(-1))
    else:
        assert not complaints([judge_of.judge_image(case, own, picture)])


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("shadows-depths", {"pcf": True}),
        ("shadows-depths", {"quantize": 8}),
        ("shadows-depths", {"quantize": 8, "pcf": True}),
        ("shadows-depths", {"policy": "nearest"}),
        ("splatting-lamp", {"shape": "disc"}),
        ("displacement-slope", {"faces": "base", "binary_steps": 0}),
        ("displacement-box", {"depth": "polygon", "linear_steps": 50}),
    ],
)
def test_parameters_that_no_case_has_together(name: str, changes: dict[str, Any], device: Any, tmp_path: Path) -> None:
    case = oracle.build(name)
    assert_passes(examined(replace(case, params=replace(case.params, **changes)), device, tmp_path))


@pytest.mark.parametrize("name", ["splatting-ball", "splatting-lamp", "splatting-discs", "splatting-among"])
def test_quads_in_place_of_point_sprites_pass(name: str, device: Any, tmp_path: Path) -> None:
    assert_passes(examined(oracle.build(name), device, tmp_path, primitive="quads"))


@pytest.fixture
def minus_one(device: Any) -> Iterator[Any]:
    """The same driver with OpenGL's own clip volume, -w <= z <= w."""
    from ibr_ref.ports.glsl import gl

    plain = gl.create_device(clip_control=False)
    yield plain
    plain.ctx.release()
    device.ctx.__enter__()  # current on this thread again


@pytest.mark.parametrize("name", ["displacement-planes", "splatting-among", "shadows-far"])
def test_the_clip_volume_of_opengl_passes(name: str, minus_one: Any, tmp_path: Path) -> None:
    assert not minus_one.zero_to_one
    assert_passes(examined(oracle.build(name), minus_one, tmp_path))


BROKEN = {
    "the threshold on the wrong difference": (
        "displacement-slope",
        "displacement_protruded.frag",
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
    "the corners of the mesh exchanged": (
        "shadows-bent",
        "shadows_warp.vert",
        ("vec2 second = lerp(in_c, in_d, shares.y);", "vec2 second = lerp(in_d, in_c, shares.y);"),
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


@pytest.mark.long
@pytest.mark.parametrize("mistake", BROKEN)
def test_a_broken_port_fails_in_the_right_stage(
    mistake: str, device: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ibr_ref.ports.glsl import gl

    name, file, (right, wrong), stage = BROKEN[mistake]
    read = gl.source
    assert read(file).count(right) == 1
    monkeypatch.setattr(gl, "source", lambda each: read(each).replace(right, wrong) if each == file else read(each))
    verdict = examined(oracle.build(name), device, tmp_path).verdict
    print(verdict.words())
    assert verdict.outcome is Outcome.FAIL
    assert verdict.first_wrong_stage == stage
    assert verdict.witness is not None
