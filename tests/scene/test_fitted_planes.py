"""Planes around points: nothing that can be in the picture is cut, whatever the view."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ibr_ref.scene import Camera

coordinates = st.tuples(*[st.floats(-9.0, 9.0).map(lambda x: round(x, 3))] * 3)


def depths(camera: Camera, points: np.ndarray) -> np.ndarray:
    homogeneous = np.concatenate([points, np.ones((len(points), 1))], axis=1)
    return -(homogeneous @ camera.view_from_world.T)[:, 2]


@given(coordinates, coordinates, st.floats(1.0, 170.0), st.lists(coordinates, min_size=1, max_size=9), st.booleans())
def test_what_is_in_the_picture_is_between(eye, target, fov, points, orthographic):  # type: ignore[no-untyped-def]
    if np.allclose(eye[:2], target[:2]):
        return
    if orthographic:
        view = Camera.orthographic(eye=eye, target=target, view_height=fov / 10, width=40, height=30)
    else:
        view = Camera.look_at(eye=eye, target=target, vertical_fov=fov, width=40, height=30)
    camera, points = view.fitted(points), np.array(points)
    assert camera.near < camera.far
    clip = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ camera.view_from_world.T
    clip = clip @ camera.clip_from_view.T
    seen = (np.abs(clip[:, :2]) <= clip[:, 3:]).all(axis=1) & (clip[:, 3] > 1e-5 * camera.far)
    assert ((clip[seen, 2] >= 0.0) & (clip[seen, 2] <= clip[seen, 3])).all()
    assert np.array_equal(camera.clip_from_view[[0, 1, 3]], view.clip_from_view[[0, 1, 3]])


def test_tight_where_the_eye_is_outside() -> None:
    camera = Camera.look_at(eye=(0, -10, 0), target=(0, 0, 0)).fitted([(0, -1, 0), (0, 2, 0)])
    assert camera.near == pytest.approx(8.91)
    assert camera.far == pytest.approx(12.12)


def test_given_planes_stay() -> None:
    view, points = Camera.look_at(eye=(0, -10, 0), target=(0, 0, 0)), [(0, -1, 0), (0, 2, 0)]
    assert view.fitted(points, near=0.5).near == 0.5
    assert view.fitted(points, far=50).far == 50.0
    behind = view.fitted(points, near=20)
    assert behind.near == 20.0 < behind.far
    before = view.fitted(points, far=2)
    assert before.near < before.far == 2.0


@pytest.mark.parametrize(
    ("planes", "word"), [({"near": 0.0}, "near"), ({"far": -1.0}, "far"), ({"near": 3, "far": 2}, "far")]
)
def test_planes_out_of_order(planes: dict[str, float], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        Camera.look_at(eye=(0, -10, 0), target=(0, 0, 0)).fitted([(0, 0, 0)], **planes)


@pytest.mark.parametrize("points", [[], [1.0, 2.0, 3.0], [(0, 0, np.nan)], "points"])
def test_points_that_are_none(points: object) -> None:
    with pytest.raises(ValueError, match="points"):
        Camera.look_at(eye=(0, -10, 0), target=(0, 0, 0)).fitted(points)
