"""Conventions wrong on purpose: each moves the points in the way that it must, and what is left open is asked for."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from ibr_ref import io
from tests.io.depth_sets import shots, writers
from tests.io.depth_sets.test_formats import OWN, npy

FLIP = writers.FLIP[:3, :3]


def in_camera(shot):
    """(N, 3) of the valid pixels, OpenCV's axes."""
    return (shot.points[shot.valid] - shot.center) @ shot.rotation


def read(folder, **options):
    return io.read_depth_set(folder, **{**OWN, **options})


@pytest.fixture
def folder(tmp_path):
    return writers.own(tmp_path, shots.shots(), npy, "npy")


def compare(set_, expected, atol=1e-12):
    for image, shot in zip(set_, shots.shots(), strict=True):
        assert np.allclose(image.points, expected(shot), rtol=0, atol=atol)


def test_other_axes_turn_the_points_about_the_x_axis_of_their_camera(folder):
    """They land behind the camera and upside down: half a turn about +x."""
    compare(read(folder, convention="opengl"), lambda shot: in_camera(shot) @ FLIP @ shot.rotation.T + shot.center)


def test_the_inverse_of_a_pose(folder):
    """p_camera is taken for R p + C."""
    compare(read(folder, poses="world_to_camera"), lambda shot: (in_camera(shot) - shot.center) @ shot.rotation)


def test_depths_along_the_ray_that_are_not(folder):
    """The plane is bent towards the eye: every point's distance is what its depth was."""
    for image, shot in zip(read(folder, along="ray"), shots.shots(), strict=True):
        assert np.allclose(np.linalg.norm(image.points - shot.center, axis=1), shot.depth[shot.valid], rtol=1e-12)
        assert shots.on_surface(image.points).max() > 0.1


def test_half_a_pixel(folder):
    for image, shot in zip(read(folder, pixel_centers="half"), shots.shots(), strict=True):
        moved = (image.points - shot.points[shot.valid]) @ shot.rotation / shot.depth[shot.valid][:, None]
        assert np.allclose(moved, [0.5 / shots.K[0, 0], 0.5 / shots.K[1, 1], 0], rtol=0, atol=1e-12)


def test_another_scale(folder):
    compare(read(folder, depth_scale=2.0), lambda shot: 2 * shot.points[shot.valid] - shot.center)


@pytest.mark.parametrize(
    ("axes", "direction", "along"), [*itertools.product(("opencv", "opengl"), ("to", "from"), ("axis", "ray"))]
)
def test_all_of_them_said_rightly(tmp_path, axes, direction, along):
    seen = shots.shots()
    turned = [shot.pose @ (np.eye(4) if axes == "opencv" else writers.FLIP) for shot in seen]
    matrices = turned if direction == "to" else [np.linalg.inv(matrix) for matrix in turned]

    def map_(path, shot):
        distance = np.linalg.norm(shot.points - shot.center, axis=2)
        np.save(path, np.where(shot.valid, shot.depth if along == "axis" else distance, 0))

    writers.own(tmp_path, seen, map_, "npy", matrices=matrices, centers="half")
    poses = "camera_to_world" if direction == "to" else "world_to_camera"
    set_ = io.read_depth_set(tmp_path, convention=axes, poses=poses, along=along, pixel_centers="half")
    compare(set_, lambda shot: shot.points[shot.valid])


@pytest.mark.parametrize("missing", OWN)
def test_what_the_format_leaves_open_is_asked_for(folder, missing):
    with pytest.raises(
        ValueError, match=rf"^{missing}: found None, .* folder leaves open, allowed: {missing} \w+ \| \w+$"
    ):
        read(folder, **{missing: None})


def test_whole_numbers_without_a_scale(tmp_path):
    writers.own(tmp_path, shots.shots(1), lambda path, shot: np.save(path, writers.codes(shot, 0.001)), "npy")
    with pytest.raises(ValueError, match=r"0\.npy: depth_scale: found None .*0\.001: millimetres"):
        read(tmp_path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"convention": "opencl"}, "convention: found 'opencl', allowed: opencv | opengl"),
        ({"poses": 1}, "poses: found 1, allowed: camera_to_world | world_to_camera"),
        ({"depth_scale": 0}, "depth_scale: found 0, allowed: a finite number > 0"),
        ({"depth_scale": float("nan")}, "depth_scale: found nan"),
        ({"intrinsics": (1, 2, 3)}, "intrinsics: found (1, 2, 3), allowed: 4 finite numbers"),
        ({"intrinsics": (0, 2, 3, 4)}, "focal lengths other than 0"),
        ({"max_time_gap": 1}, "max_time_gap: found 1.0, allowed: None with the format folder"),
        ({"format": "tumm"}, "format: found 'tumm', allowed: open3d | tum | scannet"),
    ],
)
def test_options_that_are_none(folder, options, words):
    with pytest.raises(ValueError, match=r"allowed") as error:
        read(folder, **options)
    assert words in str(error.value)


def test_an_option_that_a_format_has_no_use_for(tmp_path):
    from tests.io.depth_sets.test_formats import pair

    writers.middlebury(tmp_path, pair(), 0.3)
    with pytest.raises(ValueError, match=r"^depth_scale: found 0\.1, allowed: None with the format middlebury"):
        io.read_depth_set(tmp_path, depth_scale=0.1)


def test_cameras_alone(folder):
    set_ = read(folder)
    for camera, image in zip(io.read_depth_cameras(folder, near=1, far=9, **OWN), set_, strict=True):
        assert np.array_equal(camera.view_from_world, image.camera.view_from_world)
        assert np.array_equal(camera.intrinsics, image.camera.intrinsics)
        assert (camera.near, camera.far) == (1, 9)
    (moved,) = io.read_depth_cameras(folder, views=[1], pose=shots.shots()[2].pose[:3], **OWN)
    assert np.array_equal(moved.view_from_world, set_.cameras[2].view_from_world)
    with pytest.raises(TypeError):
        io.read_depth_cameras(folder, views=[1], scale=2)
