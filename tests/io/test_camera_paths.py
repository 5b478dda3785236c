"""Camera paths."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref import Camera, io

SQUARE = [{"eye": [x, y, 1], "target": [0, 0, 0]} for x, y in ((3, 0), (0, 3), (-3, 0), (0, -3))]


def read(tmp_path: Path, document: Any, frames: int = 7) -> list[Camera]:
    file = tmp_path / "path.json"
    file.write_text(document if isinstance(document, str) else json.dumps(document))
    return io.read_camera_path(file, 64, 48, frames)


def eyes(cameras: list[Camera]) -> np.ndarray:
    return np.array([camera.eye[:3] for camera in cameras])


def test_an_open_path_goes_from_the_first_to_the_last(tmp_path: Path) -> None:
    """In even steps, along the chords."""
    found = eyes(read(tmp_path, {"cameras": SQUARE}))
    corners = np.array([camera["eye"] for camera in SQUARE], float)
    assert np.allclose(found[::2], corners, atol=1e-12)
    assert np.allclose(found[1::2], (corners[1:] + corners[:-1]) / 2, atol=1e-12)


def test_a_closed_path_comes_back_and_has_no_frame_twice(tmp_path: Path) -> None:
    found = eyes(read(tmp_path, {"cameras": SQUARE, "closed": True}, frames=8))
    corners = np.array([camera["eye"] for camera in SQUARE], float)
    assert np.allclose(found[::2], corners, atol=1e-12)
    assert np.allclose(found[7], (corners[3] + corners[0]) / 2, atol=1e-12)


def test_cameras_are_those_of_look_at(tmp_path: Path) -> None:
    key = {"eye": [1, 2, 3], "target": [0, 0, 1], "up": [0, 1, 0], "vertical_fov": 30}
    first, *_ = read(tmp_path, {"cameras": [key, SQUARE[0]]})
    expected = Camera.look_at(**key, width=64, height=48)
    assert np.array_equal(first.view_from_world, expected.view_from_world)
    assert np.array_equal(first.clip_from_view, expected.clip_from_view)


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ("", "path.json"),
        ("{", "found no JSON"),
        ("[]", "found list, allowed: cameras, closed"),
        ({"cameras": SQUARE, "loop": True}, "found cameras, loop, allowed: cameras, closed"),
        ({"cameras": SQUARE, "closed": 1}, "closed: found 1, allowed: true | false"),
        ({"cameras": SQUARE[:1]}, "cameras: found 1, allowed: a list of 2"),
        ({"cameras": 3}, "cameras: found 3"),
        ({}, "cameras: found None"),
        ({"cameras": [SQUARE[0], {"eye": [1, 2, 3]}]}, "cameras[1]: found eye, allowed: eye, target"),
        ({"cameras": [SQUARE[0], {**SQUARE[0], "fov": 3}]}, "cameras[1]: found eye, target, fov"),
        ({"cameras": [SQUARE[0], {"eye": [1, 2], "target": [0, 0, 0]}]}, "cameras[1]: eye: found [1, 2]"),
        ({"cameras": [SQUARE[0], {"eye": "a", "target": [0, 0, 0]}]}, "cameras[1]: eye: found 'a'"),
        ({"cameras": [SQUARE[0], {"eye": [0, 0, 0], "target": [0, 0, 0]}]}, "cameras[1]: "),
        ({"cameras": [SQUARE[0], {**SQUARE[0], "vertical_fov": 190}]}, "cameras[1]: vertical_fov: found 190"),
    ],
    ids=str,
)
def test_bad_paths(tmp_path: Path, document: Any, words: str) -> None:
    with pytest.raises(ValueError, match=r"path\.json") as error:
        read(tmp_path, document)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_frames_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"^frames: found 1, allowed: a whole number from 2"):
        read(tmp_path, {"cameras": SQUARE}, frames=1)
