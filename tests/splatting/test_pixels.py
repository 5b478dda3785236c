"""What is seen, and in which colour: points that are dropped, empty views, stored colours, light."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from ibr_ref import Camera, DepthImage, Light, splatting
from ibr_ref.models.surface_depths import ball_depths, dots, plane_depths
from ibr_ref.splatting import Params, Scene
from tests.splatting.scenes import frame, image_of, looking, measured, parallel, points

pytestmark = pytest.mark.usefixtures("one_thread")

BACKGROUND = (0.1, 0.2, 0.3)
SUN = Light(direction=(0.3, -0.8, 0.5), ambient=0.15, diffuse=0.6)
LAMP = Light(position=(0.5, -4.0, 2.0), ambient=0.1, diffuse=0.5, specular=0.3, exponent=9)

BALL = image_of(looking((0.4, -3.5, 1.2)), ball_depths(looking((0.4, -3.5, 1.2))))
VIEWS = {"perspective": looking((1.0, -3.0, 1.0)), "orthographic": parallel((1.0, -3.0, 1.0)),
         "measured": measured((1.0, -3.0, 1.0))}  # fmt: skip


# What is dropped


def check_nothing(images: list[DepthImage], view: Camera, **params: Any) -> None:
    """The background, no error, with stages and without, lit or not."""
    for light in (None, LAMP):
        here = frame(images, view, light, **params)
        assert_array_equal(here.color, np.broadcast_to(BACKGROUND, here.color.shape))
        assert (here.depth == 1.0).all()
        assert (here.stages["raster.splat"] == -1).all()
        assert (here.stages["raster.overdraw"] == 0).all()
        assert np.isinf(here.stages["raster.margin"]).all()
        scene = Scene(images=images, camera=view, light=light, background=BACKGROUND)
        assert_array_equal(splatting.render(scene, Params(**params), stages=False).color, here.color)


@pytest.mark.parametrize("make", [looking, parallel, measured])
def test_points_behind_the_eye_are_dropped(make: Any) -> None:
    """Wide splats and all: NaN, width 0, and the background."""
    view = make((0.0, -3.0, 0.0), (0.0, -9.0, 0.0))
    check_nothing([BALL], view, alpha=500.0, max_width=500.0)
    stages = frame([BALL], view).stages
    assert np.isnan(stages["vertex.window"]).all()
    assert np.isnan(stages["vertex.depth"]).all()
    assert (stages["vertex.width"] == 0.0).all()
    assert len(stages["vertex.color"]) == np.count_nonzero(BALL.mask)


def test_a_view_past_the_points_is_background() -> None:
    for view in (looking((0, -3, 0), (9, -3.5, 0)), looking((0, -300, 0)), looking((0, -3, 0), far=1.0)):
        check_nothing([BALL], view)


def test_a_point_is_kept_between_the_planes_and_no_further() -> None:
    """0 <= z <= w, both ends included: orthographic planes at 1 and 3, where nothing is rounded."""
    depths = [0.0, np.nextafter(1.0, 0.0), 1.0, 2.0, 3.0, np.nextafter(3.0, 4.0), 5.0]
    view = parallel((0, 0, 0), (0, 0, -1), up=(0, 1, 0), size=(7, 1), view_height=2.0, near=1.0, far=3.0)
    back = parallel((0, 0, 8), (0, 0, -1), up=(0, 1, 0), size=(7, 1), view_height=2.0, near=1.0, far=30.0)
    image = DepthImage(color=np.ones((1, 7, 3)), depth=[[8.0 + d for d in depths]], camera=back)
    found = frame([image], view).stages
    # Depths of 8 + d are rounded to 2^-50: the next floats below 1 and above 3 are 1 and 3 there.
    assert_array_equal(np.isnan(found["vertex.depth"]), [True, False, False, False, False, False, True])
    assert_array_equal(found["vertex.depth"][1:6], [0.0, 0.0, 0.5, 1.0, 1.0])
    assert_array_equal(found["vertex.width"], [0, 1, 1, 1, 1, 1, 0])
    assert_array_equal(found["raster.splat"], [[-1, 1, 2, 3, -1, -1, -1]])  # a depth of 1 never wins
    assert_array_equal(found["raster.overdraw"], [[0, 1, 1, 1, 1, 1, 0]])


def test_an_eye_among_the_points_sees_those_before_it() -> None:
    view = looking((0.0, -0.2, 0.0), (0.0, 5.0, 0.0), near=0.05)
    stages = frame([BALL], view).stages
    p_view = points(BALL)[BALL.mask] @ view.view_from_world[:3, :3].T + view.view_from_world[:3, 3]
    before = -p_view[:, 2] > view.near
    assert_array_equal(~np.isnan(stages["vertex.depth"]), before)
    assert 0 < before.sum() < len(before)


def test_a_centre_outside_reaches_in() -> None:
    """One point left of the picture, and its splat."""
    reference = Camera.look_at(eye=(0, -4, 0), target=(0, 0, 0), width=1, height=1)
    image = DepthImage(color=[[[1.0, 0.5, 0.0]]], depth=[[4.0]], camera=reference)
    view = parallel((2.0, -4, 0.0), (2.0, 0, 0.0), size=(16, 8), view_height=1.0)
    window = frame([image], view).stages["vertex.window"]
    np.testing.assert_allclose(window, [[8.0 - 16.0, 4.0]], atol=1e-12)
    covered = frame([image], view, alpha=20.0).stages["raster.splat"] == 0
    assert_array_equal(covered, np.broadcast_to(np.arange(16) < 2, (8, 16)))  # -8 + 10


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_the_margin_is_how_much_farther_the_next_splat_is(order: tuple[int, int, int]) -> None:
    """Three walls at window depths 1/4, 1/2 and 1, the second with one pixel, the last in half of the picture."""
    view = parallel((0, -4, 0), size=(4, 1), near=1.0, far=5.0)
    masks = [[True] * 4, [False, True, False, False], [False, False, True, True]]
    walls = [DepthImage(color=np.ones((1, 4, 3)), depth=np.full((1, 4), depth), camera=view, mask=[mask])
             for depth, mask in zip((2.0, 3.0, 5.0), masks, strict=True)]  # fmt: skip
    stages = frame([walls[i] for i in order], view).stages
    assert_array_equal(stages["raster.margin"], [[np.inf, 0.25, 0.75, 0.75]])
    assert_array_equal(stages["raster.overdraw"], [[1, 2, 2, 2]])
    assert_array_equal(frame([walls[0], walls[0]], view).stages["raster.margin"], [[0.0] * 4])


# Colours


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("shape", ["square", "disc"])
def test_without_a_light_colours_are_the_stored_ones_bit_for_bit(view: str, shape: str) -> None:
    here = frame([BALL], VIEWS[view], None, alpha=2.0, shape=shape)
    stored = np.asarray(BALL.color)[BALL.mask]
    assert_array_equal(here.stages["vertex.color"], stored)
    splat = here.stages["raster.splat"]
    assert (splat >= 0).any()
    expected = np.where((splat >= 0)[..., None], stored[splat], BACKGROUND)
    assert_array_equal(here.color, expected)


@pytest.mark.parametrize("light", [SUN, LAMP])
@pytest.mark.parametrize("view", VIEWS)
def test_a_pixel_has_the_colour_of_its_winner(view: str, light: Light) -> None:
    """The colours are made twice, for the stage and for the picture: bit for bit the same."""
    here = frame([BALL], VIEWS[view], light, alpha=2.0)
    splat = here.stages["raster.splat"]
    assert_array_equal(here.color[splat >= 0], here.stages["vertex.color"][splat[splat >= 0]])
    assert_array_equal(here.depth[splat >= 0], here.stages["vertex.depth"][splat[splat >= 0]])


dim = st.floats(0.0, 0.3)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(dim, dim, dim, st.sampled_from([0, 1, 7, 64]), st.floats(0.01, 1.0), st.booleans())
def test_brightness_is_linear_in_the_light(
    ambient: float, diffuse: float, specular: float, exponent: int, k: float, lamp: bool
) -> None:
    """Coefficients so small that nothing is clamped. All terms are positive: k and the five operations on the longest
    path are rounded on either side, 12 roundings in all.
    """
    place = {"position": (0.5, -4.0, 2.0)} if lamp else {"direction": (0.3, -0.8, 0.5)}

    def colors(share: float) -> Any:
        light = Light(
            **place, ambient=share * ambient, diffuse=share * diffuse, specular=share * specular, exponent=exponent
        )
        return frame([BALL], VIEWS["perspective"], light).stages["vertex.color"]

    full = colors(1.0)
    assert full.max() < 1.0
    np.testing.assert_allclose(colors(k), k * full, rtol=12 * 2.0**-53, atol=1e-300)
    assert_array_equal(colors(0.25), 0.25 * full, "a power of two changes no bit")


def test_what_is_brighter_than_1_is_clamped() -> None:
    here = frame([BALL], VIEWS["perspective"], Light(direction=(0, -1, 0), ambient=0.5, diffuse=9.0))
    dark = frame([BALL], VIEWS["perspective"], Light(direction=(0, -1, 0), ambient=0.05, diffuse=0.9))
    unclamped = 10.0 * dark.stages["vertex.color"]
    np.testing.assert_allclose(here.stages["vertex.color"], np.minimum(unclamped, 1.0), rtol=1e-14)
    assert (unclamped > 1.0).any()


def test_ambient_light_alone_is_the_albedo_times_it() -> None:
    light = Light(direction=(0, -1, 0), ambient=0.25, diffuse=0.0)
    assert_array_equal(frame([BALL], VIEWS["perspective"], light).stages["vertex.color"], 0.25 * BALL.color[BALL.mask])  # type: ignore[call-overload,index]


@pytest.mark.parametrize("lamp", [False, True])
def test_a_plane_is_lit_by_the_cosine(lamp: bool) -> None:
    """To what the 8-bit normal is off: sqrt(3) half steps of 1/127, and 1 % for its normalization."""
    normal = np.array((0.2, -0.8, 0.4))
    normal /= math.sqrt(normal @ normal)
    camera = looking((0.4, -3.5, 1.2))
    image = image_of(camera, plane_depths(camera, normal, 0.0), np.ones((24, 32, 3)))
    p = points(image)[image.mask]
    towards = (0.5, -4.0, 2.0) - p if lamp else np.broadcast_to((0.3, -0.8, 0.5), p.shape)
    cosine = dots(towards, normal) / np.sqrt(dots(towards, towards))
    place = {"position": (0.5, -4.0, 2.0)} if lamp else {"direction": (0.3, -0.8, 0.5)}
    found = frame([image], camera, Light(**place, ambient=0.1, diffuse=0.7)).stages["vertex.color"]
    assert len(p) > 500
    assert np.abs(found[:, 0] - (0.1 + 0.7 * cosine)).max() <= 0.7 * 1.01 * math.sqrt(3.0) / 254.0


def test_a_plane_is_dark_from_behind_and_its_highlight_is_the_mirrors() -> None:
    """A plane across the view whose normal has the code of an axis, exactly."""
    camera = looking((0.0, -4.0, 0.0), size=(9, 9))
    image = DepthImage(color=np.full((9, 9, 3), 0.5), depth=np.full((9, 9), 4.0), camera=camera)
    behind = Light(position=(0.0, 3.0, 0.0), ambient=0.2, diffuse=0.8, specular=1.0)
    assert_array_equal(frame([image], camera, behind).color, np.full((9, 9, 3), 0.5 * 0.2))
    # Seen from (-a, -3, 0) and lit from (a, -3, 0): the middle is the mirror, where r.v is 1.
    view = looking((-2.0, -3.0, 0.0))
    light = Light(position=(2.0, -3.0, 0.0), ambient=0.0, diffuse=0.0, specular=0.6, exponent=40)
    shine = frame([image], view, light).stages["vertex.color"][:, 0].reshape(9, 9)
    p = points(image)
    to_light, to_eye = (2.0, -3.0, 0.0) - p, (-2.0, -3.0, 0.0) - p
    l, v = (a / np.sqrt(dots(a, a))[..., None] for a in (to_light, to_eye))
    mirrored = l * (-1.0, 1.0, -1.0)  # about the normal (0, -1, 0)
    np.testing.assert_allclose(shine, 0.6 * np.maximum(dots(mirrored, v), 0.0) ** 40, rtol=1e-12)
    assert np.unravel_index(shine.argmax(), shine.shape) == (4, 4)
    assert shine[4, 4] == pytest.approx(0.6, rel=1e-12)
