"""Normals of surfaces that have formulas: a plane, a sphere, a cube."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from ibr_ref import Camera, DepthImage
from ibr_ref.models.surface_depths import ball_depths, dots, plane_depths
from tests.splatting.scenes import Array, box_depths, frame, image_of, looking, measured, parallel, points

pytestmark = pytest.mark.usefixtures("one_thread")

HALF_STEP = 0.5 / 127.0
"""An 8-bit normal's component is k = floor(127 n + 128.5), read as (k - 128)/127: off by half a step at the most."""
ROUNDING = 1e-9
"""Of normals made of differences of some 1e-2 between positions of some 1e0, which are rounded to some 1e-16."""

CAMERAS = {"perspective": looking((0.4, -3.5, 1.2)), "orthographic": parallel((0.4, -3.5, 1.2)),
           "measured": measured((0.4, -3.5, 1.2))}  # fmt: skip


def codes(image: DepthImage) -> Array:
    """(H, W, 3) as they are stored."""
    stage = frame([image], image.camera).stages["atlas.normal"][0]
    assert stage.dtype == np.uint8
    return stage


def read(code: Array) -> Array:
    """(k - 128)/127, not normalized."""
    return (code.astype(np.float64) - 128.0) / 127.0


def to_camera(image: DepthImage) -> Array:
    """(H, W, 3) unit vectors towards the camera."""
    eye = image.camera.eye
    away = eye[:3] - eye[3] * points(image)
    return away / np.sqrt(dots(away, away))[..., None]


def neighbours(image: DepthImage, dy: int, dx: int) -> Array:
    """(H, W) whether the neighbour there is on the mask and no jump away."""
    _, depth, mask = image.arrays
    padded = np.pad(np.where(mask, depth, np.inf), 1, constant_values=np.inf)
    height, width = depth.shape
    other = padded[1 + dy : 1 + dy + height, 1 + dx : 1 + dx + width]
    return mask & (np.abs(other - np.where(mask, depth, 0.0)) <= 0.05 * depth)


def surrounded(image: DepthImage) -> Array:
    """(H, W) whether all four neighbours are usable."""
    return np.logical_and.reduce([neighbours(image, dy, dx) for dy, dx in ((0, 1), (0, -1), (1, 0), (-1, 0))])


# The plane


@settings(derandomize=True, deadline=None, max_examples=60)
@given(
    st.sampled_from(list(CAMERAS)),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda n: sum(c * c for c in n) > 0.1),
)
def test_the_normal_of_a_plane_is_the_planes_everywhere(kind: str, direction: tuple[float, float, float]) -> None:
    """At the borders as well, wherever there is a neighbour on either axis: to half a step of 1/127 a component."""
    camera = CAMERAS[kind]
    normal = np.array(direction) / math.sqrt(sum(c * c for c in direction))
    depth = plane_depths(camera, normal, 0.0)
    image = image_of(camera, np.where((depth > 1.0) & (depth < 9.0), depth, np.nan))
    if not np.asarray(image.mask).any():
        return
    across = neighbours(image, 0, 1) | neighbours(image, 0, -1)
    along = neighbours(image, 1, 0) | neighbours(image, -1, 0)
    facing = dots(to_camera(image), normal)
    usable = across & along & (np.abs(facing) > 1e-3)  # nearly edge-on: either side may face the camera
    expected = normal * np.sign(facing)[..., None]
    off = np.abs(read(codes(image)) - expected)[usable]
    assert not off.size or off.max() <= HALF_STEP + ROUNDING


@pytest.mark.parametrize("kind", CAMERAS)
def test_a_plane_across_the_view(kind: str) -> None:
    """Exactly the code of the camera's own axis, every pixel of it."""
    camera = CAMERAS[kind]
    image = DepthImage(color=np.ones((24, 32, 3)), depth=np.full((24, 32), 3.0), camera=camera)
    rows = camera.view_from_world[:3, :3]
    axis = np.cross(
        rows[0], rows[1]
    )  # at right angles to both axes of the picture, if the rotation is measured as well
    expected = np.floor(127.0 * axis / np.sqrt(axis @ axis) + 128.5)
    assert (np.abs(codes(image) - expected) == 0).all()


# The sphere


@pytest.mark.parametrize("kind", CAMERAS)
def test_the_normal_of_a_sphere_is_its_radius(kind: str) -> None:
    """The plane through three points of a sphere stands at right angles to the line from the centre to the middle of
    their circumcircle; its radius r then leaves asin(r/R) between that line and the one to each of the points, exactly.
    r = |a| |b| |a - b| / (2 |a x b|) for the two differences a and b. The largest of the four triangles bounds what
    the method's choice among them can do; the 8-bit code adds half a step on every axis.
    """
    radius = 1.2
    image = image_of(CAMERAS[kind], ball_depths(CAMERAS[kind], radius))
    p, inside = points(image), surrounded(image)
    bound = np.zeros(inside.shape)
    for down in (1, -1):
        for right in (1, -1):
            a, b = np.roll(p, -right, axis=1) - p, np.roll(p, -down, axis=0) - p
            area = np.cross(a, b)
            sides = np.sqrt(dots(a, a) * dots(b, b) * dots(a - b, a - b))
            with np.errstate(invalid="ignore"):
                bound = np.maximum(bound, sides / (2.0 * np.sqrt(dots(area, area))) / radius)
    angle = np.arcsin(bound[inside]) + math.sqrt(3.0) * HALF_STEP + ROUNDING
    off = read(codes(image))[inside] - p[inside] / radius
    assert inside.sum() > 100
    assert (np.sqrt(dots(off, off)) <= angle).all(), "a chord is shorter than its arc"
    assert np.median(angle) < 0.1, "a bound that says something"


def test_a_fine_sphere_is_within_three_degrees_of_its_radius_almost_everywhere() -> None:
    camera = looking((0.4, -3.5, 1.2), size=(160, 120))
    image = image_of(camera, ball_depths(camera))
    off = read(codes(image)) - points(image)
    inside = surrounded(image)
    assert (np.sqrt(dots(off, off))[inside] < math.radians(3.0)).mean() > 0.95


# The cube


@pytest.mark.parametrize("kind", CAMERAS)
def test_the_faces_of_a_cube_have_the_axes_codes(kind: str) -> None:
    """Exactly, where a pixel and its four neighbours lie on one face: 128 for 0, 255 for 1, 1 for -1."""
    eye, size = (1.7, -3.1, 1.9), (64, 48)
    camera = {"perspective": looking, "orthographic": parallel, "measured": measured}[kind](eye, size=size)
    image = image_of(camera, box_depths(camera, 0.7))
    p = np.nan_to_num(points(image))
    side = np.abs(p).argmax(axis=2)
    face = np.where(image.mask, 2 * side + (np.take_along_axis(p, side[..., None], 2)[..., 0] > 0), -1)
    inner = surrounded(image)
    for shift, axis in ((1, 0), (-1, 0), (1, 1), (-1, 1)):
        inner &= np.roll(face, shift, axis=axis) == face
    code = codes(image)
    assert set(face[inner].tolist()) == {1, 2, 5}, "+x, -y and +z are seen"
    for which in set(face[inner].tolist()):
        expected = [128, 128, 128]
        expected[which // 2] = 255 if which % 2 else 1
        assert_array_equal(
            code[inner & (face == which)], np.broadcast_to(expected, (int((face[inner] == which).sum()), 3))
        )


# Everywhere


@pytest.mark.parametrize("kind", CAMERAS)
def test_all_normals_face_the_camera_and_have_length_1(kind: str) -> None:
    """To the quantum: sqrt(3) half steps."""
    for depth in (box_depths(CAMERAS[kind]), ball_depths(CAMERAS[kind])):
        image = image_of(CAMERAS[kind], depth)
        mask, normal = np.asarray(image.mask), read(codes(image))
        slack = math.sqrt(3.0) * HALF_STEP + ROUNDING
        assert (dots(normal, to_camera(image))[mask] >= -slack).all()
        assert (np.abs(np.sqrt(dots(normal, normal)) - 1.0)[mask] <= slack).all()
        assert (codes(image)[~mask] == 0).all()
        assert (codes(image)[mask] >= 1).all()


def lonely(camera: Camera) -> list[DepthImage]:
    """Pixels without a usable pair: every other one, a row, a column, and jumps on all sides."""
    row, column = np.mgrid[0 : camera.height, 0 : camera.width]
    flat, board = np.full(row.shape, 3.0), np.where((row + column) % 2 == 0, 3.0, 3.2)
    masks = [(row % 2 == 0) & (column % 2 == 0), row == 3, column == 3, None]
    color = np.ones((*row.shape, 3))
    return [DepthImage(color=color, depth=board if mask is None else flat, camera=camera, mask=mask) for mask in masks]


@pytest.mark.parametrize("kind", CAMERAS)
def test_without_a_pair_of_neighbours_the_normal_points_to_the_camera(kind: str) -> None:
    for image in lonely(CAMERAS[kind]):
        mask = np.asarray(image.mask)
        assert np.abs(read(codes(image)) - to_camera(image))[mask].max() <= HALF_STEP + ROUNDING


def test_a_picture_of_one_pixel_points_to_the_camera() -> None:
    image = DepthImage(color=np.ones((1, 1, 3)), depth=[[3.0]], camera=looking((0, -3, 0), size=(1, 1)))
    assert codes(image).tolist() == [[[128, 1, 128]]]


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize(("after", "before", "expected"), [
    (3.0, 3.1, "after"),
    (3.1, 3.0, "before"),
    (3.125, 2.875, "after"),
    (2.875, 3.125, "after"),
    (3.16, 3.1, "before"),
    (3.0, np.nan, "after"),
    (np.nan, 2.9, "before"),
    (3.2, 2.86, "before"),
])  # fmt: skip
def test_of_two_neighbours_the_one_nearer_in_depth_counts(
    after: float, before: float, expected: str, upright: bool
) -> None:
    """On a tie the right or lower one; a missing one and one across a jump, more than 0.15 here, does not. Along the other
    axis all depths are the same.
    """
    camera = parallel((0, -5, 0), size=(3, 3))
    depth = np.array([[before, 3.0, after]] * 3)
    image = image_of(camera, depth.T.copy() if upright else depth)
    p = points(image)
    chosen = 2 if expected == "after" else 0
    across, along = (p[1, 2], p[chosen, 1]) if upright else (p[1, chosen], p[2, 1])
    n = np.cross(across - p[1, 1], along - p[1, 1])
    n *= np.sign(n @ camera.eye[:3]) / np.sqrt(n @ n)
    assert_array_equal(codes(image)[1, 1], np.floor(127.0 * n + 128.5))
