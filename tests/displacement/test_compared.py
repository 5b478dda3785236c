"""What all compared systems have in common."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.displacement import Params, Scene, render
from ibr_ref.displacement.inputs import COMPARED
from tests.displacement.below import VIEWS
from tests.displacement.scenes import LIGHT, camera, frame, noise, same, square

each = pytest.mark.parametrize("method", COMPARED)


@each
def test_the_same_picture_without_stages(method: str) -> None:
    scene = Scene(polygons=[square(noise(6, 6))], camera=camera(), light=LIGHT)
    whole, bare = (render(scene, Params(method=method, shadow_steps=3), stages=stages) for stages in (True, False))
    assert bare.stages == {}
    assert same(whole.color, bare.color)
    assert same(whole.depth, bare.depth)


@each
def test_flat_tops_at_the_polygon_are_the_polygon(method: str) -> None:
    """H = 1 everywhere: depth 0, whichever the search; Welsh's offset is the whole height."""
    result = frame(square(np.ones((8, 8))), camera(), method=method)
    kept = result.stages["march.hit_index"] >= 0
    assert kept.sum() > 100
    u, v, h = result.stages["march.hit"][kept].T
    if method != "welsh":
        tolerance = 4 * 0.5 / 32 if method == "donnelly" else 1e-12
        assert np.abs(result.stages["raster.patch"][kept][:, :2].T - (u, v)).max() <= tolerance
    assert np.abs(h).max() <= (0.5 / 32 if method == "donnelly" else 1e-12)


@each
def test_an_eye_below_the_polygon_sees_nothing(method: str) -> None:
    result = frame(square(noise(6, 6)), camera(eye=(1.3, -0.9, -0.4)), method=method)
    assert (result.stages["raster.face"] == -1).all()
    assert (result.stages["march.fetches"] == 0).all()


@each
def test_each_polygon_of_several_has_hits_of_its_own(method: str) -> None:
    """Two side by side, drawn alone and together: what is shown is one of both."""
    polygons = [square(noise(6, 6)), square(noise(5, 7, seed=1), corner=(-1, 0, 0))]
    view = camera(eye=(0.2, -1.8, 1.2), target=(0, 0.5, 0), vertical_fov=50.0)
    both, *alone = (
        render(Scene(polygons=some, camera=view, light=LIGHT), Params(method=method))
        for some in (polygons, polygons[:1], polygons[1:])
    )
    patch_id = both.stages["raster.patch_id"]
    assert {0, 1} <= set(np.unique(patch_id))
    for number, single in enumerate(alone):
        here = (patch_id == number) & (both.stages["march.hit_index"] >= 0)
        assert here.sum() > 50
        for name in ("march.hit", "march.fetches", "shade.albedo"):
            assert same(both.stages[name][here], single.stages[name][here])


@each
def test_the_view_does_not_matter_to_what_is_kept_of_a_polygon(method: str) -> None:
    """Mips, distances, cones and quadtrees are made once: a second frame, from elsewhere, is that of a new polygon."""
    polygon = square(noise(6, 6))
    frame(polygon, VIEWS["grazing"], method=method)
    again, new = frame(polygon, camera(), method=method), frame(square(noise(6, 6)), camera(), method=method)
    assert all(same(again.stages[name], new.stages[name]) for name in new.stages)


def test_layers_that_make_too_many_voxels_are_named() -> None:
    scene = Scene(polygons=[square(np.zeros((300, 300)))], camera=camera(), light=LIGHT)
    with pytest.raises(
        ValueError, match=r"^distance_layers: found 1024, allowed: at most 67108864 voxels.*\(300, 300\)"
    ):
        render(scene, Params(method="donnelly", distance_layers=1024))


def test_other_methods_have_no_count_of_fetches() -> None:
    assert "march.fetches" not in frame(square(noise(6, 6)), camera()).stages
