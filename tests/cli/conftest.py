"""What the tests of the command line share."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ibr_ref import cli

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Run:
    """Call `ibr-ref` with arguments: exit code, standard output, standard error."""

    def call(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["ibr-ref", *map(str, arguments)])
        with pytest.raises(SystemExit) as exit_:
            cli.main()
        out, err = capfd.readouterr()
        code = exit_.value.code
        return (0 if code is None else int(code)), out, err

    return call


@pytest.fixture
def cube(tmp_path: Path) -> Path:
    """An OBJ file of a cube."""
    path = tmp_path / "cube.obj"
    corners = [f"v {x} {y} {z}" for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    faces = ["f 1 3 4 2", "f 5 6 8 7", "f 1 2 6 5", "f 3 7 8 4", "f 1 5 7 3", "f 2 4 8 6"]
    path.write_text("\n".join(corners + faces) + "\n")
    return path
