"""The loop in software, and lighting that is baked in: the same bits as the stages where the definition says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from ibr_ref import Light, splatting
from ibr_ref.models.surface_depths import ball_depths
from ibr_ref.splatting import Params, Scene, bake
from tests.agreement import arrays_of, difference
from tests.splatting.golden_scenes import SCENES, TINY
from tests.splatting.scenes import frame, image_of, looking, measured, parallel
from tests.splatting.test_bad_input import IMAGE, rejected

pytestmark = pytest.mark.usefixtures("one_thread")


@pytest.mark.parametrize("name", [name for name in TINY if name != "ellipses"])
def test_the_loop_makes_every_bit_of_the_stages(name: str) -> None:
    scene, params = SCENES[name](48, 36)
    shader = splatting.render(scene, params)
    loop = replace(params, method="software")
    software = splatting.render(scene, loop)
    for array, values in arrays_of(shader).items():
        assert not difference(array, arrays_of(software)[array], values)
    alone = splatting.render(scene, loop, stages=False)
    assert alone.stages == {}
    assert_array_equal(alone.color, shader.color)
    assert_array_equal(alone.depth, shader.depth)


def test_an_unsound_law_is_named_by_the_loop_too() -> None:
    scene = Scene(images=[IMAGE], camera=IMAGE.camera, light=None)
    with pytest.raises(ValueError, match=r"^beta, gamma, delta: found .*images\[0\], rows 0 to 0.*allowed: "):
        splatting.render(scene, Params(delta=-1.0, method="software"))


BALL = image_of(looking((0.4, -3.5, 1.2)), ball_depths(looking((0.4, -3.5, 1.2))))
VIEW = looking((1.0, -3.0, 1.0))
MATT = Light(position=(0.5, -4.0, 2.0), ambient=0.1, diffuse=0.7)
SHINY = replace(MATT, specular=0.8, exponent=9)


def test_matt_surfaces_are_baked_bit_for_bit() -> None:
    assert_array_equal(frame(bake([BALL], MATT), VIEW).color, frame([BALL], VIEW, MATT).color)


@pytest.mark.parametrize("camera", [looking((0.4, -3.5, 1.2)), parallel((0.4, -3.5, 1.2)), measured((0.4, -3.5, 1.2))])
def test_a_highlight_is_baked_as_the_reference_saw_it(camera: splatting.Scene) -> None:
    """From there it looks the same, from elsewhere not."""
    image = image_of(camera, ball_depths(camera))  # type: ignore[arg-type]
    baked = bake([image], SHINY)
    assert_array_equal(frame(baked, camera).color, frame([image], camera, SHINY).color)  # type: ignore[arg-type]
    assert np.abs(frame(baked, VIEW).color - frame([image], VIEW, SHINY).color).max() > 0.1


def test_what_cannot_be_baked_is_named() -> None:
    rejected("light", "NoneType", bake, [BALL], None)
    rejected("images[1]", "int", bake, [BALL, 3], MATT)
