"""`ibr-ref check`: verdicts by exit code, in words, JSON and as a page; errors in one line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ibr_ref import cli, oracle
from ibr_ref.oracle import Outcome, Verdict


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cases") / "ball"
    oracle.export(oracle.build("splatting-ball"), folder)
    return folder


def run(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr("sys.argv", ["ibr-ref", "check", *map(str, words)])
    with pytest.raises(SystemExit) as stop:
        cli.main()
    return int(stop.value.code or 0)


def port(case: Path, folder: Path, change: float = 0.0) -> Path:
    """A port that draws what is expected, and more light."""
    folder.mkdir()
    np.save(folder / "color.npy", np.clip(np.load(case / "expected" / "color.npy") + change, 0, 1))
    return folder


@pytest.mark.parametrize(("change", "outcome"), [(0.0, Outcome.PASS), (0.01, Outcome.FAIL)])
def test_the_verdict_is_the_exit_code_the_words_and_the_json(
    case: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    change: float,
    outcome: Outcome,
) -> None:
    folder = port(case, tmp_path / "port", change)
    written = tmp_path / "verdict.json", tmp_path / "verdict.html"
    code = run(monkeypatch, case, folder, "--json", written[0], "--report", written[1])
    assert code == outcome.exit_code == [*Outcome].index(outcome)
    verdict = Verdict.model_validate_json(written[0].read_text("utf-8"))
    assert verdict.outcome is outcome
    assert capsys.readouterr().out.strip() == verdict.words()
    assert f"<title>{outcome}: splatting-ball</title>" in written[1].read_text("utf-8")


def test_a_submission_that_cannot_be_judged_is_exit_code_2(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "port"
    folder.mkdir()
    assert run(monkeypatch, case, folder) == 2
    assert "INCONCLUSIVE" in capsys.readouterr().out


def test_a_declared_device_is_kept(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = port(case, tmp_path / "port")
    (folder / "port.json").write_text(json.dumps({"profile": "webgpu"}))
    assert run(monkeypatch, case, folder) == 0
    assert "on webgpu (declared)" in capsys.readouterr().out
    assert run(monkeypatch, case, folder, "--device", "vulkan") == 0
    assert "on vulkan (declared)" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "allowed: CASE and PORT, or --self-test"),
        (["CASE"], "allowed: CASE and PORT, or --self-test"),
        (["CASE", "NOWHERE"], "NOWHERE"),
        (["NOWHERE", "PORT"], "NOWHERE"),
        (["CASE", "PORT", "--device", "opengl"], "device: found 'opengl', allowed: ieee32"),
        (["CASE", "PORT", "--method", "splatting"], "--method goes with --self-test"),
        (["CASE", "PORT", "--json", "NOWHERE/verdict.json"], "does not exist"),
        (["CASE", "PORT", "--report", "NOWHERE/verdict.html"], "does not exist"),
        (["--self-test", "--method", "raytracing"], "method: found 'raytracing'"),
        (["CASE", "PORT", "--self-test"], "--self-test takes no folders"),
    ],
)
def test_errors_are_one_line_and_exit_code_2(
    case: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    message: str,
) -> None:
    places = {"CASE": str(case), "PORT": str(port(case, tmp_path / "port")), "NOWHERE": str(tmp_path / "NOWHERE")}
    for name, place in places.items():
        words = [word.replace(name, place) for word in words]
    assert run(monkeypatch, *words) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.startswith("ibr-ref: ")
    assert error.count("\n") == 1
