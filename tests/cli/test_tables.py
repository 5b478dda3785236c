"""Tables lose nothing: in a pipe as wide as they need, on a terminal folded, or as a list."""

from __future__ import annotations

import json
import os
import pty
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Run

PROGRAM = """
from ibr_ref.cli.tables import show
from rich.table import Table
table = Table(title="Milliseconds of a frame, best (median), on this machine", caption="two threads; paper: a card of 2004")
for column in ("scene", "picture", "picture and depth", "all stages", "memory, MB"):
    table.add_column(column, justify="right")
table.add_row("city 4 x 4", "1000 x 1000", "12345.6 (23456.7)", "345.6 (456.7)", "1024.00")
table.add_row("anameofsixtyletters" + "x" * 41, "640 x 480", "1.6 (1.7)", "3.6 (4.7)", "")
show(table)
"""
FIGURES = ["city 4 x 4", "1000 x 1000", "12345.6 (23456.7)", "345.6 (456.7)", "1024.00", "3.6 (4.7)"]


def on_terminal(columns: int) -> str:
    """What a terminal of that width shows, without colours."""
    main, other = pty.openpty()
    environment = {**os.environ, "COLUMNS": str(columns), "TERM": "xterm"}
    with subprocess.Popen([sys.executable, "-c", PROGRAM], stdout=other, stderr=other, env=environment) as process:
        os.close(other)
        parts = []
        try:
            while part := os.read(main, 1 << 16):
                parts.append(part)
        except OSError:  # the far end has been closed
            pass
        assert process.wait() == 0
    os.close(main)
    return re.sub(r"\x1b\[[0-9;]*m|\r", "", b"".join(parts).decode())


def test_a_pipe(tmp_path: Path) -> None:
    """Whatever the width that the shell had."""
    for columns in ("20", "80"):
        environment = {**os.environ, "COLUMNS": columns}
        out = subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, check=True
        ).stdout.decode()
        assert "…" not in out
        lines = [line for line in out.splitlines() if "1000 x 1000" in line]
        assert len(lines) == 1
        assert all(figure in lines[0] for figure in FIGURES[:5])
        assert "anameofsixtyletters" + "x" * 41 in out


@pytest.mark.parametrize("columns", [200, 140, 80, 60, 40, 25])
def test_a_terminal(columns: int) -> None:
    out = on_terminal(columns)
    assert "…" not in out
    assert max(map(len, out.splitlines())) <= columns
    folded = "".join(out.split())
    for text in ("Milliseconds", "twothreads;", "picture and depth", "anameofsixtyletters" + "x" * 41):
        assert "".join(text.split()) in folded or columns > 60, text
    for figure in FIGURES:
        assert figure.replace(" ", "") in folded or columns > 60, figure
        assert all(word in out for word in figure.split()), "no number is broken"


def test_a_bench_in_a_pipe(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    keys = {f"{what}_{which}_ms": 123456.7 for what in ("picture", "stages") for which in ("best", "median")}
    row = {"scene": "a name of some length", "width": 1000, "height": 1000, "linear_steps": 50, "paper_ms": 1234.5}
    row |= {"gathers": 1_000_000, "gathers_per_second": 1e9, "gathers_ms": 1.0, "beside_gathers": 1.25}
    monkeypatch.setattr("ibr_ref.bench.displacement.times", lambda repeat: [{**row, **keys}])
    monkeypatch.setenv("COLUMNS", "40")
    code, out, _ = run("bench", "displacement")
    assert code == 0
    assert "…" not in out
    times = "123456.7 (123456.7) │ 1.0 M, 1.0 │ 1.25x │ 123456.7 (123456.7) │ 1234.5"
    line = next(line for line in out.splitlines() if "a name" in line)
    assert f"a name of some length │ 1000 x 1000 │ 50 │ {times}" in " ".join(line.split())


def test_the_self_test_in_a_pipe(run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from ibr_ref.oracle.self_test import VariantResult
    from ibr_ref.oracle.sight import Sight

    name = "a variant whose name says in very many words what is legal about it, and then some more of them, to the end"
    result = VariantResult(
        method="displacement", name=name, profile="vulkan", cases=43, pixels=10**9, accused=("one: march", "two: shade")
    )
    shares = {"color_of_picture": 0.0125, "color_beside_depth": 0.01, "color_beside_stages": 0.0}
    shares |= {"depth_beside_color": 0.02, "depth_beside_stages": 0.0}
    seen = Sight(method="displacement", case="displacement-one", profile="gl", hits=50, **shares)
    monkeypatch.setattr("ibr_ref.oracle.self_test.try_variants", lambda method: [result])
    monkeypatch.setattr("ibr_ref.oracle.self_test.try_mutants", lambda method, kinds: [])
    monkeypatch.setattr("ibr_ref.oracle.sight.sights", lambda method, kinds: [seen])
    code, out, _ = run("check", "--self-test", "--method", "displacement", "--json", str(tmp_path / "tables.json"))
    assert code == 1
    assert "displacement-one │ gl      │ 50   │ 1.25" in out
    tables = json.loads((tmp_path / "tables.json").read_text("utf-8"))
    assert tables["right"][0]["accused"] == ["one: march", "two: shade"]
    assert tables["sight"][0]["depth_beside_stages"] == 0.0
    assert f"{name} │ vulkan  │ 43    │ 1,000,000,000 │" in out
    assert "accused: one: march, two: shade" in out


def test_help_is_not_cut(run: Run) -> None:
    for command in (("render", "displacement"), ("render", "splatting"), ("render", "shadows"), ("check",), ("bench",)):
        assert "…" not in run(*command, "--help")[1]
