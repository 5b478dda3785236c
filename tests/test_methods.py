"""The registry of methods: every record leads to rooms that are there, and a further method is a folder and a record."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from ibr_ref import cli, methods, oracle, pages
from ibr_ref.methods import Room
from ibr_ref.oracle import self_test
from tests.toy_method import RECORD

PACKAGE = Path(methods.__file__).parent


@pytest.mark.parametrize("method", methods.records(), ids=lambda method: method.name)
def test_every_room_is_there(method: methods.Method) -> None:
    for field in fields(method):
        room = getattr(method, field.name)
        if isinstance(room, Room):
            assert room.open() is not None, field.name
    render = method.package.open().render
    assert callable(render)
    assert all(name.startswith(f"{method.name}-") for name in method.cases.open())
    assert pages.page(method.name).startswith("# ")


def test_a_registry_is_read_without_what_is_in_the_rooms() -> None:
    code = "import sys; from ibr_ref import methods, pages; methods.records(); pages.names()\n"
    code += (
        "from ibr_ref.searches import SEARCHES\nassert not {'numba', 'numpy', 'pydantic', 'typer'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


LADDER = re.compile(r'[^\w](?:==|in|!=) *\(?"(displacement|splatting|shadows)"')


def test_no_other_file_lists_the_methods() -> None:
    """By their names compared; their own rooms may call themselves what they are called."""
    found = [
        f"{path.relative_to(PACKAGE)}: {line.strip()}"
        for path in sorted(PACKAGE.rglob("*.py"))
        for line in path.read_text("utf-8").splitlines()
        if LADDER.search(line)
    ]
    assert not found


@pytest.fixture
def toy() -> Iterator[None]:
    with methods.registered(RECORD):
        yield


def call(*arguments: object) -> int:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["ibr-ref", *map(str, arguments)])
        with pytest.raises(SystemExit) as exit_:
            cli.main()
    return int(exit_.value.code or 0)


def test_a_name_is_registered_once(toy: None) -> None:
    with pytest.raises(ValueError, match="method: found 'ramp', allowed: a name that no other method has"):
        methods.register(RECORD)


def test_what_was_registered_for_a_while_is_gone() -> None:
    with methods.registered(RECORD):
        assert methods.names()[-1] == "ramp"
        assert oracle.names()[-2:] == ["ramp-full", "ramp-half"]
    with pytest.raises(ValueError, match=r"method: found 'ramp', allowed: displacement \| splatting \| shadows"):
        methods.named("ramp")
    with pytest.raises(ValueError, match="case: found 'ramp-full'"):
        oracle.build("ramp-full")


def test_export_and_check_of_a_further_method(toy: None, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    case, port = tmp_path / "case", tmp_path / "port"
    assert call("export", "ramp-full", case) == 0
    text = (case / "README.md").read_text("utf-8")
    assert "The level of pixel (column, row)" in text
    assert "| shade.level | (16, 24) float64 | the level | - | - |" in text
    assert "The dark" not in text
    assert json.loads((case / "case.json").read_text("utf-8"))["params"] == {"gain": 1.0}

    loaded = oracle.load_case(case)
    assert np.array_equal(loaded.frame.color, oracle.build("ramp-full").frame.color)
    port.mkdir()
    for name in ("color", "depth", "shade.level"):
        np.save(port / f"{name}.npy", np.load(case / "expected" / f"{name}.npy"))
    assert call("check", case, port) == 0
    assert "PASS: ramp-full" in capfd.readouterr().out

    level = np.load(port / "shade.level.npy")
    level[3, 5] += 1e-3
    np.save(port / "shade.level.npy", level)
    assert call("check", case, port) == 1
    out = capfd.readouterr().out
    assert "FAIL: ramp-full, first wrong in stage shade" in out
    assert "pixel [3, 5]" in out


def test_a_gain_that_is_off_is_told_by_its_name(toy: None) -> None:
    case = oracle.build("ramp-half")
    color = np.floor(255.0 * case.frame.color * 0.9 + 0.5).astype(np.uint8)
    verdict = oracle.check(case, oracle.submission_from_arrays(case, color=color)).verdict
    assert verdict.outcome is oracle.Outcome.FAIL
    assert [bias.parameter for bias in verdict.biases] == ["gain"]


def test_the_oracle_is_tried_on_a_further_method(toy: None) -> None:
    assert self_test.tried()[-1] == "ramp"
    assert [(result.name, result.accused) for result in self_test.try_variants("ramp")] == [("float32", ())]
    (killed,) = self_test.try_mutants("ramp", kinds=("easy",))
    assert (killed.case, killed.stage, killed.stage_right) == ("ramp-full", "shade", True)


def test_a_case_of_what_no_referee_judges_is_refused(toy: None) -> None:
    from dataclasses import replace

    case = oracle.build("ramp-full")
    with pytest.raises(ValueError, match="kind: found 'stepped', allowed: linear"):
        replace(case, params=replace(case.params, kind="stepped"))


def test_the_page_and_the_demo_of_a_further_method(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Alone in the registry: the others' pictures take minutes."""
    monkeypatch.setattr(methods, "_METHODS", {"ramp": RECORD})
    assert call("method", "ramp") == 0
    assert "# The ramp" in capfd.readouterr().out
    assert call("demo", "--out", tmp_path / "demo") == 0
    assert "A ramp (Nobody 2000), 24 x 16" in capfd.readouterr().out
    assert sorted(path.name for path in (tmp_path / "demo").iterdir()) == ["contact_sheet.png", "ramp.png"]
    assert len(np.unique(imageio.imread(tmp_path / "demo" / "ramp.png").reshape(-1, 3), axis=0)) > 20
