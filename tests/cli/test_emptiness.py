"""Planes around the scene, and the line that says why a picture is empty."""

from __future__ import annotations

from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from tests.cli.conftest import Run


@pytest.fixture
def height(tmp_path: Path) -> Path:
    rows, columns = np.mgrid[0:16, 0:24]
    raised = np.where((abs(rows - 8) < 3) & (abs(columns - 12) < 4), 60000, 0).astype(np.uint16)
    imageio.imwrite(tmp_path / "height.png", raised)
    return tmp_path / "height.png"


def colors(path: Path) -> int:
    return len(np.unique(imageio.imread(path).reshape(-1, 3), axis=0))


@pytest.mark.parametrize(
    "view",
    [
        ("--eye", "0,-125,95", "--fov", "0.5"),
        ("--eye", "0,-125000,95000", "--fov", "0.0005"),
        ("--eye", "0,-0.3,0.1601"),
        ("--eye=-0.4,0.2,0.02", "--target", "0,0,0.02"),
        ("--eye", "0,-125,95", "--fov", "0.5", "--faces", "extended"),
        ("--eye", "0,-125,95", "--fov", "0.5", "--method", "relief"),
    ],
    ids=" ".join,
)
def test_the_shape_is_seen_from_far_and_near(run: Run, height: Path, tmp_path: Path, view: tuple[str, ...]) -> None:
    out = tmp_path / "out.png"
    assert run("render", "displacement", "--height", height, "--size", "64x48", *view, "--out", out) == (0, "", "")
    assert colors(out) > 10


def test_the_planes_cut_nothing_and_change_nothing_else(run: Run, height: Path, tmp_path: Path) -> None:
    pictures = []
    for planes in ((), ("--near", "0.01", "--far", "100")):
        out = tmp_path / f"{len(planes)}.png"
        run("render", "displacement", "--height", height, "--size", "64x48", *planes, "--out", out)
        pictures.append(imageio.imread(out))
    assert np.array_equal(*pictures)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--far", "1"), "of 5 faces: 2 turned away from the eye, 3 beyond the far plane"),
        (("--near", "10"), "of 5 faces: 2 turned away from the eye, 3 in front of the near plane or behind the eye"),
        (("--target=0.6,-9,0.95",), "3 in front of the near plane or behind the eye"),
        (("--target=0.6,0.9,0.95",), "3 outside the picture"),
        (("--faces", "base", "--eye=0,-1,-1"), "of 1 face: 1 turned away from the eye"),
        (("--eye=0,-1e9,1e8",), "1 turned away from the eye, 4 too small to cover a pixel's centre"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else None,
)
def test_why_no_face_is_drawn(run: Run, height: Path, tmp_path: Path, more: tuple[str, ...], words: str) -> None:
    out = tmp_path / "out.png"
    code, said, err = run("render", "displacement", "--height", height, "--size", "63x47", *more, "--out", out)
    assert (code, said, err.count("\n")) == (0, "", 1)
    assert err.startswith("ibr-ref: nothing is drawn: of ")
    assert words in err
    assert colors(out) == 1


@pytest.mark.parametrize(
    ("more", "word"),
    [
        (("--far", "0.5"), "beyond the far plane"),
        (("--near", "50"), "in front of the near plane or behind the eye"),
        (("--eye=9,9,9", "--target=20,20,20"), "in front of the near plane or behind the eye"),
        (("--eye=9,9,9", "--target=9,-9,9"), "outside the picture"),
        (
            ("--eye=900,900,900", "--law", "1,0,0,1000", "--min-width", "0", "--size", "64x48"),
            "too small to cover a pixel's centre",
        ),
        (("--far", "0.5", "--shape", "ellipse"), "beyond the far plane"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else None,
)
def test_why_no_splat_is_drawn(run: Run, cube: Path, tmp_path: Path, more: tuple[str, ...], word: str) -> None:
    call = ("render", "splatting", "--mesh", cube, "--count", 4, "--reference-size", 32, "--size", "63x47")
    code, _, err = run(*call, *more, "--out", tmp_path / "out.png")
    assert (code, err.count("\n")) == (0, 1), err
    assert err.startswith("ibr-ref: nothing is drawn: of ")
    assert word in err
    assert " points: " in err


def of_caster(cube: Path, out: Path, *more: object) -> tuple[object, ...]:
    small = ("--map-size", 64, "--method", "direct", "--size", "63x47")
    return ("render", "shadows", "--caster", cube, *small, "--out", out, *more)


def test_the_stage_is_seen_from_far(run: Run, cube: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.png"
    assert run(*of_caster(cube, out, "--eye", "14,-30,21")) == (0, "", "")
    assert colors(out) > 10


def test_why_no_triangle_is_drawn(run: Run, cube: Path, tmp_path: Path) -> None:
    for more, word in (
        (("--eye", "14,-30,21", "--far", "30"), "beyond the far plane"),
        (("--target=14,-30,21",), "in front of the near plane or behind the eye"),
    ):
        code, _, err = run(*of_caster(cube, tmp_path / "out.png", *more))
        assert (code, err.count("\n")) == (0, 1)
        assert "nothing is drawn: of 48 triangles: " in err
        assert word in err


def test_a_caster_that_the_lights_frustum_cuts(run: Run, cube: Path, tmp_path: Path) -> None:
    code, _, err = run(*of_caster(cube, tmp_path / "out.png", "--samples", 9, "--light-size", 3))
    assert (code, err.count("\n")) == (0, 1)
    assert "the light's frustum does not hold the caster" in err
    assert "of 12 triangles" in err
