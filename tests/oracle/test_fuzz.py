"""A sample of `python -m tests.oracle.fuzz_submissions`, and every kind of replacement once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ibr_ref import oracle
from ibr_ref.cli import main
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.findings import Outcome
from ibr_ref.oracle.plugin import PortCase
from tests.oracle.fuzz_submissions import BLOCK, Input, complaint, made, replacements, run
from tests.oracle.tiny_cases import TINY, handed_of

EACH = 6
ANYWHERE = {"any": np.ones(1, np.bool_)}
"""Where an input shows, of one that is all tampered with."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", TINY)
def test_whole_arrays_replaced_are_an_answer_and_never_pass_where_it_shows(name: str) -> None:
    block = [*TINY].index(name) * (1 + len(TINY) * 2)  # of several profiles
    first = BLOCK * (block - block % len(TINY) + [*TINY].index(name))
    inputs = [made(number, 1) for number in range(first, first + EACH)]
    assert {one.case for one in inputs} == {name}
    found = [complaint(one) for one in inputs]
    assert [words for _, words in found if words is not None] == []


@pytest.mark.sampled(4)
@pytest.mark.parametrize("change", ["zeros", "constant", "scaled by 1e-4", "moved", "NaN", "1e30", "infinity"])
@pytest.mark.parametrize("array", ["warp.grid", "warp.row_grids"])
def test_a_grid_that_covers_nothing(array: str, change: str) -> None:
    """An IndexError once, and the exit code of FAIL."""
    case = TINY["shadows-warp"]()
    handed = handed_of(case)
    handed[array] = replacements(array, handed[array])[change](handed[array], np.random.default_rng(0))
    outcome, words = complaint(Input(0, "shadows-warp", {array: change}, handed, "ieee32", ANYWHERE))
    assert words is None
    assert outcome in (Outcome.FAIL, Outcome.INCONCLUSIVE)


def test_where_a_device_may_compute_anything_nothing_has_to_be_found() -> None:
    """A NaN in one of a pixel's numbers, there and elsewhere."""
    case = TINY["displacement-cut"]()
    faces = {name: handed_of(case)[name] for name in ("raster.face", "march.steep")}
    for pixel, passes in (((5, 5), True), ((8, 8), False)):
        hit = handed_of(case)["march.hit"].copy()
        apart = np.zeros(hit.shape, np.bool_)
        hit[pixel][1], apart[pixel] = np.nan, True
        assert np.isfinite(handed_of(case)["march.hit"][pixel]).all()
        outcome, words = complaint(Input(0, case.name, {}, {**faces, "march.hit": hit}, "gl", {"march.hit": apart}))
        assert (outcome, words) == (Outcome.PASS if passes else Outcome.FAIL, None), pixel


def test_an_index_beyond_the_search_has_no_endless_trace() -> None:
    """A witness listed every sample up to the port's own index: 2^31 of them once."""
    case = TINY["displacement-hill"]()
    stages = {name: array for name, array in handed_of(case).items() if name not in ("color", "depth")}
    stages["march.linear_index"] = np.full_like(stages["march.linear_index"], 1000)
    verdict = oracle.check(case, oracle.submission_from_arrays(case, stages=stages), profile="ieee32").verdict
    assert verdict.first_wrong_stage == "march"
    assert all(0 < len(witness.trace) < 100 for witness in verdict.witnesses)


@pytest.mark.parametrize("array", ["vertex.clip", "vertex.patch"])
def test_no_face_at_all(array: str) -> None:
    """A KeyError once, where the other of the two arrays was not handed in."""
    case = TINY["displacement-tile"]()
    handed = {array: handed_of(case)[array][:0]}
    outcome, words = complaint(Input(0, "displacement-tile", {array: "no face"}, handed, "ieee32", ANYWHERE))
    assert (outcome, words) == (Outcome.FAIL, None)


@pytest.mark.parametrize("change", ["one NaN", "NaN", "some infinite", "1e30", "largest float32"])
@pytest.mark.parametrize("name", ["displacement-tile", "displacement-cut"])
def test_corners_that_are_no_numbers(name: str, change: str) -> None:
    handed = handed_of(TINY[name]())
    handed["vertex.clip"] = replacements("vertex.clip", handed["vertex.clip"])[change](
        handed["vertex.clip"], np.random.default_rng(0)
    )
    outcome, words = complaint(Input(1, name, {"vertex.clip": change}, handed, "ieee32", ANYWHERE))
    assert words is None
    assert outcome in (Outcome.FAIL, Outcome.INCONCLUSIVE)


def test_inputs_follow_from_their_numbers() -> None:
    for number in (3, 777, 10_003):
        one, again = made(number, 4), made(number, 4)
        assert (one.case, one.changes, one.profile) == (again.case, again.changes, again.profile)
        for name in one.handed:
            np.testing.assert_equal(one.handed[name], again.handed[name])
    assert {made(BLOCK * i, 0).profile for i in range(len(TINY) * len(PROFILES))} == {*PROFILES}
    assert len([*run(range(5, 8), 0, 1)]) == 3


def test_the_plugin_answers_too(tmp_path: Path) -> None:
    case = TINY["shadows-warp"]()
    stages = handed_of(case)
    picture = {name: stages.pop(name) for name in ("color", "depth")}
    stages["warp.grid"] = np.zeros_like(stages["warp.grid"])
    with pytest.raises(pytest.fail.Exception, match="first wrong in stage warp"):
        PortCase(case, None, tmp_path, tmp_path).check(**picture, stages=stages)
    assert (tmp_path / "shadows-warp.html").stat().st_size


def test_the_command_line_answers_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    case, port = TINY["shadows-warp"](), tmp_path / "port"
    oracle.export(case, tmp_path / "case")
    port.mkdir()
    for name, array in handed_of(case).items():
        np.save(port / f"{name}.npy", np.zeros_like(array) if name == "warp.row_grids" else array)
    monkeypatch.setattr("sys.argv", ["ibr-ref", "check", str(tmp_path / "case"), str(port)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 1
    assert "FAIL: shadows-warp, first wrong in stage warp" in capsys.readouterr().out
