"""What control points are taken: registered ones where they are better beyond chance, and what is said of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ibr_ref import models
from ibr_ref.metrics import iou
from ibr_ref.shadows import Maps, Params, Scene, automatic, controls, folds, prepare, shadow_maps
from ibr_ref.shadows.placement import Placement
from ibr_ref.shadows.selection import Reach, Tried, best_of
from tests.shadows import never_worse
from tests.shadows.casters import thin_bar
from tests.shadows.scenes import box, light, params, scene

# --- Which one -------------------------------------------------------------------------------------------------------


def tried(name: str, mean: float, spread: float, seed: int) -> Tried:
    return Tried(name, np.clip(mean + spread * np.random.RandomState(seed).standard_normal(128), 0.0, 1.0))


def test_registered_points_that_are_clearly_better_are_taken() -> None:
    far, near = tried("registered", 0.95, 0.002, 1), tried("bounds", 0.9, 0.002, 2)
    assert best_of([far, near], [near], 1) == 0


def test_what_is_better_by_chance_alone_is_not() -> None:
    """The simple one is never behind itself; the other one would be about every other time."""
    close, simple = tried("registered", 0.9502, 0.01, 1), tried("bounds", 0.95, 0.01, 2)
    assert best_of([close, simple], [simple], 1) == 1


def test_a_better_mean_does_not_buy_a_far_worse_worst() -> None:
    found = np.full(128, 0.96)
    found[::8] = 0.2
    simple = tried("bounds", 0.9, 0.01, 2)
    assert best_of([Tried("registered", found), simple], [simple], 1) == 1


def test_of_equals_the_first() -> None:
    same = tried("bounds", 0.9, 0.01, 2)
    assert best_of([same, same, same], [same], 1) == 0
    assert best_of([same, same], [same], 0) == 0


# --- Snapping --------------------------------------------------------------------------------------------------------


def test_points_that_would_fold_by_snapping_stay_where_they_are() -> None:
    """A column closer to the next than a step of the lattice: on it both would be one."""
    points = np.array(np.broadcast_to(controls.regular(5, 5), (3, 3, 5, 5, 2)))
    step = 1.0 / (64 * 256)
    points[..., 2, 0] = points[..., 1, 0] + 0.3 * step
    points[..., 1:-1, 3, 1] += 0.2 * step
    assert folds.unfolded(points)
    assert not folds.unfolded(controls.on_lattice(points, 64))
    found = automatic.snapped(points, 64)
    assert folds.unfolded(found)
    assert np.array_equal(found[:, :, :, 4], controls.on_lattice(points, 64)[:, :, :, 4])
    assert np.abs(found - points).max() <= step / 2
    assert np.array_equal(automatic.snapped(found, 64), found)


# --- Scenes that went wrong ------------------------------------------------------------------------------------------


def quality(given: Scene, parameters: Params, made: Maps, count: int = 16) -> float:
    low, high = np.asarray(given.offset_range).T
    found = []
    for offset in np.random.RandomState(6).uniform(low, high, (count, 2)):
        at = replace(given, offset=offset)
        truth = shadow_maps(at, replace(parameters, method="direct"))[0]
        found.append(iou(shadow_maps(at, parameters, maps=made)[0], truth))
    return float(np.mean(found))


@pytest.mark.long
@pytest.mark.parametrize("fov", [14.0, 17.0])
def test_a_shadow_across_the_map_s_border_is_registered(fov: float) -> None:
    """Lines of the silhouette's box mark other parts of the caster where the border cuts it."""
    given = models.shadow_stage(models.chair(), width=16, height=12)
    given = replace(given, light=replace(given.light, vertical_fov=fov))
    small = Params(map_size=64, rows=9, columns=5)
    made = {name: prepare(given, small, controls=name) for name in ("best", "fast", "bounds", "identity")}
    found = {name: quality(given, small, each) for name, each in made.items()}
    assert made["best"].texels[..., [0, -1], :].any() or made["best"].texels[..., [0, -1]].any()
    assert found["best"] > found["bounds"] + 0.01, found
    assert found["best"] > found["identity"] + 0.1, found
    assert found["best"] > found["fast"] - 0.01, found


def bar() -> Scene:
    """So thin that its mask is empty in some of the maps, and some others' too."""
    given = models.shadow_stage(thin_bar(), width=16, height=12)
    return replace(given, offset_range=((-0.3, 0.3), (-0.3, 0.3)))


def test_an_empty_map_among_the_nine_is_no_reason_for_a_regular_grid() -> None:
    """Of a caster that is out of one map's sight; its box is known all the same."""
    aside = scene(
        light=light(vertical_fov=11.0), caster=box(0.3), offset_range=((-0.8, 0.2), (-0.8, 0.2)), offset=(0.0, 0.0)
    )
    small = params(rows=7, columns=7)
    made = {name: prepare(aside, small, controls=name) for name in ("best", "bounds", "identity")}
    assert not made["best"].texels[0, 0].any()
    assert made["best"].texels[2, 2].any()
    found = {name: quality(aside, small, each) for name, each in made.items()}
    assert not np.array_equal(made["bounds"].controls, made["identity"].controls)
    assert found["best"] >= max(found["bounds"], found["identity"]), found
    assert found["best"] > found["identity"] + 0.02, found


def test_that_nothing_good_was_found_is_part_of_the_maps() -> None:
    made = prepare(bar(), Params(map_size=32), controls="fast")
    assert made.choice is not None
    assert not made.choice.good
    assert made.choice.chosen.mean < 0.5


@pytest.mark.long
@pytest.mark.parametrize("reach", [0.05, 0.001])
def test_a_small_range_is_served_no_worse_than_by_simple_grids(reach: float) -> None:
    """Where all are as good as each other "best" is one of them, to the bit."""
    setting = ("chair", "aside", reach, 64)
    figures = never_worse.measure(setting)
    worse = [(way, what, by) for way, what, by in never_worse.behind(figures) if way != "nearest"]
    assert all(by < 2e-3 for _, _, by in worse), figures


# --- What is said ----------------------------------------------------------------------------------------------------


def test_what_was_chosen_is_part_of_the_maps(tmp_path: Path) -> None:
    made = prepare(scene(), params(), controls="fast")
    placed = made.choice
    assert placed is not None
    assert (placed.asked, placed.interpolation, placed.places) == ("fast", "linear", 32)
    assert {"bounds", "identity", "nearest of the nine maps"} <= {r.name for r in (placed.chosen, *placed.others)}
    assert placed.chosen.mean >= max(r.mean for r in placed.others if r.name in ("bounds", "identity")) - 1e-12
    assert abs(quality(scene(), params(), made) - placed.chosen.mean) < 0.04
    made.save(tmp_path / "maps.npz")
    assert Maps.load(tmp_path / "maps.npz").choice == placed
    assert prepare(scene(), params(), controls="bounds").choice is None


DAMAGED: list[Any] = [
    "", "{}", "[]", '{"asked": "fast"}', "null",
    '{"asked": "fast", "interpolation": "linear", "places": 32, "chosen": ["a", 2.0, 0.5], "others": []}',
    '{"asked": "fast", "interpolation": "linear", "places": 0, "chosen": ["a", 0.6, 0.5], "others": []}',
    '{"asked": "fast", "interpolation": "linear", "places": 32, "chosen": [1, 0.6, 0.5], "others": []}',
    '{"asked": "fast", "interpolation": "linear", "places": 32, "chosen": ["a", 0.6, 0.5], "others": 3}',
]  # fmt: skip


@pytest.mark.parametrize("text", DAMAGED, ids=range(len(DAMAGED)))
def test_a_placement_that_is_none_is_named(text: str) -> None:
    with pytest.raises(ValueError, match="choice"):
        Placement.read(text)


def test_a_placement_as_text_comes_back() -> None:
    placed = Placement(
        asked="best",
        interpolation="projective",
        places=128,
        chosen=Reach("bounds", 0.1 + 0.2, 1 / 3),
        others=(Reach("identity", 0.25, 0.0),),
    )
    assert Placement.read(placed.text) == placed
