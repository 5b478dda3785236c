"""Intrinsics of every camera, and the AFX camera: against closed forms, and what is not accepted."""

from __future__ import annotations

import dataclasses
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

derandomized = settings(derandomize=True, deadline=None, max_examples=50)

Array = NDArray[np.float64]
EPSILON = 2.0**-52

numbers = st.floats(-10.0, 10.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)
sizes = st.tuples(st.integers(1, 2000), st.integers(1, 2000))

PLACED: dict[str, Any] = {"position": (1, 2, 3), "orientation": (0, 1, 0, 0.5), "field_of_view": (1.2, 0.9),
                          "near": 0.5, "far": 20.0, "width": 64, "height": 48}  # fmt: skip
K = [[50.0, 2.0, 30.25], [0.0, 55.0, 20.5], [0.0, 0.0, 1.0]]


def window(camera: Camera, p_view: Array) -> Array:
    """Window x and y of a point in view space, by the clip matrix."""
    x, y, _, w = camera.clip_from_view @ np.append(p_view, 1.0)
    return np.array([(x / w + 1) / 2 * camera.width, (1 - y / w) / 2 * camera.height])


def window_by_intrinsics(camera: Camera, p_view: Array) -> Array:
    """splatting/method.md, "Inputs": K (x/-z, -y/-z, 1), orthographic K (x, -y, 1)."""
    x, y, z = p_view
    scale = 1 / -z if camera.perspective else 1.0
    return (camera.intrinsics @ np.array([x * scale, -y * scale, 1.0]))[:2]


# Intrinsics


def test_the_intrinsics_of_a_perspective_camera() -> None:
    camera = Camera.look_at(eye=(1, 2, 3), target=(0, 0, 0), vertical_fov=60.0, width=640, height=480)
    focal = 240.0 * math.sqrt(3.0)
    assert_allclose(camera.intrinsics, [[focal, 0, 320], [0, focal, 240], [0, 0, 1]], rtol=4 * EPSILON, atol=0)


def test_the_intrinsics_of_an_orthographic_camera_are_pixels_a_world_unit() -> None:
    camera = Camera.orthographic(eye=(1, 2, 3), target=(0, 0, 0), view_height=4.0, width=640, height=480)
    assert_array_equal(camera.intrinsics, [[120, 0, 320], [0, 120, 240], [0, 0, 1]])


def test_the_intrinsics_of_a_calibrated_camera_are_those_given() -> None:
    k = np.array(K) * [[1 / 3], [1 / 7], [1]]
    k[2, 2] = 1.0
    camera = Camera.calibrated(
        intrinsics=k, rotation=np.eye(3), translation=(0, 0, 0), near=0.1, far=9, width=61, height=47
    )
    assert_array_equal(camera.intrinsics, k)
    again = Camera(
        view_from_world=np.eye(4), clip_from_view=camera.clip_from_view, near=0.1, far=9, width=61, height=47
    )
    assert_allclose(again.intrinsics, k, rtol=0, atol=61 * EPSILON)


@derandomized
@given(st.sampled_from(["look_at", "orthographic", "calibrated", "afx", "afx box"]), sizes, vectors, st.data())
def test_intrinsics_say_what_the_clip_matrix_says(
    kind: str, size: tuple[int, int], p: Array, data: st.DataObject
) -> None:
    width, height = size
    p = np.array([p[0], p[1], -0.1 - abs(p[2])])
    common: dict[str, Any] = {"near": 0.1, "far": 20.0, "width": width, "height": height}
    angle = st.floats(0.01, 3.0)
    if kind == "look_at":
        camera = Camera.look_at(eye=(1, 2, 3), target=(0, 0, 0), vertical_fov=data.draw(st.floats(1, 175)), **common)
    elif kind == "orthographic":
        camera = Camera.orthographic(
            eye=(1, 2, 3), target=(0, 0, 0), view_height=data.draw(st.floats(0.1, 20)), **common
        )
    elif kind == "calibrated":
        focal, centre = st.floats(10, 3000), st.floats(-500, 2500)
        k = [
            [data.draw(focal), data.draw(st.floats(-5, 5)), data.draw(centre)],
            [0, data.draw(focal), data.draw(centre)],
        ]
        camera = Camera.calibrated(intrinsics=[*k, [0, 0, 1]], rotation=np.eye(3), translation=(0, 0, 0), **common)
    else:
        camera = Camera.axis_angle(
            position=(1, 2, 3),
            orientation=(1, 2, 3, 4),
            field_of_view=(data.draw(angle), data.draw(angle)),
            orthographic=kind == "afx box",
            **common,
        )
    expected = window_by_intrinsics(camera, p)
    scale = np.abs(camera.intrinsics).max() * max(1.0, np.abs(p[:2] / p[2]).max(), np.abs(p).max())
    assert_allclose(window(camera, p), expected, rtol=0, atol=16 * EPSILON * max(scale, width, height))


def test_intrinsics_are_copied_and_read_only() -> None:
    k = np.array(K)
    camera = Camera.calibrated(
        intrinsics=k, rotation=np.eye(3), translation=(0, 0, 0), near=1, far=9, width=64, height=48
    )
    k[0, 0] = 7.0
    assert_array_equal(camera.intrinsics, K)
    with pytest.raises(ValueError, match="read-only"):
        camera.intrinsics[0, 0] = 0.0


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"intrinsics": np.diag((50.0, 55.0, 1.0))}, "intrinsics"),
        ({"intrinsics": [[50, 2, 30.25], [0, 55, 20.5], [0, 0, 2]]}, "intrinsics"),
        ({"intrinsics": [1, 2, 3]}, "intrinsics"),
        ({"intrinsics": "K"}, "intrinsics"),
        ({"width": 65}, "intrinsics"),
        ({"height": 96}, "intrinsics"),
    ],
)
def test_intrinsics_that_are_not_those_of_the_matrix(change: dict[str, Any], field: str) -> None:
    """A changed size, too: the intrinsics are in pixels. With None they are computed anew."""
    camera = Camera.calibrated(
        intrinsics=K, rotation=np.eye(3), translation=(0, 0, 0), near=1, far=9, width=64, height=48
    )
    with pytest.raises(ValueError, match=rf"^{field}: found .*allowed: ") as error:
        dataclasses.replace(camera, **change)
    assert "\n" not in str(error.value)
    assert dataclasses.replace(camera, width=128, intrinsics=None).intrinsics[0, 0] == 100.0


@pytest.mark.parametrize("where", [(0, 3), (1, 0), (1, 3)])
def test_a_perspective_projection_that_no_intrinsics_express(where: tuple[int, int]) -> None:
    self_made = Camera.axis_angle(**PLACED)
    clip = self_made.clip_from_view.copy()
    clip[where] = 0.25
    with pytest.raises(ValueError, match=r"^clip_from_view\[:2\]: found .*0\.25.*allowed: ") as error:
        Camera(view_from_world=np.eye(4), clip_from_view=clip, near=0.5, far=20.0, width=64, height=48)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("where", [(0, 2), (1, 0), (1, 2)])
def test_an_oblique_box_is_no_orthographic_camera(where: tuple[int, int]) -> None:
    clip = Camera.axis_angle(**PLACED, orthographic=True).clip_from_view.copy()
    clip[where] = 0.25
    with pytest.raises(ValueError, match=r"^clip_from_view\[:2\]: found .*0\.25.*allowed: "):
        Camera(view_from_world=np.eye(4), clip_from_view=clip, near=0.5, far=20.0, width=64, height=48)


# The AFX camera


def test_the_standards_orientation_looks_down_minus_z() -> None:
    camera = Camera.axis_angle(**{**PLACED, "position": (0, 0, 10), "orientation": (0, 0, 1, 0)})
    assert_array_equal(camera.view_from_world, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -10], [0, 0, 0, 1]])
    assert_array_equal(camera.eye, [0, 0, 10, 1])
    assert camera.perspective


@pytest.mark.parametrize(
    ("axis", "sight", "up"),
    [
        ((0, 1, 0), (-1, 0, 0), (0, 1, 0)),  # by the right-hand rule, a quarter turn about +y takes -z to -x
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((0, 0, 1), (0, 0, -1), (-1, 0, 0)),
    ],
)
def test_a_quarter_turn(axis: Any, sight: Any, up: Any) -> None:
    camera = Camera.axis_angle(**{**PLACED, "orientation": (*axis, math.pi / 2)})
    world = camera.world_from_view[:3, :3]
    assert_allclose(world @ (0, 0, -1), sight, rtol=0, atol=EPSILON)
    assert_allclose(world @ (0, 1, 0), up, rtol=0, atol=EPSILON)


@derandomized
@given(vectors, st.floats(-20.0, 20.0), vectors)
def test_the_orientation_is_the_rotation_of_the_camera(axis: Array, angle: float, position: Array) -> None:
    """Against SciPy's, which goes through a quaternion: a few units in the last place of 1."""
    assume(np.linalg.norm(axis) > 1e-3)
    camera = Camera.axis_angle(**{**PLACED, "position": position, "orientation": (*axis, angle)})
    expected = Rotation.from_rotvec(axis / np.linalg.norm(axis) * angle).as_matrix()
    assert_allclose(camera.view_from_world[:3, :3].T, expected, rtol=0, atol=32 * EPSILON)
    assert_allclose(camera.view_from_world @ np.append(position, 1.0), (0, 0, 0, 1), rtol=0, atol=64 * EPSILON)
    assert_allclose(camera.view_from_world[:3, :3] @ expected, np.eye(3), rtol=0, atol=32 * EPSILON)
    assert_array_equal(camera.eye, np.append(position, 1.0))


def test_the_length_of_the_axis_does_not_matter() -> None:
    """Nor does its square have to be a float64."""
    short = Camera.axis_angle(**{**PLACED, "orientation": (0.5, 1.25, -0.75, 0.5)}).view_from_world
    for power in (2.0**-1000, 2.0**-3, 2.0**1000):
        long = Camera.axis_angle(**{**PLACED, "orientation": (0.5 * power, 1.25 * power, -0.75 * power, 0.5)})
        assert_array_equal(long.view_from_world, short)


@derandomized
@given(st.floats(0.01, 3.1), st.floats(0.01, 3.1), st.booleans())
def test_the_field_of_view_ends_at_the_borders_of_the_picture(
    horizontal: float, vertical: float, orthographic: bool
) -> None:
    camera = Camera.axis_angle(
        **{**PLACED, "field_of_view": (horizontal, vertical), "orthographic": orthographic, "far": 2.0}
    )
    half = (horizontal / 2, vertical / 2) if orthographic else (math.tan(horizontal / 2), math.tan(vertical / 2))
    assert_allclose(window(camera, np.array([half[0], half[1], -1.0])), (64, 0), rtol=0, atol=1e-12)
    assert_allclose(window(camera, np.array([-half[0], -half[1], -1.0])), (0, 48), rtol=0, atol=1e-12)
    for distance, depth in ((0.5, 0.0), (2.0, 1.0)):
        clip = camera.clip_from_view @ (0.0, 0.0, -distance, 1.0)
        assert clip[2] / clip[3] == pytest.approx(depth, abs=4 * EPSILON)
    assert camera.perspective is not orthographic
    assert_array_equal(camera.intrinsics[:2, 2], (32, 24))


def test_an_afx_camera_is_the_camera_that_looks_there() -> None:
    """At 45 degrees above the ground, looking at the origin from -y."""
    fov = 0.8
    looking = Camera.look_at(
        eye=(0, -3, 3), target=(0, 0, 0), vertical_fov=math.degrees(fov), near=0.5, far=20, width=48, height=48
    )
    turned = Camera.axis_angle(
        position=(0, -3, 3), orientation=(1, 0, 0, math.pi / 4), field_of_view=(fov, fov), near=0.5, far=20, width=48,
        height=48,
    )  # fmt: skip
    assert_allclose(turned.view_from_world, looking.view_from_world, rtol=0, atol=8 * EPSILON)
    assert_allclose(turned.clip_from_view, looking.clip_from_view, rtol=8 * EPSILON, atol=0)


def test_the_same_bits_on_every_machine() -> None:
    camera = Camera.axis_angle(position=(1, 2, 3), orientation=(1, 2, 3, 4), field_of_view=(1.1, 0.7))
    values = [*camera.view_from_world[0].tolist(), *np.diag(camera.clip_from_view)[:2].tolist()]
    assert [value.hex() for value in values] == [
        "-0x1.12307e1cb7d8fp-1",
        "-0x1.7b73537612f48p-2",
        "0x1.848bf0864399dp-1",
        "-0x1.0000000000000p+0",
        "0x1.a18bee457f547p+0",
        "0x1.5ea8559d212d7p+1",
    ]


def test_what_was_given_is_kept_until_something_changes() -> None:
    camera = Camera.axis_angle(**PLACED)
    assert camera.afx is not None
    assert camera.afx.position == (1.0, 2.0, 3.0)
    assert camera.afx.orientation == (0.0, 1.0, 0.0, 0.5)
    assert camera.afx.field_of_view == (1.2, 0.9)
    assert dataclasses.replace(camera, far=30.0).afx is None
    assert Camera.look_at(eye=(1, 2, 3), target=(0, 0, 0)).afx is None


POINTS = [((0, 0), "(0, 0)"), ((0, np.nan, 0), "nan"), ((np.inf, 0, 0), "inf"), ("here", "'here'"), (None, "None")]
TABLE = [
    *(("position", *row) for row in POINTS),
    *(("orientation", *row) for row in POINTS),
    ("orientation", (0, 1, 0), "(0, 1, 0)"),
    ("orientation", (0, 0, 0, 1), "[0.0, 0.0, 0.0, 1.0]"),
    ("orientation", (0, 0, 1, 2e6), "2000000.0"),
    ("orientation", (0, 0, 1, np.nan), "nan"),
    ("field_of_view", 0.7, "0.7"),
    ("field_of_view", (0.7,), "(0.7,)"),
    ("field_of_view", (0, 0.7), "[0.0, 0.7]"),
    ("field_of_view", (0.7, -0.7), "[0.7, -0.7]"),
    ("field_of_view", (0.7, math.pi), "3.14"),
    ("field_of_view", (0.7, 45.0), "45.0"),
    ("field_of_view", (5e-324, 0.7), "5e-324"),
    ("field_of_view", (1e-310, 0.7), "1e-310"),
    ("near", 0.0, "0.0"),
    ("near", -1.0, "-1.0"),
    ("far", 0.5, "0.5"),
    ("width", 0, "0"),
    ("height", 2.5, "2.5"),
]


@pytest.mark.parametrize(("field", "value", "found"), TABLE, ids=[f"{row[0]}={row[2]}" for row in TABLE])
def test_the_error_names_the_field_and_what_was_found(field: str, value: Any, found: str) -> None:
    with pytest.raises(ValueError, match=rf"^{re.escape(field)}: found .*allowed: ") as error:
        Camera.axis_angle(**{**PLACED, field: value})
    assert found in str(error.value).split("allowed")[0]


@pytest.mark.parametrize("box", [(0, 1), (1, -2), (1e-320, 1)])
def test_a_box_without_width_or_height(box: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"^field_of_view: found .*allowed: a width and a height > 0"):
        Camera.axis_angle(**{**PLACED, "field_of_view": box, "orthographic": True})


def test_what_is_only_just_allowed_is_accepted() -> None:
    Camera.axis_angle(**{**PLACED, "field_of_view": (45.0, 1e-6), "orthographic": True, "near": -5.0, "far": -4.0})
    Camera.axis_angle(**{**PLACED, "field_of_view": (math.nextafter(math.pi, 0), 1e-6)})
    Camera.axis_angle(**{**PLACED, "orientation": (0, 0, -1e-320, -1e6)})
