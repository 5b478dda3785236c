"""The picture does not depend on where in the world the scene is, how it is turned, and in which units it is measured."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ibr_ref import BasePolygon, Camera, Light
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.io import Frame
from tests.displacement.scenes import Array, block, noise, same

MARGIN = 1e-9
"""Decisions are compared where they were not closer than this. The transformed world is rounded to 1e-15 of its size (up to
30 here), and so are window coordinates and hits, to 1e-12 or better: three digits are left."""

CLOSE = 1e-8
"""Of positions, depths and colours: 1e-12, times the slopes of the maps (64 texels, height 0.9, specular exponent 8)."""


@dataclass(frozen=True)
class Motion:
    """p -> scale (rotation p) + translation."""

    rotation: Array
    scale: float
    translation: Array

    def point(self, p: Any) -> Array:
        return self.scale * (self.rotation @ np.array(p, float)) + self.translation

    def vector(self, v: Any) -> Array:
        return self.scale * (self.rotation @ np.array(v, float))


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


STAY = Motion(np.eye(3), 1.0, np.zeros(3))


def picture(motion: Motion, *, parallel: bool, point_light: bool, **params: Any) -> Frame:
    """A parallelogram with all kinds of maps, moved as a whole. The roof is at no point of the lattice: no ties."""
    maps = [block(64, 64, 20, 44, 0.8537), noise(9, 11, 3), 0.5 + 0.5 * noise(8, 8, 3, seed=1), noise(6, 6, 3, seed=2)]
    polygon = BasePolygon(
        corner=motion.point((-0.4, -0.6, 0.1)),
        edge_u=motion.vector((1.1, 0.2, 0.1)),
        edge_v=motion.vector((-0.3, 0.9, 0.05)),
        height_scale=0.3 * motion.scale,
        height_map=maps[0],
        color_map=maps[1],
        normal_map=maps[2],
        facade_map=maps[3],
        facade_tile=(0.11 * motion.scale, 0.13 * motion.scale),
    )
    view = {"eye": motion.point((1.03, -0.91, 0.83)), "target": motion.point((0.02, 0.01, 0.2)),
            "up": motion.vector((0, 0, 1)), "near": 0.1 * motion.scale, "far": 9 * motion.scale,
            "width": 64, "height": 48}  # fmt: skip
    camera = Camera.orthographic(view_height=1.3 * motion.scale, **view) if parallel else Camera.look_at(**view)
    place = (
        {"position": motion.point((0.7, 0.9, 1.7))} if point_light else {"direction": motion.vector((0.7, 0.9, 1.7))}
    )
    light = Light(**place, ambient=0.1, diffuse=0.6, specular=0.3, exponent=8)
    return render(Scene(polygons=[polygon], camera=camera, light=light), Params(shadow_steps=9, **params))


quaternions = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: sum(c * c for c in q) > 0.1)
offsets = st.tuples(*[st.floats(-10.0, 10.0)] * 3).map(np.array)
derandomized = settings(derandomize=True, deadline=None, max_examples=25)


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("point_light", [False, True])
@pytest.mark.parametrize("exponent", [-30, -1, 5, 40])
@pytest.mark.parametrize("interval", ["paper", "volume"])
def test_units_that_differ_by_a_power_of_two_change_no_bit(
    parallel: bool, point_light: bool, exponent: int, interval: str
) -> None:
    """Nothing is rounded differently: every number of the world is scaled exactly."""
    here = picture(STAY, parallel=parallel, point_light=point_light, interval=interval)
    scaled = Motion(np.eye(3), 2.0**exponent, np.zeros(3))
    there = picture(scaled, parallel=parallel, point_light=point_light, interval=interval)
    assert same(there.color, here.color)
    assert same(there.depth, here.depth)
    in_world_units = {"vertex.clip", "shade.axis_margin"}  # per world unit: the slope of the walls
    for name, array in here.stages.items():
        if name not in in_world_units:
            assert same(there.stages[name], array), name


@derandomized
@given(quaternions, st.floats(0.05, 20.0), offsets, st.booleans(), st.booleans(), st.sampled_from(["paper", "volume"]))
def test_rotation_translation_and_scaling_change_nothing_but_rounding(
    quaternion: tuple[float, float, float, float],
    scale: float,
    offset: Array,
    parallel: bool,
    point_light: bool,
    interval: str,
) -> None:
    here = picture(STAY, parallel=parallel, point_light=point_light, interval=interval)
    motion = Motion(rotation(quaternion), scale, offset * scale)
    there = picture(motion, parallel=parallel, point_light=point_light, interval=interval)
    a, b = here.stages, there.stages
    assert (a["raster.face"] == b["raster.face"]).all()
    sure = ~(a["march.margin"] < MARGIN) & ~(a["march.domain_margin"] < MARGIN)
    assert sure.mean() > 0.99
    for name in ("march.linear_index", "march.hit_index"):
        assert (a[name] == b[name])[sure].all(), name
    sure &= ~(a["march.steep_margin"] < MARGIN) & ~(a["shade.lit_margin"] < MARGIN)
    sure &= ~(a["shade.axis_margin"] < MARGIN) & ~(a["shade.facing_margin"] < MARGIN)
    assert sure.mean() > 0.98
    for name in ("march.steep", "shade.lit"):
        assert (a[name] == b[name])[sure].all(), name
    for name in ("raster.patch", "march.hit", "march.height_before", "shade.albedo"):
        np.testing.assert_allclose(b[name][sure], a[name][sure], rtol=0, atol=CLOSE, err_msg=name)
    turned = a["shade.normal"].astype(np.float64) @ motion.rotation.T
    np.testing.assert_allclose(b["shade.normal"][sure], turned[sure], rtol=0, atol=CLOSE)
    np.testing.assert_allclose(there.depth[sure], here.depth[sure], rtol=0, atol=CLOSE)
    np.testing.assert_allclose(there.color[sure], here.color[sure], rtol=0, atol=CLOSE)
    assert a["march.steep"].any()
    assert a["shade.lit"].any()
