"""`ibr-ref draw` and `ibr-ref conformance`, with the port that needs no driver."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.faults import splatting as programs
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line

CASE = "splatting-ball"


@pytest.fixture(autouse=True)
def quiet(one_thread: None) -> None:
    """As all command lines here."""


def test_what_is_drawn_is_judged(run: Run, tmp_path: Path) -> None:
    code, said, _ = run("draw", CASE, tmp_path / "ball", "--with", "plain")
    assert (code, said.startswith("1 of 1 drawn in plain on NumPy ")) == (0, True)
    assert json.loads((tmp_path / "ball" / "port.json").read_text()) == {"profile": "ieee32"}
    code, said, _ = run("check", CASE, tmp_path / "ball")
    assert (code, said.startswith(f"PASS: {CASE}")) == (0, True)


def test_a_case_s_folder_alone(run: Run, tmp_path: Path) -> None:
    assert run("export", CASE, tmp_path / "cases" / "ball")[0] == 0
    assert run("draw", tmp_path / "cases", tmp_path / "drawn", "--with", "plain")[0] == 0
    assert np.load(tmp_path / "drawn" / "ball" / "color.npy").shape == (72, 96, 3)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("draw", "no-such", "out", "--with", "plain"), "case: found 'no-such'"),
        (("draw", CASE, "out", "--with", "metal"), "--with"),
        (("draw", CASE, "out", "--with", "plain", "--adapter", "x"), "adapter: found 'x', allowed: none with plain"),
        (("conformance", CASE, "--with", "webgl", "--adapter", "false"), "no WebGL 2: false ended with exit code 1"),
    ],
)
def test_what_is_wrong_is_one_line(arguments: tuple[str, ...], said: str, run: Run, tmp_path: Path) -> None:
    found = run(*(tmp_path / "out" if each == "out" else each for each in arguments))
    assert_one_line(found, said)
    assert not (tmp_path / "out").exists()


def test_a_conformance_run(run: Run, tmp_path: Path) -> None:
    """A line a case, a page, numbers, and the exit code of the worst."""
    code, said, _ = run("conformance", "splatting-[bl]*", "--with", "plain", "--out", tmp_path / "out")
    lines = said.splitlines()
    assert code == 0
    assert lines[0].startswith("plain on NumPy ")
    assert lines[1].startswith("measured: subpixel_bits 8, varyings snapped, ")
    assert lines[2].startswith(f"PASS          {CASE}  on ieee32,subpixel_bits=8,")
    assert lines[3].startswith("PASS          splatting-lamp  on ieee32,subpixel_bits=8,")
    assert lines[4:] == ["2 cases: 2 PASS."]
    document = json.loads((tmp_path / "out" / "conformance.json").read_text())
    assert document["declares"] == {"profile": "ieee32"}
    assert [(row["case"], row["outcome"]) for row in document["cases"]] == [(CASE, "PASS"), ("splatting-lamp", "PASS")]
    page = (tmp_path / "out" / "index.html").read_text()
    assert "2 cases: 2 PASS" in page
    assert page.count('<tr class="pass">') == 2
    assert "8, measured (" in page
    judged_by = lines[2].partition(" on ")[2].partition(", ")[0]
    assert page.count(f">{judged_by}") == 1, "the device of all cases is said once"
    assert "None of those that are known." in page
    assert (document["measured"]["varyings"], document["faults"], document["unmeasured"]) == ("snapped", {}, {})
    numbers = tmp_path / "out" / "conformance.json"
    code, said, _ = run("conformance", "--compare", numbers, numbers, "--out", tmp_path / "both")
    assert (code, said) == (0, "2 cases: 0 with another verdict.\n")
    assert "0 of 2 cases have another verdict" in (tmp_path / "both" / "compared.html").read_text()
    assert_one_line(run("conformance", "--compare", numbers, tmp_path / "out" / "index.html"), "found no run")


def test_what_the_port_has_no_code_for_is_left_out(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """And what it fails at is not."""
    said = {"splatting-lamp": "shape = 'hexagon': the port allows square, disc"}
    right = programs.Port.render

    def render(self: Any) -> Any:
        if len(self.scene.images) == 2 and said["splatting-lamp"]:
            raise ValueError(said["splatting-lamp"])
        return right(self)

    monkeypatch.setattr(programs.Port, "render", render)
    code, out, _ = run("conformance", "splatting-[bl]*", "--with", "plain")
    assert (code, out.splitlines()[-1]) == (0, "1 case: 1 PASS.")
    assert f"left out: splatting-lamp is not ported: {said['splatting-lamp']}" in out
    assert_one_line(run("conformance", "splatting-lamp", "--with", "plain"), "the port allows square, disc")
    said["splatting-lamp"] = "the shader does not compile"
    code, out, _ = run("conformance", "splatting-[bl]*", "--with", "plain")
    assert (code, "does not compile" in out) == (2, True)


def test_a_case_that_fails_has_a_report(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from ibr_ref.ports import drawing

    plain = drawing._plainly

    def brighter(folder: Path) -> drawing.Frame:
        frame = plain(folder)
        return drawing.Frame(np.clip(frame.color + 0.1, 0.0, 1.0), frame.depth, frame.stages)

    monkeypatch.setattr(drawing, "_plainly", brighter)
    code, said, _ = run("conformance", CASE, "--with", "plain", "--out", tmp_path / "out")
    assert code == 1
    assert said.splitlines()[2].startswith(f"FAIL          {CASE}  ")
    assert f'<a href="{CASE}.html">' in (tmp_path / "out" / "index.html").read_text()
    assert (tmp_path / "out" / f"{CASE}.html").is_file()


def test_a_device_is_measured_and_taken(run: Run, tmp_path: Path) -> None:
    """From the probe's export to `check --device`."""
    assert run("export", "probe", tmp_path / "probes")[0] == 0
    assert run("draw", tmp_path / "probes", tmp_path / "drawn", "--with", "plain")[0] == 0
    code, said, _ = run("probe", tmp_path / "probes", tmp_path / "drawn", "--out", tmp_path / "device.json")
    assert code == 0
    assert said.splitlines()[0].startswith("operation_ulps: 0.5, measured (")
    assert "\nsubpixel_bits: 8, measured (" in said
    assert said.splitlines()[-1] == "clip_z, clip_border, setup, unorm_rounding: assumed, as ieee32 grants them"
    document = json.loads((tmp_path / "device.json").read_text())
    assert document == {
        "profile": "ieee32",
        "subpixel_bits": 8,
        "varyings": "snapped",
        "texel_weight_bits": 0,
        "filter_result": "float",
        "depth_format": "float32",
        "operation_ulps": 0.5,
        "quotient_ulps": 0.5,
        "root_ulps": 0.5,
        "power_ulps": 0.5,
    }
    assert run("draw", CASE, tmp_path / "ball", "--with", "plain")[0] == 0
    assert run("check", CASE, tmp_path / "ball", "--device", tmp_path / "device.json")[0] == 0
    assert_one_line(run("probe", tmp_path / "ball", tmp_path / "ball"), "allowed: a folder with cases")
