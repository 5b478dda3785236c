"""`ibr-ref check CASES DRAWN`: many at once, as JSON, pages and JUnit XML, and again whenever files change."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from ibr_ref import oracle
from ibr_ref.cli import check
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line
from tests.oracle.files.older import older
from tests.oracle.tiny_cases import TINY

NAMES = ("displacement-hill", "displacement-tile", "splatting-dots", "splatting-round-dots")


@pytest.fixture(autouse=True)
def no_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """The built-in cases are not built, to see whether a wrong picture is one of theirs: that takes a minute."""
    monkeypatch.setattr("ibr_ref.oracle.answer.names", lambda method: [])


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("exported")
    for name in NAMES:
        oracle.export(TINY[name.replace("d-d", "d_d")](), folder / name)
    return folder


@pytest.fixture
def cases(exported: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(exported, tmp_path / "cases"))


@pytest.fixture
def drawn(cases: Path, tmp_path: Path) -> Path:
    """What is expected, by a port that draws each case."""
    for name in NAMES:
        draw(cases, tmp_path / "drawn", name)
    return tmp_path / "drawn"


def draw(cases: Path, drawn: Path, name: str, change: float = 0.0) -> None:
    (drawn / name).mkdir(parents=True, exist_ok=True)
    np.save(drawn / name / "color.npy", np.clip(np.load(cases / name / "expected" / "color.npy") + change, 0, 1))


def outcomes(out: str) -> dict[str, str]:
    return {line.split()[1]: line.split()[0] for line in out.splitlines()[:-1]}


def test_all_right(run: Run, cases: Path, drawn: Path) -> None:
    code, out, err = run("check", cases, drawn)
    assert (code, err) == (0, "")
    assert outcomes(out) == dict.fromkeys(NAMES, "PASS")
    assert out.splitlines()[-1] == "4 cases: 4 PASS."


def test_the_worst_is_the_exit_code_and_what_has_no_partner_is_said(run: Run, cases: Path, drawn: Path) -> None:
    shutil.rmtree(drawn / "displacement-tile")
    (drawn / "displacement-tyle").mkdir()
    (cases / "notes").mkdir()
    code, out, _ = run("check", cases, drawn)
    assert code == 2
    assert outcomes(out)["displacement-tile"] == outcomes(out)["displacement-tyle"] == "INCONCLUSIVE"
    assert "no drawing: " in out
    assert "a drawing without a case" in out
    draw(cases, drawn, "splatting-dots", 0.1)
    (cases / "splatting-round-dots" / "README.md").unlink()
    code, out, _ = run("check", cases, drawn)
    assert code == 1
    assert "README.md" in out
    assert {**dict.fromkeys(NAMES, "INCONCLUSIVE"), "displacement-tyle": "INCONCLUSIVE"} | {
        "displacement-hill": "PASS",
        "splatting-dots": "FAIL",
    } == outcomes(out)
    assert "first wrong in image: " in out


def test_an_archive_is_a_drawing_too(run: Run, cases: Path, drawn: Path) -> None:
    shutil.rmtree(drawn / "splatting-dots")
    np.savez(drawn / "splatting-dots.npz", color=np.load(cases / "splatting-dots" / "expected" / "color.npy"))
    assert run("check", cases, drawn)[0] == 0


def test_it_stops_at_the_first_that_does_not_pass(run: Run, cases: Path, drawn: Path) -> None:
    draw(cases, drawn, "displacement-tile", 0.1)
    code, out, _ = run("check", cases, drawn, "--fail-fast")
    assert code == 1
    assert [*outcomes(out)] == ["displacement-hill", "displacement-tile"]
    assert out.endswith("2 cases: 1 FAIL, 1 PASS; 2 not tried.\n")


def test_json_pages_and_junit(run: Run, cases: Path, drawn: Path, tmp_path: Path) -> None:
    draw(cases, drawn, "displacement-tile", 0.1)
    shutil.rmtree(drawn / "splatting-dots")
    report = tmp_path / "reports" / "of" / "today"
    code, out, err = run("check", cases, drawn, "--json", "-", "--junit", tmp_path / "j.xml", "--report", report)
    assert code == 1
    verdicts = [oracle.Verdict.model_validate(each) for each in json.loads(out)]
    assert outcomes(err) == {verdict.case: verdict.outcome for verdict in verdicts}
    pages = {f"{name}.html" for name in NAMES if name != "splatting-dots"}
    assert {path.name for path in report.iterdir()} == {"index.html", *pages}
    index = (report / "index.html").read_text("utf-8")
    assert all(name in index for name in NAMES)
    assert all(f'href="{page}"' in index for page in pages)
    (suite,) = ElementTree.fromstring((tmp_path / "j.xml").read_bytes())
    assert [suite.attrib[name] for name in ("tests", "failures", "errors")] == ["4", "1", "1"]
    tests = {test.attrib["name"]: test for test in suite}
    assert [*tests] == [*NAMES]
    assert tests["displacement-tile"].attrib["classname"] == "ibr_ref.displacement"
    (failure,) = tests["displacement-tile"]
    assert (failure.tag, failure.text) == ("failure", verdicts[1].words())
    (error,) = tests["splatting-dots"]
    assert error.tag == "error"
    assert "no drawing" in (error.text or "")
    assert [*tests["displacement-hill"]] == []


def test_words_that_xml_cannot_hold() -> None:
    verdict = oracle.Verdict(
        outcome=oracle.Outcome.INCONCLUSIVE, case="a\x00<b>&", method="m", reasons=('"\x1b\ufffe',)
    )
    (suite,) = ElementTree.fromstring(oracle.report.junit([(verdict, 0.25)]))
    assert suite[0].attrib["name"] == "a\ufffd<b>&"
    assert '"\ufffd\ufffd' in (suite[0][0].text or "")


def test_a_folder_of_another_version_is_said(run: Run, cases: Path, drawn: Path) -> None:
    older(cases / "splatting-dots")
    code, _, err = run("check", cases, drawn)
    assert code == 0
    assert err.count("\n") == 1
    assert f"{cases / 'splatting-dots'}: 1 of " in err
    assert "(depth), made by another 0.0.1" in err
    assert "made by" in run("check", cases / "splatting-dots", drawn / "splatting-dots")[2]


def test_nothing_to_check(run: Run, drawn: Path, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert_one_line(run("check", tmp_path / "empty", drawn), "empty")
    assert_one_line(run("check", "displacment-*", drawn), "displacment-*", "displacement-*")


class Interrupted:
    """In place of the clock's sleep: what happens between two looks, and at last Ctrl-C."""

    def __init__(self, steps: Iterator[object]) -> None:
        self.steps = steps

    def __call__(self, seconds: float) -> None:
        try:
            next(self.steps)
        except StopIteration:
            raise KeyboardInterrupt from None


def test_it_watches(run: Run, cases: Path, drawn: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One check at first, one for each change that has settled, none without; cases that did not change are kept."""
    judged: list[str] = []
    one = oracle.load_submission
    monkeypatch.setattr(oracle, "load_submission", lambda folder, case: judged.append(case.name) or one(folder, case))

    def days() -> Iterator[object]:
        yield  # nothing happens
        assert judged == [*NAMES]
        draw(cases, drawn, "splatting-dots", 0.1)
        yield
        (drawn / "splatting-dots" / "depth.npy").write_bytes(b"still being written")
        yield
        assert judged == [*NAMES]
        (drawn / "splatting-dots" / "depth.npy").unlink()
        yield
        yield
        assert judged == [*NAMES, "splatting-dots"]
        shutil.rmtree(cases / "splatting-dots")
        yield
        yield
        yield

    monkeypatch.setattr(check.time, "sleep", Interrupted(days()))
    code, out, _ = run("check", cases, drawn, "--watch")
    assert code == 2  # of the last check: a drawing without a case
    assert judged == [*NAMES, "splatting-dots"]
    assert out.count(" cases: ") == 3
    assert "FAIL          splatting-dots" in out
