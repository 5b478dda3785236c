"""`ibr-ref sweep`."""

from __future__ import annotations

from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pyarrow.parquet as parquet
import pytest
import typer

from ibr_ref.cli.sweeps import values
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line

HERE = ("--size", "24x18", "--workers", "0")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("steps=5:20:5", ("steps", (5, 10, 15, 20))),
        ("steps=5:19:5", ("steps", (5, 10, 15))),
        ("delta=0.02:0.1:0.02", ("delta", (0.02, 0.04, 0.06, 0.08, 0.1))),
        ("delta=0.02,1,-3e-2", ("delta", (0.02, 1, -0.03))),
        ("map-size=64", ("map_size", (64,))),
        ("method=protruded,relief", ("method", ("protruded", "relief"))),
    ],
)
def test_values(text: str, expected: tuple[str, tuple[object, ...]]) -> None:
    found = values.over(text)
    assert (found.name, found.values) == expected
    assert [type(value) for value in found.values] == [type(value) for value in expected[1]]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "steps",
        "steps=",
        "=5",
        "steps=5:20",
        "steps=5:20:0",
        "steps=20:5:5",
        "steps=1:1e9:1",
        "a=1,,2",
        "a=٣",
        "a=1_0",
    ],
)
def test_what_is_no_value(text: str) -> None:
    with pytest.raises(typer.BadParameter, match="allowed: NAME=A,B"):
        values.over(text)


def test_displacement(run: Run, tmp_path: Path) -> None:
    rows, columns = np.mgrid[0:16, 0:16]
    imageio.imwrite(tmp_path / "h.png", np.where((abs(rows - 8) < 4) & (abs(columns - 8) < 4), 200, 0).astype(np.uint8))
    table, plot = tmp_path / "sweep.parquet", tmp_path / "plot.png"
    call = (
        "sweep",
        "displacement",
        "--height",
        tmp_path / "h.png",
        *HERE,
        "--views",
        2,
        "--out",
        table,
        "--plot",
        plot,
    )
    code, out, err = run(*call, "--over", "steps=4:16:4", "--over", "delta=0.1", "--bound", "wrong=0.5")
    assert (code, err) == (0, "")
    assert "8 rows" in out
    assert "wrong <= 0.5 in every view: linear_steps=4, steep_threshold=0.1 (wrong 0." in out
    assert len(parquet.read_table(table)) == 8
    assert imageio.imread(plot).shape[2] >= 3
    code, out, err = run(*call, "--over", "steps=4:20:4", "--over", "delta=0.1", "--bound", "silhouette=1.1")
    assert (code, err) == (0, "")
    assert "no setting has silhouette >= 1.1 in every view; the best one reaches " in out
    assert len(parquet.read_table(table)) == 10


def test_splatting_and_shadows(run: Run, cube: Path) -> None:
    code, out, err = run("sweep", "splatting", "--mesh", cube, "--reference-size", 32, *HERE, "--over", "alpha=1,2")
    assert (code, err) == (0, "")
    assert "overdraw" in out
    small = ("--over", "map_size=32", "--over", "controls=bounds", "--over", "rows=5", "--over", "samples=1,5")
    code, out, err = run("sweep", "shadows", "--caster", cube, *HERE, *small, "--cost", "milliseconds")
    assert (code, err) == (0, "")
    assert "soft, worst view, against milliseconds" in " ".join(out.split())


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--over", "steps=5", "--bound", "nope=1"), ("--bound: found nope", "wrong | silhouette")),
        (("--over", "steps=5", "--bound", "wrong"), ("'wrong'", "MEASURE=NUMBER")),
        (("--over", "steps=5", "--cost", "nope"), ("--cost: found nope",)),
        (("--over", "steps=5", "--over", "steps=6"), ("--over: found steps 2 times",)),
        (("--over", "steps=5", "--scheduler", "x"), ("--workers: found 0 beside --scheduler x",)),
        (("--over", "steps=5", "--color", "c.png"), ("--color", "the built-in box has its own maps")),
        (("--over", "nope=5"), ("over: found 'nope'", "linear_steps")),
        ((), ("--over",)),
    ],
    ids=lambda value: " ".join(value),
)
def test_a_bad_option(run: Run, more: tuple[str, ...], words: tuple[str, ...]) -> None:
    assert_one_line(run("sweep", "displacement", *HERE, *more), *words)
