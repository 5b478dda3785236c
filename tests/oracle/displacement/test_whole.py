"""A ground that passes far behind the eye, set up from its own corners: a right port, by those who allow it."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from ibr_ref.displacement import Params, Scene
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.programs.displacement.variants import WholeTriangles
from ibr_ref.scene import BasePolygon, Camera, Light
from tests.oracle.displacement.drawn import REFEREE, wrong


@cache
def ground() -> Case:
    """Of which only the far end is before the eye."""
    heights = np.random.default_rng(3).uniform(0.2, 0.8, (6, 6))
    polygon = BasePolygon(
        corner=(-1.0, -9.0, 0.0),
        edge_u=(2.1, 0.0, 0.1),
        edge_v=(0.1, 12.0, 0.0),
        height_map=heights,
        color_map=np.full((2, 2, 3), 0.5),
        height_scale=0.02,
    )
    camera = Camera.look_at(
        eye=(0.2, 0.0, 0.6), target=(0.1, 0.9, 0.0), vertical_fov=50.0, near=0.1, far=20.0, width=32, height=24
    )
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.2, -0.3, 1.0)))
    return Case(scene=scene, params=Params(linear_steps=4, binary_steps=2, faces="base"), profile="ieee32")


@pytest.mark.parametrize("rounding", ["even", "down"])
def test_planes_of_corners_behind_the_eye(rounding: str) -> None:
    policy = Policy(subpixel_bits=4, subpixel_rounding=rounding)
    arrays = WholeTriangles(ground().scene, ground().params, policy, {}).render()
    assert not wrong(REFEREE.judge_stages(ground(), device_of("gl,subpixel_bits=4"), arrays))
