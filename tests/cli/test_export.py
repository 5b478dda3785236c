"""`ibr-ref export`."""

from __future__ import annotations

import fnmatch
import json
from pathlib import Path

import pytest

from ibr_ref.oracle import cases
from ibr_ref.oracle.files import load_case
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line
from tests.oracle.files.cases import CASES


@pytest.fixture(autouse=True)
def small_cases(monkeypatch: pytest.MonkeyPatch, one_thread: None) -> None:
    """Two small cases instead of the built-in ones."""
    small = {name: CASES[name] for name in ("maps", "parallel")}
    monkeypatch.setattr(cases, "names", lambda: list(small))
    monkeypatch.setattr(cases, "matching", lambda pattern: fnmatch.filter(small, pattern))
    monkeypatch.setattr(cases, "build", lambda name: small[name]() if name in small else _unknown(name))


def _unknown(name: str) -> None:
    raise ValueError(f"case: found {name!r}, allowed: maps | parallel")


def test_one_case(run: Run, tmp_path: Path) -> None:
    assert run("export", "maps", tmp_path / "made" / "box") == (0, "", "")
    assert load_case(tmp_path / "made" / "box").name == "maps"
    assert run("export", "maps", tmp_path / "box") == (0, "", "")
    assert run("export", "maps", tmp_path / "box") == (0, "", "")


def test_all_cases(run: Run, tmp_path: Path) -> None:
    assert run("export", "all", tmp_path / "cases") == (0, "", "")
    assert sorted(path.name for path in (tmp_path / "cases").iterdir()) == ["maps", "parallel"]
    for path in (tmp_path / "cases").iterdir():
        assert load_case(path).name == path.name


def test_cases_by_pattern(run: Run, tmp_path: Path) -> None:
    assert run("export", "par*", tmp_path / "cases") == (0, "", "")
    assert [path.name for path in (tmp_path / "cases").iterdir()] == ["parallel"]


def test_folders_of_ones_own(run: Run, tmp_path: Path) -> None:
    assert run("export", "all", tmp_path / "cases")[0] == 0
    assert run("export", tmp_path / "cases", tmp_path / "again") == (0, "", "")
    assert sorted(path.name for path in (tmp_path / "again").iterdir()) == ["maps", "parallel"]
    assert run("export", tmp_path / "cases" / "maps", tmp_path / "one") == (0, "", "")
    for name in ("case.json", "manifest.json"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "cases" / "maps" / name).read_bytes()


def test_the_list(run: Run) -> None:
    code, out, err = run("export", "--list")
    assert (code, err) == (0, "")
    first, second = out.splitlines()
    assert first.split()[:2] == ["maps", "easy"]
    assert second.endswith("parallel, for the tests of files")


def test_the_schema(run: Run) -> None:
    code, out, err = run("export", "--schema")
    assert (code, err) == (0, "")
    assert json.loads(out)["title"] == "ibr_ref case"


def test_help_has_examples(run: Run) -> None:
    code, out, _ = run("export", "--help")
    assert code == 0
    assert "ibr-ref export all cases" in out


def test_bad_arguments(run: Run, tmp_path: Path) -> None:
    assert_one_line(run("export"), "CASE", "DIR")
    assert_one_line(run("export", "maps"), "CASE", "DIR")
    assert_one_line(run("export", "nonsense", tmp_path / "x"), "nonsense", "maps")
    assert_one_line(run("export", "map-*", tmp_path / "x"), "'map-*'", "maps-*")
    (tmp_path / "empty").mkdir()
    assert_one_line(run("export", tmp_path / "empty", tmp_path / "x"), "empty")
    (tmp_path / "empty").rmdir()
    assert_one_line(run("export", "maps", "--list"), "maps", "--list")
    (tmp_path / "file").write_text("precious")
    for place in (tmp_path / "file", tmp_path / "file" / "x"):
        assert_one_line(run("export", "maps", place), "file")
        assert_one_line(run("export", "all", place), "file")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_another_case_is_replaced_by_force_alone(run: Run, tmp_path: Path) -> None:
    assert run("export", "maps", tmp_path / "box")[0] == 0
    assert_one_line(run("export", "parallel", tmp_path / "box"), "maps", "parallel")
    assert run("export", "parallel", tmp_path / "box", "--force") == (0, "", "")
    assert load_case(tmp_path / "box").name == "parallel"
