"""Every file of a submission, bad in every way: a problem that names it, never an error and never a usable submission."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle import check
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.files import Problem, load_submission
from ibr_ref.oracle.findings import Outcome
from tests.oracle.files import damage

pytestmark = pytest.mark.usefixtures("one_thread")


@pytest.fixture
def handed(folder: Path) -> Path:
    """All that a port can hand in: float32 arrays, the final image as a PNG, a note."""
    expected = folder / "expected"
    (expected / "color.npy").unlink()
    for path in expected.glob("*.npy"):
        array = np.load(path)
        np.save(path, array.astype(np.float32) if array.dtype.kind == "f" else array)
    (expected / "port.json").write_text('{"profile": "vulkan"}')
    return expected


def problems(handed: Path, case: Case) -> tuple[Problem, ...]:
    """What is wrong, each on one line."""
    submission = load_submission(handed, case)
    assert submission.usable == (not submission.problems)
    for problem in submission.problems:
        assert "\n" not in str(problem)
        assert problem.file
        assert problem.found
        assert problem.allowed
    return submission.problems


def spoiled(handed: Path, case: Case, pattern: str, spoil: Callable[[Path], Any]) -> int:
    """Spoil each file in turn; the first problem must be its own."""
    count = 0
    for file in sorted(handed.glob(pattern)):
        with damage.spare(file):
            if spoil(file) is not False:
                assert file.name in [problem.file.split(":")[0] for problem in problems(handed, case)], file.name
                count += 1
    assert not problems(handed, case)
    return count


@pytest.mark.parametrize("way", [way for way in damage.FILES if way != "deleted"])
def test_any_file(handed: Path, full_case: Case, way: str) -> None:
    assert spoiled(handed, full_case, "*", damage.FILES[way]) > 15
    assert not damage.Ran.count


@pytest.mark.parametrize("way", damage.ARRAYS)
def test_any_array(handed: Path, full_case: Case, way: str) -> None:
    assert spoiled(handed, full_case, "*.npy", damage.ARRAYS[way]) > 14
    assert not damage.Ran.count


@pytest.mark.parametrize("way", damage.MAYBE)
def test_any_array_to_which_it_applies(handed: Path, full_case: Case, way: str) -> None:
    assert spoiled(handed, full_case, "*.npy", damage.MAYBE[way]) > 5


@pytest.mark.sampled(3)
def test_a_stage_without_a_number_is_named(handed: Path, full_case: Case) -> None:
    """It is judged, as nothing may be right; where it is wrong, nothing was drawn. Margins are not judged."""
    named = 0
    for file in sorted(handed.glob("*.npy")):
        with damage.spare(file):
            if not damage.with_nan(file) or "margin" in file.name:
                continue
            verdict = check(full_case, load_submission(handed, full_case), name_causes=False).verdict
            assert verdict.outcome is Outcome.INCONCLUSIVE, file.name
            assert any(reason.startswith(file.name) for reason in verdict.reasons), verdict.reasons
            named += 1
    assert named > 5


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", '{"profile": "abacus"}', '{"profile": 3}', '{"profile": null, "more": 1}', "\x00", "[" * 9999],
)
def test_a_note(handed: Path, full_case: Case, text: str) -> None:
    (handed / "port.json").write_text(text)
    (problem,) = problems(handed, full_case)
    assert problem.file.startswith("port.json")


def test_a_missing_file_is_no_problem(handed: Path, full_case: Case) -> None:
    for file in sorted(handed.glob("*")):
        with damage.spare(file):
            file.unlink()
            found = problems(handed, full_case)
            assert all("all pages" in problem.allowed for problem in found), found


def test_a_link_that_leads_out(handed: Path, full_case: Case) -> None:
    (handed / "depth.npy").rename(handed.parent / "depth.npy")
    (handed / "depth.npy").symlink_to(handed.parent / "depth.npy")
    (problem,) = problems(handed, full_case)
    assert "out of the folder" in problem.found


def test_no_folder(maps_case: Case, tmp_path: Path) -> None:
    for path in (tmp_path / "nowhere", tmp_path / "nowhere.npz", tmp_path / "file"):
        (tmp_path / "file").write_text("")
        with pytest.raises(OSError, match=path.name):
            load_submission(path, maps_case)


# --- Archives --------------------------------------------------------------------------------------------------------


def archive_of(path: Path, members: dict[str, bytes], compression: int = zipfile.ZIP_DEFLATED) -> Path:
    """An archive with these members."""
    with zipfile.ZipFile(path, "w", compression) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return path


def color_member(case: Case) -> dict[str, bytes]:
    return {"color.npy": damage.npy(case.frame.color)}


@pytest.mark.parametrize("way", [way for way in damage.FILES if way not in ("deleted", "a directory")])
def test_an_archive(maps_case: Case, tmp_path: Path, way: str) -> None:
    (tmp_path / "port").mkdir()
    path = archive_of(tmp_path / "port" / "all.npz", color_member(maps_case))
    assert not problems(tmp_path / "port", maps_case)
    damage.FILES[way](path)
    assert problems(tmp_path / "port", maps_case)[0].file == "all.npz"


@pytest.mark.parametrize("way", [way for way in damage.ARRAYS if way != "a header of 10 GB and a file"])
def test_a_member(maps_case: Case, tmp_path: Path, way: str) -> None:
    """A file of 10 GB is not put into an archive: `test_an_archive_that_inflates` has the like."""
    file = tmp_path / "depth.npy"
    np.save(file, maps_case.frame.depth)
    damage.ARRAYS[way](file)
    path = archive_of(tmp_path / "all.npz", {**color_member(maps_case), "depth.npy": file.read_bytes()})
    assert problems(path, maps_case)[0].file == "all.npz/depth.npy"
    assert not damage.Ran.count


@pytest.mark.long
def test_an_archive_that_inflates(maps_case: Case, tmp_path: Path) -> None:
    data = damage.header("<f8", f"({2**25},)") + bytes(2**28)
    path = archive_of(tmp_path / "all.npz", {"depth.npy": data})
    assert path.stat().st_size < 2**20
    assert "268435" in problems(path, maps_case)[0].found


def test_an_archive_with_a_wrong_checksum(maps_case: Case, tmp_path: Path) -> None:
    path = archive_of(tmp_path / "all.npz", color_member(maps_case), zipfile.ZIP_STORED)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(bytes(data))
    assert problems(path, maps_case)


@pytest.mark.parametrize("name", ["../color.npy", "/color.npy", "color", "colour.npy", "x/color.npy", "color.npy/"])
def test_a_member_by_another_name(maps_case: Case, tmp_path: Path, name: str) -> None:
    path = archive_of(tmp_path / "all.npz", {name: damage.npy(maps_case.frame.color)})
    found = problems(path, maps_case)
    assert bool(found) == (name != "color")
    assert [entry.name for entry in tmp_path.iterdir()] == ["all.npz"]


def test_an_array_that_comes_twice(maps_case: Case, tmp_path: Path) -> None:
    archive_of(tmp_path / "all.npz", color_member(maps_case))
    np.save(tmp_path / "color.npy", maps_case.frame.color)
    (problem,) = problems(tmp_path, maps_case)
    assert "second color" in problem.found
