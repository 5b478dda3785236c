"""What each pixel holds: which fragment the stage arrays describe, and what stands where there is nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ibr_ref import BasePolygon, Camera, Light
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.io import Frame
from tests.displacement.scenes import LIGHT, block, camera, frame, noise, parallel_camera, same, square

INTEGERS = {"raster.face", "raster.patch_id", "march.linear_index", "march.hit_index"}
BOOLEANS = {"march.steep", "shade.lit"}
TRIPLES = {"raster.patch", "march.hit", "shade.albedo", "shade.normal"}
NUMBERS = {"march.height_before", "march.margin", "march.domain_margin", "march.steep_margin", "shade.lit_margin",
           "shade.axis_margin", "shade.facing_margin", "resolve.margin"}  # fmt: skip
SHADE_NUMBERS = {"shade.albedo", "shade.normal", "shade.lit_margin", "shade.axis_margin", "shade.facing_margin"}

RICH = square(block(16, 16, 4, 12, 0.9), facade_map=noise(4, 4, 3), normal_map=noise(5, 5, 3))
CASES: dict[str, tuple[BasePolygon, Camera, dict[str, Any]]] = {
    "paper": (RICH, camera(), {}),
    "shadows": (RICH, camera(), {"shadow_steps": 7}),
    "volume": (RICH, camera((0.5, -0.3, 0.1)), {"interval": "volume"}),
    "inside, paper": (RICH, camera((0.1, 0.1, 0.1), (0.6, 0.7, 0.05)), {}),
    "base": (RICH, camera(), {"faces": "base"}),
    "extended": (RICH, camera(), {"faces": "extended"}),
    "polygon depth": (RICH, camera(), {"depth": "polygon"}),
    "exact": (RICH, camera(), {"method": "exact"}),
    "relief": (RICH, camera(), {"method": "relief"}),
    "texture": (RICH, camera(), {"method": "texture"}),
    "repeat": (square(noise(8, 8), domain="repeat"), camera(), {"faces": "base"}),
    "orthographic": (RICH, parallel_camera(), {"shadow_steps": 7}),
}
each_case = pytest.mark.parametrize("name", CASES)


def rendered(name: str, *, stages: bool = True) -> Frame:
    polygon, view, params = CASES[name]
    scene = Scene(polygons=[polygon], camera=view, light=LIGHT, background=(0.1, 0.2, 0.3))
    return render(scene, Params(**params), stages=stages)


@each_case
def test_without_stages_the_picture_and_depth_are_the_same_bits(name: str) -> None:
    kept, plain = rendered(name), rendered(name, stages=False)
    assert plain.stages == {}
    assert same(plain.color, kept.color)
    assert same(plain.depth, kept.depth)


@each_case
def test_the_arrays_have_the_shapes_and_types_of_the_contract(name: str) -> None:
    result = rendered(name)
    assert result.color.shape == (36, 48, 3)
    assert result.depth.shape == (36, 48)
    assert set(result.stages) == INTEGERS | BOOLEANS | TRIPLES | NUMBERS | {"vertex.clip", "vertex.patch"}
    for key, array in result.stages.items():
        if key.startswith("vertex."):
            assert array.shape == (len(result.stages["vertex.clip"]), 4 if key == "vertex.clip" else 3)
            assert array.dtype == np.float64
            continue
        assert array.shape == ((36, 48, 3) if key in TRIPLES else (36, 48)), key
        assert array.dtype == (np.int32 if key in INTEGERS else np.bool_ if key in BOOLEANS else np.float64), key


def check_nothing(result: Frame, pixels: Any) -> None:
    """The values of "nothing here": no face covers the pixels."""
    for name, array in result.stages.items():
        if name in INTEGERS:
            assert (array[pixels] == -1).all(), name
        elif name in BOOLEANS:
            assert not array[pixels].any(), name
        elif not name.startswith("vertex."):
            assert np.isnan(array[pixels].astype(float)).all(), name


@each_case
def test_where_nothing_covers_the_pixel_stands_nothing_and_the_background(name: str) -> None:
    result = rendered(name)
    empty = result.stages["raster.face"] == -1
    assert empty.any()
    check_nothing(result, empty)
    assert (result.color[empty] == (0.1, 0.2, 0.3)).all()
    assert (result.depth[empty] == 1.0).all()


@each_case
def test_a_discarded_fragment_keeps_its_raster_stage_alone(name: str) -> None:
    result = rendered(name)
    stages = result.stages
    discarded = (stages["raster.face"] >= 0) & (stages["march.hit_index"] == -1)
    assert discarded.any() == (name not in ("base", "texture", "repeat"))
    for key in SHADE_NUMBERS | {"march.hit", "march.steep_margin"}:
        assert np.isnan(stages[key][discarded].astype(float)).all(), key
    assert (stages["march.linear_index"][discarded] == -1).all()
    assert (stages["march.height_before"][discarded] == 0).all()
    assert not stages["march.steep"][discarded].any()
    assert not stages["shade.lit"][discarded].any()
    assert np.isfinite(stages["raster.patch"][discarded].astype(float)).all()
    assert (stages["raster.patch_id"][discarded] == 0).all()
    assert (stages["resolve.margin"][discarded] == np.inf).all()
    for key in ("march.margin", "march.domain_margin"):
        assert (stages[key][discarded].astype(float) >= 0).all(), key
    assert (result.color[discarded] == (0.1, 0.2, 0.3)).all()
    assert (result.depth[discarded] == 1.0).all()


@each_case
def test_a_shown_fragment_is_complete(name: str) -> None:
    result = rendered(name)
    stages = result.stages
    shown = stages["march.hit_index"] >= 0
    assert shown.any()
    assert ((result.depth < 1) == shown).all()
    for key in TRIPLES | NUMBERS:
        assert not np.isnan(stages[key][shown].astype(float)).any(), key
    assert (result.color[shown] >= 0).all()
    assert (result.color[shown] <= 1).all()
    np.testing.assert_allclose(
        np.linalg.norm(stages["shade.normal"][shown].astype(float), axis=1), 1.0, rtol=0, atol=4 * 2.0**-52
    )
    assert (stages["raster.patch_id"][shown] == 0).all()


@each_case
def test_the_depth_is_that_of_the_hit(name: str) -> None:
    """Projected independently, with matrices: 1e-12 of a depth in [0, 1]. depth="polygon": that of the face's point C."""
    result, view = rendered(name), CASES[name][1]
    point = result.stages["raster.patch" if name == "polygon depth" else "march.hit"].astype(float)
    shown = result.depth < 1
    world = np.concatenate([point * (1, 1, 0.25), np.ones((*shown.shape, 1))], axis=2)
    clip = world @ view.clip_from_world.T
    np.testing.assert_allclose(result.depth[shown], (clip[..., 2] / clip[..., 3])[shown], rtol=0, atol=1e-12)


def slab(height: float, **more: Any) -> BasePolygon:
    return square(np.full((2, 2), height), **more)


UP = camera((0.5, 0.45, 2.0), (0.5, 0.5, 0.0), up=(0, 1, 0))


@pytest.mark.parametrize("order", [[0, 1, 2], [2, 1, 0], [1, 2, 0]])
def test_the_nearest_polygon_is_shown_in_whatever_order_they_come(order: list[int]) -> None:
    """Three plates above one another; resolve.margin is the distance in depth to the nearest of the others."""
    plates = [slab(0.0, corner=(0, 0, z)) for z in (0.0, 0.3, 0.5)]
    results = [render(Scene(polygons=[plates[i]], camera=UP, light=LIGHT)) for i in range(3)]
    together = render(Scene(polygons=[plates[i] for i in order], camera=UP, light=LIGHT))
    common = np.logical_and.reduce([result.stages["march.hit_index"] >= 0 for result in results])
    assert common.sum() > 100
    assert (together.stages["raster.patch_id"][common] == order.index(2)).all()
    assert same(together.color[common], results[2].color[common])
    assert same(together.depth[common], results[2].depth[common])
    gap = abs(results[1].depth - results[2].depth)[common]
    assert same(together.stages["resolve.margin"][common], gap)
    alone = together.stages["resolve.margin"][
        (results[0].depth < 1) & (results[1].depth == 1) & (results[2].depth == 1)
    ]
    assert (alone == np.inf).all()


def test_on_a_tie_in_depth_the_earlier_polygon_stays() -> None:
    """The same plate twice, in two colours."""
    red, blue = (slab(0.5, color_map=[[color]]) for color in ((1, 0, 0), (0, 0, 1)))
    result = render(Scene(polygons=[red, blue], camera=UP, light=Light(direction=(0, 0, 1))))
    shown = result.depth < 1
    assert (result.stages["raster.patch_id"][shown] == 0).all()
    assert (result.color[shown][:, 2] == 0).all()
    assert (result.stages["resolve.margin"][shown] == 0).all()


def test_a_discarded_fragment_gives_way_to_one_that_is_shown() -> None:
    """The nearer polygon's side faces are empty: what is behind shows through, and the stages describe that."""
    front, behind = slab(0.0, corner=(0, -0.8, 0)), slab(0.9, corner=(0, 0.4, 0))
    view = camera((0.5, -2.0, 0.8), (0.5, 0.4, 0.0))
    scene = {"camera": view, "light": LIGHT}
    first, second = (render(Scene(polygons=[p], **scene)) for p in (front, behind))
    both = render(Scene(polygons=[front, behind], **scene))
    through = (first.stages["raster.face"] >= 0) & (first.depth == 1) & (second.depth < 1)
    assert through.sum() > 20
    assert (both.stages["raster.patch_id"][through] == 1).all()
    assert same(both.color[through], second.color[through])
    nobody = (first.stages["raster.face"] >= 0) & (first.depth == 1) & (second.depth == 1)
    assert nobody.sum() > 20
    assert (both.stages["raster.patch_id"][nobody] == 0).all(), "the first that covers the pixel"


def test_a_hit_behind_the_far_plane_is_not_shown_but_noted() -> None:
    """Depth 1 or more fails the test against the cleared buffer; the stages hold the fragment, with its hit. Relief
    mapping alone has hits behind the faces, which are cut at the far plane."""
    view = camera((0.5, 0.45, 1.0), (0.5, 0.5, 0.0), up=(0, 1, 0), far=1.1)
    result = frame(square(block(8, 8, 2, 6, 0.9)), view, method="relief")
    noted = (result.stages["march.hit_index"] >= 0) & (result.depth == 1)
    shown = result.depth < 1
    assert noted.sum() > 50
    assert shown.sum() > 50
    for pixels, beyond in ((noted, True), (shown, False)):
        hit = result.stages["march.hit"][pixels] * (1, 1, 0.25)
        distance = -(np.concatenate([hit, np.ones((len(hit), 1))], axis=1) @ view.view_from_world.T)[:, 2]
        assert ((distance >= 1.1) == beyond).all()
    assert (result.stages["resolve.margin"][noted] == np.inf).all()
    assert np.isfinite(result.stages["shade.albedo"][noted].astype(float)).all()
    assert (result.color[noted] == (0.1, 0.2, 0.3)).all()


def test_a_hit_in_front_of_the_near_plane_is_discarded() -> None:
    """The face is cut at the near plane as well: what is left of it and finds a hit nearer than that shows nothing."""
    view = camera((0.5, -0.6, 0.6), (0.5, 0.5, 0.1), near=0.7)
    result = frame(square(np.full((2, 2), 0.9)), view)
    discarded = (result.stages["raster.face"] >= 0) & (result.stages["march.hit_index"] == -1)
    assert discarded.sum() > 20
    assert np.isnan(result.stages["march.hit"][discarded].astype(float)).all()
    hit = result.stages["march.hit"][result.depth < 1] * (1, 1, 0.25)
    distance = -(np.concatenate([hit, np.ones((len(hit), 1))], axis=1) @ view.view_from_world.T)[:, 2]
    assert distance.min() >= 0.7 - 1e-12


def test_a_camera_that_sees_nothing_gives_the_background() -> None:
    result = frame(RICH, camera((0.5, 0.5, 2.0), (0.5, 0.5, 4.0), up=(0, 1, 0)))
    assert (result.color == (0.1, 0.2, 0.3)).all()
    check_nothing(result, np.ones(result.depth.shape, bool))
