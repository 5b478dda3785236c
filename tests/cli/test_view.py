"""`ibr-ref view`: what it takes, and what it hands to the page."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from ibr_ref import oracle
from ibr_ref.cli import view
from ibr_ref.viewer import Subject
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line


@pytest.fixture
def seen(monkeypatch: pytest.MonkeyPatch) -> list[Subject]:
    """The subjects of pages that would have been served."""
    found: list[Subject] = []
    monkeypatch.setattr(view, "serve", lambda subject, port, no_browser: found.append(subject))
    return found


def test_what_render_would_draw(run: Run, tmp_path: Path, seen: list[Subject]) -> None:
    imageio.imwrite(tmp_path / "h.png", np.full((4, 4), 128, np.uint8))
    options = ("--height", tmp_path / "h.png", "--steps", "7", "--size", "32x24")
    assert run("view", "displacement", *options)[0] == 0
    assert (seen[0].params.linear_steps, seen[0].scene.camera.width) == (7, 32)
    assert run("view", "shadows", "--method", "direct", "--size", "32x24", "--map-size", "64")[0] == 0
    assert seen[1].params.method == "direct"


def test_a_case_and_a_drawing(run: Run, tmp_path: Path, seen: list[Subject]) -> None:
    case = oracle.build("displacement-box")
    oracle.export(case, tmp_path / "case")
    (tmp_path / "drawn").mkdir()
    np.save(tmp_path / "drawn" / "color.npy", case.frame.color)
    assert run("view", "case", tmp_path / "case", tmp_path / "drawn")[0] == 0
    assert np.array_equal(seen[0].drawing["color"], case.frame.color)
    assert seen[0].title == "displacement-box"
    assert run("view", "case", "displacement-box")[0] == 0
    assert not seen[1].drawing


def test_what_cannot_be_shown(run: Run, tmp_path: Path, seen: list[Subject]) -> None:
    assert_one_line(run("view", "case", "displacement-*"), "case: found 'displacement-*', allowed: one case")
    assert_one_line(run("view", "case", "displacement-box", tmp_path / "none"), "none")
    assert_one_line(run("view", "displacement"), "--height")
    assert not seen


def test_it_serves_until_somebody_ends_it() -> None:
    command = [sys.executable, "-m", "ibr_ref", "view", "case", "displacement-box", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("http://127.0.0.1:")
        os.kill(process.pid, signal.SIGINT)
        assert process.wait(timeout=10) == 130
        assert process.communicate()[1] == ""
