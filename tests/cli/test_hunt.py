"""`ibr-ref hunt`: what it writes, that it goes on, and that what cannot be used is said in a line."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line

PORT = """
import pathlib, sys
import numpy as np
case, out = map(pathlib.Path, sys.argv[1:])
for name in ("march.hit_index", "march.steep"):
    np.save(out / f"{name}.npy", np.load(case / "expected" / f"{name}.npy"))
if BROKEN:
    steep = np.load(out / "march.steep.npy")
    np.save(out / "march.steep.npy", ~steep)
"""


@pytest.fixture
def port(tmp_path: Path) -> str:
    (tmp_path / "port.py").write_text(PORT.replace("BROKEN", "True"))
    return f"{sys.executable} {tmp_path / 'port.py'} {{case}} {{out}}"


@pytest.fixture(autouse=True)
def soon_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ibr_ref.testing.hunting.SHRINKING", 1.0)


@pytest.mark.long
def test_a_bug_is_a_case_from_then_on(run: Run, port: str, tmp_path: Path, one_thread: None) -> None:
    out = tmp_path / "bugs"
    code, said, err = run("hunt", "--port", port, "--method", "displacement", "--seconds", 2, "--out", out)
    assert code == 1, err
    assert "FAIL: displacement-march.steep, first wrong in stage march" in said
    assert "1 new bug, 0 known from before." in said
    assert json.loads((out / "hunt.json").read_text())["bugs"] == [
        {"method": "displacement", "stage": "march", "array": "march.steep", "causes": []}
    ]
    assert (out / "reports" / "displacement-march.steep.html").exists()
    assert any((out / "examples").rglob("*"))
    code, table, _ = run("check", out / "cases", out / "drawn")
    assert code == 1
    assert table.startswith("FAIL          displacement-march.steep")
    code, said, _ = run("hunt", "--port", port, "--method", "displacement", "--seconds", 1, "--out", out)
    assert code == 1
    assert "0 new bugs, 1 known from before." in said
    (tmp_path / "port.py").write_text(PORT.replace("BROKEN", "False"))
    code, said, err = run("hunt", "--port", port, "--method", "displacement", "--seconds", 1, "--out", out)
    assert code == 0, err
    assert "mended: displacement-march.steep" in said
    assert "0 new bugs, 0 known from before." in said
    code, table, _ = run("check", out / "cases", out / "drawn")
    assert not table.startswith("FAIL")


def test_a_right_port(run: Run, port: str, tmp_path: Path, one_thread: None) -> None:
    (tmp_path / "port.py").write_text(PORT.replace("BROKEN", "False"))
    code, said, _ = run("hunt", "--port", port, "--method", "displacement", "--seconds", 1, "--out", tmp_path / "bugs")
    assert code == 0
    assert "0 new bugs, 0 known from before." in said


def test_what_cannot_be_used(run: Run, port: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = ("--out", tmp_path / "new")
    assert_one_line(run("hunt", *out), "--port COMMAND, or --page")
    assert_one_line(run("hunt", "--page", "--port", port, *out), "--page")
    assert_one_line(run("hunt", "--page", "--serve", *out), "--serve")
    assert_one_line(run("hunt", "--port", "./my_port", *out), "port", "{case} and {out}")
    assert_one_line(run("hunt", "--port", "'", *out), "port", "as a shell would read it")
    assert_one_line(run("hunt", "--port", "/no/port {case} {out}", "--seconds", 1, *out), "/no/port", "cannot be run")
    assert_one_line(run("hunt", "--port", port, "--method", "rays", *out), "method", "rays")
    assert_one_line(run("hunt", "--port", port, "--device", "gpu", *out), "device", "gpu")
    assert_one_line(run("hunt", "--port", port, "--seconds", "-1", *out), "seconds")
    assert_one_line(run("hunt", "--port", port, "--out", tmp_path), str(tmp_path), "other things")
    (tmp_path / "new" / "hunt.json").write_text("[]")
    assert_one_line(run("hunt", "--port", port, *out), "hunt.json")
    monkeypatch.setitem(sys.modules, "hypothesis", None)
    assert_one_line(run("hunt", "--port", port, *out), 'pip install "ibr_ref[hypothesis]"')
