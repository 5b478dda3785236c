"""Exports are whole or not there, and never take the place of anything else."""

from __future__ import annotations

from dataclasses import fields as dataclass_fields
from pathlib import Path
from typing import Any

import pytest

from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import export, load_case
from ibr_ref.oracle.files import export as export_function
from tests.oracle.files.cases import displacement_parallel, shadows_direct, shadows_warped, splatting_cameras

pytestmark = pytest.mark.usefixtures("one_thread")


def tree(folder: Path) -> dict[str, bytes]:
    """All files of a folder."""
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def renamed(case: Case, **changes: Any) -> Case:
    fields = {each.name: getattr(case, each.name) for each in dataclass_fields(case) if each.init}
    return Case(**{**fields, **changes})


def test_a_new_folder_and_an_empty_one(maps_case: Case, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for name in ("new", "empty"):
        export(maps_case, tmp_path / name)
        assert load_case(tmp_path / name).name == "maps"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["empty", "new"]
    assert (tmp_path / "new").stat().st_mode & 0o077, "others cannot read it"


def test_the_same_case_is_replaced(maps_case: Case, tmp_path: Path) -> None:
    export(maps_case, tmp_path / "case")
    before = tree(tmp_path / "case")
    (tmp_path / "case" / "expected" / "color.npy").write_bytes(b"damaged")
    export(maps_case, tmp_path / "case")
    assert tree(tmp_path / "case") == before
    assert [p.name for p in tmp_path.iterdir()] == ["case"]


@pytest.mark.parametrize("kind", ["another case", "other files", "a port's files", "a file", "a link to a folder"])
def test_what_is_not_replaced(maps_case: Case, tmp_path: Path, kind: str) -> None:
    folder = tmp_path / "case"
    if kind == "another case":
        export(renamed(maps_case, name="other"), folder)
    elif kind == "a file":
        folder.write_text("precious")
    else:
        folder.mkdir()
        if kind == "a port's files":
            export(maps_case, folder)
            (folder / "mine").mkdir()
        (folder / "mine" if (folder / "mine").is_dir() else folder).joinpath("precious.txt").write_text("precious")
        if kind == "a link to a folder":
            folder.rename(tmp_path / "elsewhere")
            folder.symlink_to(tmp_path / "elsewhere")
    before = tree(tmp_path)
    with pytest.raises(OSError, match="case") as error:
        export(maps_case, folder)
    assert "\n" not in str(error.value)
    assert tree(tmp_path) == before


def test_force_replaces_cases_alone(maps_case: Case, tmp_path: Path) -> None:
    export(renamed(maps_case, name="other"), tmp_path / "case")
    (tmp_path / "case" / "precious.txt").write_text("precious")
    export(maps_case, tmp_path / "case", force=True)
    assert load_case(tmp_path / "case").name == "maps"
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "precious.txt").write_text("precious")
    with pytest.raises(OSError, match="other things"):
        export(maps_case, tmp_path / "home", force=True)
    assert tree(tmp_path / "home") == {"precious.txt": b"precious"}


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(28, "No space left on device"), MemoryError()])
@pytest.mark.parametrize("after", [0, 1, 9, 20])
@pytest.mark.parametrize("there", [False, True])
def test_an_interruption_leaves_what_was_there(
    maps_case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException, after: int, there: bool
) -> None:
    if there:
        export(maps_case, tmp_path / "case")
    before, writes = tree(tmp_path), 0

    def write_array(file: Any, array: Any) -> None:
        nonlocal writes
        file.write(b"half")
        writes += 1
        if writes > after:
            raise error

    monkeypatch.setitem(export_function.__globals__, "write_array", write_array)
    with pytest.raises(type(error)):
        export(maps_case, tmp_path / "case")
    assert writes == after + 1
    assert tree(tmp_path) == before
    assert [p.name for p in tmp_path.iterdir()] == (["case"] if there else [])


def test_a_rename_that_fails_brings_the_old_folder_back(
    maps_case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    export(maps_case, tmp_path / "case")
    before, rename = tree(tmp_path), Path.rename

    def failing(path: Path, target: Path) -> Path:
        if "old" not in (path.name, Path(target).name):
            raise OSError(5, "Input/output error")
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", failing)
    with pytest.raises(OSError, match="cannot be written"):
        export(maps_case, tmp_path / "case")
    assert tree(tmp_path) == before
    assert [p.name for p in tmp_path.iterdir()] == ["case"]


def test_nowhere(maps_case: Case, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file" / "case", tmp_path / "file" / "deeper" / "case", tmp_path / ("x" * 300)):
        with pytest.raises(OSError, match=path.name):
            export(maps_case, path)


def test_missing_folders_are_made(maps_case: Case, tmp_path: Path) -> None:
    export(maps_case, tmp_path / "cases" / "easy" / "maps")
    assert load_case(tmp_path / "cases" / "easy" / "maps").name == maps_case.name


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"method": "painting"}, "painting"),
        ({"kind": "hard"}, "kind"),
        ({"profile": "abacus"}, "abacus"),
        ({"name": "a/b"}, "a/b"),
        ({"name": "../x"}, "../x"),
        ({"inputs": {"maps": 3}}, "maps"),
    ],
)
def test_a_case_that_cannot_be_written(maps_case: Case, tmp_path: Path, change: dict[str, Any], word: str) -> None:
    with pytest.raises(ValueError, match=word) as error:
        export(renamed(maps_case, **change), tmp_path / "case")
    assert "\n" not in str(error.value)
    assert not list(tmp_path.iterdir())


def test_inputs_that_are_missing_or_wrong(tmp_path: Path) -> None:
    warped = shadows_warped()
    for case, inputs, word in (
        (warped, {}, "shadows.Maps"),
        (shadows_direct(), {"maps": warped.inputs["maps"]}, "direct"),
        (splatting_cameras(), {"normals": []}, "0 arrays"),
        (splatting_cameras(), {"normals": [1, 2, 3]}, "uint8"),
        (displacement_parallel(), {"maps": None}, "displacement"),
    ):
        with pytest.raises(ValueError, match=word):
            export(renamed(case, inputs=inputs), tmp_path / "case")
    assert not list(tmp_path.iterdir())
