"""The picture does not depend on the order of the images, on where in the world the scene is, or in which units it is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from ibr_ref import Camera, DepthImage, Light, splatting
from ibr_ref.io import Frame
from ibr_ref.models.surface_depths import ball_depths
from ibr_ref.splatting import Params, Scene
from tests.agreement import arrays_of, check_without_stages, difference, flat
from tests.golden import SCENES
from tests.splatting.scenes import Array, frame, image_of, looking, noise, parallel

pytestmark = pytest.mark.usefixtures("one_thread")

QUANTUM = math.sqrt(3.0) / 254.0
"""By how much an 8-bit normal is off at the most: half a step of 1/127 on every axis."""


# --- Order -----------------------------------------------------------------------------------------------------------


def rig(sizes: list[tuple[int, int]]) -> list[DepthImage]:
    """Views of a rough ball from around it, of several sizes."""
    eyes = [(3, 0, 1), (0, -3, 0.5), (-2, 2, 1), (0.5, 0.5, 3)]
    cameras = [looking(eye, size=size) for eye, size in zip(eyes, sizes, strict=True)]
    depths = [ball_depths(camera) + 0.1 * noise(camera.height, camera.width, seed=7) for camera in cameras]
    return [image_of(camera, depth) for camera, depth in zip(cameras, depths, strict=True)]


@settings(derandomize=True, deadline=None, max_examples=24)
@given(st.permutations(range(4)), st.sampled_from(["square", "disc"]), st.booleans())
def test_the_order_of_the_images_renames_points_and_changes_no_pixel(order: list[int], shape: str, lit: bool) -> None:
    images = rig([(12, 12), (9, 14), (16, 7), (12, 12)])
    view = looking((2.0, -2.0, 1.5), size=(32, 24))
    light = Light(direction=(1, -1, 2), specular=0.3) if lit else None
    here = frame(images, view, light, alpha=2.7, shape=shape)
    there = frame([images[i] for i in order], view, light, alpha=2.7, shape=shape)
    assert (here.stages["raster.margin"] > 0.0).all(), "no ties: they go to the first image"
    assert (here.stages["raster.overdraw"] > 4).any()
    for name in ("raster.depth", "raster.overdraw", "raster.margin"):
        assert_array_equal(there.stages[name], here.stages[name], err_msg=name)
    assert_array_equal(there.color, here.color)
    shown = here.stages["raster.splat"] >= 0
    sources = [f.stages["vertex.source"][f.stages["raster.splat"][shown]] for f in (here, there)]
    assert_array_equal(np.array(order)[sources[1][:, 0]], sources[0][:, 0])
    assert_array_equal(sources[1][:, 1:], sources[0][:, 1:])


def test_a_tie_goes_to_the_earlier_image() -> None:
    first = rig([(12, 12)] * 4)[0]
    double = DepthImage(color=1.0 - np.asarray(first.color), depth=first.depth, camera=first.camera, mask=first.mask)
    for images in ([first, double], [double, first]):
        here = frame(images, first.camera)
        assert_array_equal(here.stages["vertex.source"][here.stages["raster.splat"][first.mask], 0], 0)


# --- Batches and stages -----------------------------------------------------------------------------------------------

BY_NAME = {name: scene for name, scene in SCENES.items() if name.startswith("splatting/")}


@pytest.mark.parametrize("name", BY_NAME)
def test_without_stages_the_same_picture(name: str) -> None:
    scene, params = BY_NAME[name](48, 36)
    check_without_stages(splatting, scene, params, splatting.render(scene, params))


@pytest.mark.parametrize("points", [14, 17, 100])
@pytest.mark.parametrize("name", ["splatting/balls", "splatting/pages"])
def test_the_size_of_the_batches_changes_no_bit(name: str, points: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From one row of an image on."""
    scene, params = BY_NAME[name](48, 36)
    whole = splatting.render(scene, params)
    monkeypatch.setattr("ibr_ref.splatting.batches.BATCH_POINTS", points)
    parts = splatting.render(scene, params)
    for array, values in arrays_of(whole).items():
        assert not difference(array, arrays_of(parts)[array], values)
    check_without_stages(splatting, scene, params, whole)


def test_a_frame_is_the_same_again() -> None:
    """What is kept of the images between two frames depends on nothing else: another view in between, and the light."""
    images = rig([(12, 12)] * 4)
    view, light = looking((2.0, -2.0, 1.5)), Light(direction=(1, -1, 2))
    once = frame(images, view, light)
    frame(images[::-1], looking((-2.0, 1.0, 1.0), size=(9, 7)))
    for array, values in arrays_of(frame(images, view, light)).items():
        assert not difference(array, values, arrays_of(once)[array])


# --- The world -------------------------------------------------------------------------------------------------------


def moved(camera: Camera, turn: Array, shift: Array, scale: float = 1.0) -> Camera:
    """The camera after p -> scale (turn p) + shift."""
    view = camera.view_from_world.copy()
    view[:3, :3] = view[:3, :3] @ turn.T
    view[:3, 3] = scale * view[:3, 3] - view[:3, :3] @ shift
    clip = camera.clip_from_view.copy()
    if camera.perspective:
        clip[2, 3] *= scale
    else:
        clip[:3, :3] /= scale
    return Camera(view_from_world=view, clip_from_view=clip, near=scale * camera.near, far=scale * camera.far,
                  width=camera.width, height=camera.height)  # fmt: skip


def world(parallel_view: bool, lit: str, turn: Array, shift: Array, scale: float = 1.0) -> Frame:
    """Two references, one of them without perspective, of a rough ball, moved as a whole."""
    cameras = [looking((2.6, -1.5, 1.0), size=(20, 20)), parallel((-0.5, -3.5, 0.5), size=(18, 21))]
    images = []
    for camera in cameras:
        depth = scale * (ball_depths(camera) + 0.05 * noise(camera.height, camera.width, seed=3))
        images.append(image_of(moved(camera, turn, shift, scale), depth, noise(camera.height, camera.width, 3)))
    eye = (1.2, -2.7, 0.9)
    view = parallel(eye, size=(48, 36)) if parallel_view else looking(eye, size=(48, 36))
    lights = {
        "none": None,
        "sun": Light(direction=turn @ np.array((0.5, -0.7, 0.6)), ambient=0.1, diffuse=0.7),
        "lamp": Light(position=scale * (turn @ np.array((0.5, -4.0, 2.0))) + shift, ambient=0.1, diffuse=0.7),
    }
    law = {"alpha": 3.0, "beta": 0.05 / scale**2, "gamma": 0.2 / scale, "delta": 0.1}
    return frame(images, moved(view, turn, shift, scale), lights[lit], **law)


def rotation(quaternion: tuple[float, float, float, float]) -> Array:
    """The rotation matrix of a quaternion of any length but 0."""
    w, x, y, z = np.array(quaternion) / math.sqrt(sum(c * c for c in quaternion))
    return np.array(
        [
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        ]
    )


STAY = np.eye(3), np.zeros(3)


@pytest.mark.parametrize("parallel_view", [False, True])
@pytest.mark.parametrize("lit", ["none", "sun", "lamp"])
@pytest.mark.parametrize("exponent", [-20, -1, 7])
def test_units_that_differ_by_a_power_of_two_change_no_bit(parallel_view: bool, lit: str, exponent: int) -> None:
    """Nothing is rounded differently: every length of the world, and the law, is scaled exactly."""
    here, there = (world(parallel_view, lit, *STAY, scale) for scale in (1.0, 2.0**exponent))
    assert_array_equal(there.color, here.color)
    there_stages = flat(there.stages)
    for name, array in flat(here.stages).items():
        scale = 2.0**exponent if name.startswith("atlas.depth") else 1
        assert_array_equal(there_stages[name], array * scale if scale != 1 else array, err_msg=name)


quaternions = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: sum(c * c for c in q) > 0.1)
shifts = st.tuples(*[st.floats(-10.0, 10.0)] * 3).map(np.array)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(quaternions, shifts, st.booleans(), st.sampled_from(["none", "sun", "lamp"]))
def test_a_rigid_motion_changes_nothing_but_rounding(
    quaternion: tuple[float, float, float, float], shift: Array, parallel_view: bool, lit: str
) -> None:
    """Positions to 1e-9 (1e-15 of 30 world units, times 50 pixels a unit, and room). Winners and colours where no centre
    is that close to a tie of the snapping; lit colours to the quantum of the normals, which are coded in world space.
    """
    here, there = world(parallel_view, lit, *STAY), world(parallel_view, lit, rotation(quaternion), shift)
    a, b = here.stages, there.stages
    for name in ("vertex.window", "vertex.depth", "vertex.width"):
        np.testing.assert_allclose(b[name], a[name], rtol=0, atol=1e-9, err_msg=name)
    fraction = a["vertex.window"] * 256.0 % 1.0
    assume(np.abs(fraction - 0.5).min() > 1e-6)
    assert (a["raster.margin"] > 1e-9).all(), "no ties that rounding could turn"
    for name in ("raster.splat", "raster.overdraw"):
        assert_array_equal(b[name], a[name], err_msg=name)
    assert (a["raster.overdraw"] > 4).any()
    np.testing.assert_allclose(there.depth, here.depth, rtol=0, atol=1e-9)
    off = 0.0 if lit == "none" else 2.0 * 0.7 * 1.01 * QUANTUM  # either normal; 1 % for their normalization
    np.testing.assert_allclose(there.color, here.color, rtol=0, atol=off + 1e-9)


def test_a_shift_does_not_turn_the_normals() -> None:
    """So that even the lit colours stay, but for codes that hang on the last bit."""
    shift = np.array((4.0, -7.0, 2.0))
    here, there = world(False, "sun", *STAY), world(False, "sun", np.eye(3), shift)
    codes = [f.stages["atlas.normal"][0] for f in (here, there)]
    assert (codes[0] != codes[1]).mean() < 0.001
    assert (np.abs(here.color - there.color) < 1e-9).all(axis=2).mean() > 0.99


def test_what_params_are_left_out_are_the_defaults() -> None:
    image, view = rig([(12, 12)] * 4)[0], looking((2.0, -2.0, 1.5))
    scene = Scene(images=[image], camera=view, light=None)
    assert_array_equal(splatting.render(scene).color, splatting.render(scene, Params(alpha=1.0, delta=1.0)).color)
