"""The camera's matrices against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import ArrayLike, NDArray

from ibr_ref import Camera

derandomized = settings(derandomize=True, deadline=None, max_examples=50)

Array = NDArray[np.float64]
EPSILON = 2.0**-52

numbers = st.floats(-10.0, 10.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


def window(camera: Camera, p_world: ArrayLike) -> Array:
    """Window x, y and depth of a world point, as conventions.md says."""
    x, y, z, w = camera.clip_from_view @ (camera.view_from_world @ np.append(p_world, 1.0))
    return np.array([(x / w + 1) / 2 * camera.width, (1 - y / w) / 2 * camera.height, z / w])


def axes(eye: Array, target: Array, up: Array) -> tuple[Array, Array, Array]:
    """Right, top and forward, built differently: top is up without its part along forward (Gram-Schmidt)."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    top = up - forward * (forward @ up)
    top = top / np.linalg.norm(top)
    return np.cross(forward, top), top, forward


def well_posed(eye: Array, target: Array, up: Array) -> bool:
    """Far enough from all rejections that rounding stays below 1e-12."""
    sight = target - eye
    lengths = np.linalg.norm(sight) * np.linalg.norm(up)
    return bool(np.linalg.norm(sight) > 0.1 and lengths > 0.1 and np.linalg.norm(np.cross(sight, up)) > 0.05 * lengths)


@derandomized
@given(vectors, vectors, vectors, st.floats(1.0, 170.0), st.floats(0.01, 5.0), st.floats(1.1, 1000.0))
def test_the_corners_of_the_frustum_are_the_corners_of_the_picture(
    eye: Array, target: Array, up: Array, fov: float, near: float, ratio: float
) -> None:
    """Depth 0 on the near plane, 1 on the far plane. Positions are rounded to 1e-15, seen from a distance of `near`."""
    assume(well_posed(eye, target, up))
    far = near * ratio
    camera = Camera.look_at(eye=eye, target=target, up=up, vertical_fov=fov, near=near, far=far, width=320, height=200)
    right, top, forward = axes(eye, target, up)
    half = math.tan(math.radians(fov / 2))
    for distance, depth in ((near, 0.0), (far, 1.0)):
        for column, x in ((0.0, -1.6), (320.0, 1.6)):
            for row, y in ((0.0, 1.0), (200.0, -1.0)):
                corner = eye + distance * (forward + half * (x * right + y * top))
                position = window(camera, corner)
                assert_allclose(position[:2], (column, row), rtol=0, atol=1e-9 * max(1.0, 10.0 / near))
                assert_allclose(position[2], depth, rtol=0, atol=1e-11 * max(1.0, 10.0 / near))


@derandomized
@given(vectors, vectors, vectors, st.floats(0.1, 20.0), st.floats(-5.0, 5.0), st.floats(0.5, 50.0))
def test_the_box_of_an_orthographic_camera_is_the_picture(
    eye: Array, target: Array, up: Array, view_height: float, near: float, thickness: float
) -> None:
    assume(well_posed(eye, target, up))
    camera = Camera.orthographic(
        eye=eye, target=target, up=up, view_height=view_height, near=near, far=near + thickness, width=320, height=200
    )
    right, top, forward = axes(eye, target, up)
    for distance, depth in ((near, 0.0), (near + thickness, 1.0)):
        for column, x in ((0.0, -0.8), (320.0, 0.8)):
            for row, y in ((0.0, 0.5), (200.0, -0.5)):
                corner = eye + distance * forward + view_height * (x * right + y * top)
                assert_allclose(window(camera, corner), (column, row, depth), rtol=0, atol=1e-9 / min(1.0, view_height))
    assert_allclose(camera.eye, [*-forward, 0.0], rtol=0, atol=1e-12)
    assert not camera.perspective


def test_window_depth_is_linear_in_one_over_distance() -> None:
    """z_ndc = far (d - near)/(d (far - near)): the conventions' z in [0, 1]."""
    camera = Camera.look_at(eye=(0, 0, 0), target=(0, 1, 0), near=0.5, far=20.0)
    for distance in (0.5, 0.75, 1.0, 3.0, 10.0, 20.0):
        expected = 20.0 * (distance - 0.5) / (distance * 19.5)
        assert window(camera, (0.0, distance, 0.0))[2] == pytest.approx(expected, abs=4 * EPSILON)


def test_y_is_up_and_rows_grow_downwards() -> None:
    camera = Camera.look_at(eye=(0, -5, 0), target=(0, 0, 0), up=(0, 0, 1), width=100, height=100)
    centre = window(camera, (0, 0, 0))
    assert_allclose(centre[:2], (50, 50), rtol=0, atol=1e-12)
    assert window(camera, (0, 0, 1))[1] < 50
    assert window(camera, (1, 0, 0))[0] > 50


@derandomized
@given(vectors, vectors, vectors)
def test_view_from_world_is_rigid_and_has_its_inverse(eye: Array, target: Array, up: Array) -> None:
    """Rounding of a few operations on axes of length 1, and on positions up to 30: 1e-13."""
    assume(well_posed(eye, target, up))
    camera = Camera.look_at(eye=eye, target=target, up=up)
    rotation = camera.view_from_world[:3, :3]
    assert_allclose(rotation @ rotation.T, np.eye(3), rtol=0, atol=1e-14)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert_allclose(camera.world_from_view @ camera.view_from_world, np.eye(4), rtol=0, atol=1e-13)
    assert_allclose(camera.view_from_world @ np.append(eye, 1.0), (0, 0, 0, 1), rtol=0, atol=1e-13)
    assert_array_equal(camera.eye, np.append(eye, 1.0), "as given, to the last bit")
    assert_allclose(camera.world_from_view[:3, 3], eye, rtol=0, atol=1e-13)
    assert camera.perspective
    assert_array_equal(camera.clip_from_world, camera.clip_from_view @ camera.view_from_world)


def rotation(axis: Array, angle: float) -> Array:
    """Rodrigues' formula."""
    x, y, z = axis / np.linalg.norm(axis)
    k = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * (k @ k)


@derandomized
@given(vectors, st.floats(-3.0, 3.0), vectors, vectors)
def test_a_calibrated_camera_projects_with_its_intrinsics(axis: Array, angle: float, t: Array, p_view: Array) -> None:
    """window = K (x/-z, -y/-z, 1), splatting/method.md, "Inputs"; near and far at depths 0 and 1."""
    assume(np.linalg.norm(axis) > 0.1)
    p_view = np.array([p_view[0], p_view[1], -0.2 - abs(p_view[2])])
    k = np.array([(700.0, 3.0, 330.5), (0.0, 710.0, 251.25), (0.0, 0.0, 1.0)])
    r = rotation(axis, angle)
    camera = Camera.calibrated(intrinsics=k, rotation=r, translation=t, near=0.2, far=30.0, width=640, height=480)
    x, y, z = p_view
    expected = (k @ np.array([x / -z, -y / -z, 1.0]))[:2]
    p_world = r.T @ (p_view - t)
    assert_allclose(window(camera, p_world)[:2], expected, rtol=1e-11, atol=1e-9)
    for distance, depth in ((0.2, 0.0), (30.0, 1.0)):
        on_plane = r.T @ (p_view * (distance / -z) - t)
        assert window(camera, on_plane)[2] == pytest.approx(depth, abs=1e-11)
    assert_allclose(camera.view_from_world @ camera.eye, (0, 0, 0, 1), rtol=0, atol=1e-12)


def test_the_eye_of_a_measured_rotation_comes_from_the_inverse_matrix() -> None:
    """Not from the transpose: splatting/method.md, "Inputs". The rotation is off by 1e-4, as printed calibrations are."""
    r = rotation(np.array([1.0, 2.0, 3.0]), 0.7)
    r[0, 1] += 1e-4
    camera = Camera.calibrated(
        intrinsics=np.diag((500.0, 500.0, 1.0)), rotation=r, translation=(3, 2, 1), near=1, far=9, width=64, height=48
    )
    assert_allclose(camera.view_from_world @ camera.eye, (0, 0, 0, 1), rtol=0, atol=1e-14)
    assert np.abs(camera.eye[:3] - -r.T @ (3, 2, 1)).max() > 1e-5


def test_a_camera_can_be_given_its_matrices() -> None:
    made = Camera.look_at(eye=(1, 2, 3), target=(0, 0, 0), near=0.5, far=10, width=64, height=48)
    given_ = Camera(
        view_from_world=made.view_from_world, clip_from_view=made.clip_from_view, near=0.5, far=10, width=64, height=48
    )
    assert_allclose(given_.eye, (1, 2, 3, 1), rtol=0, atol=1e-14)
    assert given_.width == 64
    assert given_.near == 0.5


def test_a_camera_cannot_be_changed() -> None:
    camera = Camera.look_at(eye=(1, 2, 3), target=(0, 0, 0))
    with pytest.raises(AttributeError):
        camera.near = 1.0  # type: ignore[misc]
    for array in (camera.view_from_world, camera.clip_from_view, camera.eye):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


def test_a_camera_keeps_copies() -> None:
    eye = np.array([1.0, 2.0, 3.0])
    camera = Camera.look_at(eye=eye, target=(0, 0, 0))
    eye[0] = 7.0
    assert camera.eye[0] == 1.0
