"""Cameras between two: closed forms, what does not depend on the axes, and what is not accepted."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ibr_ref import Camera

derandomized = settings(derandomize=True, deadline=None, max_examples=60)

Array = NDArray[np.float64]
EPSILON = 2.0**-52
SIZE: dict[str, Any] = {"width": 64, "height": 48}
PLANES: dict[str, Any] = {"near": 0.5, "far": 20.0}
K = np.array([[50.0, 2.0, 30.25], [0.0, 55.0, 20.5], [0.0, 0.0, 1.0]])

vectors = st.tuples(*[st.floats(-10.0, 10.0)] * 3).map(np.array)
fractions = st.floats(0.0, 1.0)
rotations = st.integers(0, 2**32 - 1).map(
    lambda seed: Rotation.from_quat(np.random.default_rng(seed).normal(size=4)).as_matrix()
)


def measured(rotation: Array, eye: Array, **changes: Any) -> Camera:
    values = {"intrinsics": K, "rotation": rotation, "translation": -rotation @ eye, **PLANES, **SIZE}
    return Camera.calibrated(**{**values, **changes})


def rotation_of(camera: Camera) -> Array:
    return camera.view_from_world[:3, :3]


def on_circle(degrees: float, **changes: Any) -> Camera:
    """Five units from the origin, which it looks at; at 0 degrees from -y, level."""
    angle = math.radians(degrees)
    return Camera.look_at(
        **{"eye": (5 * math.sin(angle), -5 * math.cos(angle), 0), "target": (0, 0, 0), **PLANES, **SIZE, **changes}
    )


def turn_between(first: Camera, second: Camera) -> float:
    """Angle between two orientations, radians."""
    return float(Rotation.from_matrix(rotation_of(first) @ rotation_of(second).T).magnitude())


# Closed forms


@pytest.mark.parametrize("make", [on_circle, lambda d: measured(rotation_of(on_circle(d)), on_circle(d).eye[:3])])
def test_the_ends_are_the_cameras_themselves(make: Any) -> None:
    first, second = make(-20.0), make(30.0)
    assert Camera.between(first, second, 0.0) is first
    assert Camera.between(first, second, 1) is second


@pytest.mark.parametrize("degrees", [1.0, 30.0, 60.0, 89.0])
def test_midway_of_two_that_are_symmetric(degrees: float) -> None:
    middle = Camera.between(on_circle(-degrees), on_circle(degrees), 0.5)
    expected = on_circle(0.0, eye=(0.0, -5 * math.cos(math.radians(degrees)), 0.0))
    assert_allclose(middle.view_from_world, expected.view_from_world, rtol=0, atol=20 * EPSILON)
    assert_allclose(middle.clip_from_view, expected.clip_from_view, rtol=4 * EPSILON, atol=4 * EPSILON)
    assert_allclose(middle.eye, expected.eye, rtol=0, atol=20 * EPSILON)


@pytest.mark.parametrize("degrees", [40.0, 90.0, 170.0])
@pytest.mark.parametrize("fraction", [0.1, 0.25, 0.7])
def test_the_turn_by_a_fraction(degrees: float, fraction: float) -> None:
    first, second = on_circle(0.0), on_circle(degrees)
    half = math.radians(degrees) / 2.0
    expected = 2.0 * math.atan2(fraction * math.sin(half), 1.0 - fraction + fraction * math.cos(half))
    camera = Camera.between(first, second, fraction)
    assert turn_between(first, camera) == pytest.approx(expected, abs=1e-12)
    assert_allclose(rotation_of(camera)[1], (0, 0, 1), rtol=0, atol=4 * EPSILON)  # level all the way
    assert degrees > 90.0 or abs(expected - fraction * 2 * half) < math.radians(1.0)  # as the docstring says


def test_position_intrinsics_and_planes_are_linear() -> None:
    first = measured(np.eye(3), np.array([1.0, 2.0, 3.0]))
    k = np.array([[58.0, -2.0, 32.25], [0.0, 71.0, 19.5], [0.0, 0.0, 1.0]])
    second = measured(np.eye(3), np.array([5.0, 0.0, 3.0]), intrinsics=k, near=1.5, far=28.0)
    camera = Camera.between(first, second, 0.25)
    assert_array_equal(camera.eye, [2.0, 1.5, 3.0, 1.0])
    assert_array_equal(camera.intrinsics, 0.75 * K + 0.25 * k)
    assert (camera.near, camera.far, camera.width, camera.height) == (0.75, 22.0, 64, 48)


def test_between_orthographic_cameras() -> None:
    def box(x: float, view_height: float) -> Camera:
        return Camera.orthographic(eye=(x, -3, 1), target=(x, 0, 1), view_height=view_height, **PLANES, **SIZE)

    camera = Camera.between(box(-2.0, 4.0), box(1.0, 2.0), 0.5)
    assert not camera.perspective
    assert_allclose(camera.view_from_world, box(-0.5, 1.0).view_from_world, rtol=0, atol=4 * EPSILON)
    assert_array_equal(camera.intrinsics, [[18, 0, 32], [0, 18, 24], [0, 0, 1]])  # pixels a unit: between 12 and 24
    assert_allclose(camera.clip_from_view, box(0.0, 48 / 18).clip_from_view, rtol=4 * EPSILON, atol=4 * EPSILON)


def test_an_orthographic_camera_off_its_axis_keeps_its_intrinsics() -> None:
    clip = np.array([[0.5, 0.1, 0, 0.2], [0, 0.6, 0, -0.3], [0, 0, -0.05, -0.02], [0, 0, 0, 1]])
    camera = Camera(view_from_world=np.eye(4), clip_from_view=clip, near=0.4, far=20.4, **SIZE)
    assert_allclose(Camera.between(camera, camera, 0.5).clip_from_view, clip, rtol=0, atol=4 * EPSILON)


# Properties


@derandomized
@given(rotations, rotations)
def test_midway_is_midway_on_the_sphere_of_rotations(first: Array, second: Array) -> None:
    """On the shorter arc, whichever of its four ways each quaternion took."""
    relative = Rotation.from_matrix(second @ first.T).as_rotvec()
    assume(np.linalg.norm(relative) < 3.1)
    camera = Camera.between(measured(first, np.zeros(3)), measured(second, np.zeros(3)), 0.5)
    expected = Rotation.from_rotvec(relative / 2).as_matrix() @ first
    assert_allclose(rotation_of(camera), expected, rtol=0, atol=1e-13)


@derandomized
@given(rotations, rotations, vectors, vectors, rotations, vectors, fractions)
def test_moving_both_moves_the_camera_between(
    first: Array, second: Array, eye_1: Array, eye_2: Array, motion: Array, shift: Array, fraction: float
) -> None:
    assume(Rotation.from_matrix(second @ first.T).magnitude() < 3.1)
    camera = Camera.between(measured(first, eye_1), measured(second, eye_2), fraction)
    moved = Camera.between(
        measured(first @ motion.T, motion @ eye_1 + shift),
        measured(second @ motion.T, motion @ eye_2 + shift),
        fraction,
    )
    assert_allclose(rotation_of(moved) @ motion, rotation_of(camera), rtol=0, atol=1e-13)
    assert_allclose(moved.eye[:3], motion @ camera.eye[:3] + shift, rtol=0, atol=1e-13)


@derandomized
@given(rotations, rotations, vectors, vectors, fractions)
def test_the_way_back_is_the_same_way(first: Array, second: Array, eye_1: Array, eye_2: Array, fraction: float) -> None:
    assume(Rotation.from_matrix(second @ first.T).magnitude() < 3.1)
    there = Camera.between(measured(first, eye_1), measured(second, eye_2), fraction)
    back = Camera.between(measured(second, eye_2), measured(first, eye_1), 1.0 - fraction)
    assert_allclose(back.view_from_world, there.view_from_world, rtol=0, atol=2e-13)


@derandomized
@given(rotations, rotations, st.integers(0, 2**32 - 1), st.floats(1e-9, 1.0, exclude_max=True))
def test_the_rotation_between_measured_ones_is_a_true_one(
    first: Array, second: Array, seed: int, fraction: float
) -> None:
    """Also half a turn apart, wherever it then leads."""
    noise = np.random.default_rng(seed).uniform(-1e-4, 1e-4, (2, 3, 3))
    ends = measured(first + noise[0], np.ones(3)), measured(second + noise[1], np.zeros(3))
    assert np.linalg.norm(rotation_of(ends[0]).T @ rotation_of(ends[0]) - np.eye(3)) > 1e-6
    r = rotation_of(Camera.between(*ends, fraction))
    assert_allclose(r.T @ r, np.eye(3), rtol=0, atol=8 * EPSILON)
    assert np.linalg.det(r) > 0.0


@derandomized
@given(rotations, st.integers(0, 2**32 - 1))
def test_leaving_a_measured_end_turns_by_half_its_defect_at_most(rotation: Array, seed: int) -> None:
    noisy = rotation + np.random.default_rng(seed).uniform(-1.5e-4, 1.5e-4, (3, 3))
    defect = np.linalg.norm(noisy.T @ noisy - np.eye(3))
    end, other = measured(noisy, np.ones(3)), measured(noisy, np.zeros(3))
    assert np.linalg.norm(rotation_of(Camera.between(end, other, 1e-15)) - noisy) <= 0.51 * defect


@pytest.mark.parametrize("axis", range(3))
def test_half_a_turn_apart_is_a_camera_too(axis: int) -> None:
    opposite = np.diag([1.0 if i == axis else -1.0 for i in range(3)])
    camera = Camera.between(measured(np.eye(3), np.zeros(3)), measured(opposite, np.zeros(3)), 0.5)
    assert turn_between(camera, measured(np.eye(3), np.zeros(3))) == pytest.approx(math.pi / 2, abs=1e-14)


# What is not accepted

FIRST = on_circle(0.0)
MIRRORED = Camera(
    view_from_world=FIRST.view_from_world @ np.diag((1, 1, -1, 1)),
    clip_from_view=FIRST.clip_from_view,
    **PLANES,
    **SIZE,
)
REJECTED: dict[str, tuple[Any, Any, Any, str]] = {
    "no camera, first": (None, FIRST, 0.5, "first: found 'NoneType'"),
    "no camera, second": (FIRST, "camera", 0.5, "second: found 'str'"),
    "below 0": (FIRST, FIRST, -1e-9, "fraction: found -1e-09"),
    "above 1": (FIRST, FIRST, 1.0001, "fraction: found 1.0001"),
    "not a number": (FIRST, FIRST, math.nan, "fraction: found nan"),
    "a word": (FIRST, FIRST, "half", "fraction: found 'half'"),
    "another width": (FIRST, on_circle(9, width=65), 0.5, "second.width: found 65, allowed: 64"),
    "another height": (FIRST, on_circle(9, height=47), 0.0, "second.height: found 47, allowed: 48"),
    "orthographic": (
        FIRST,
        Camera.orthographic(eye=(0, -5, 0), target=(0, 0, 0), view_height=2, **SIZE),
        1.0,
        "second.perspective: found False, allowed: True",
    ),
    "mirrored picture": (
        measured(np.eye(3), np.zeros(3)),
        measured(np.eye(3), np.zeros(3), intrinsics=K * [[-1.0], [1.0], [1.0]]),
        0.5,
        "second.intrinsics: found [[-50.0",
    ),
    "mirrored space": (FIRST, MIRRORED, 0.5, "second.view_from_world: found [["),
    "mirrored space, first": (MIRRORED, FIRST, 0.5, "first.view_from_world: found [["),
}


@pytest.mark.parametrize("name", REJECTED)
def test_what_is_not_accepted(name: str) -> None:
    first, second, fraction, message = REJECTED[name]
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        Camera.between(first, second, fraction)
