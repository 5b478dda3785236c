"""Automatic control points: no folds, the border on the border, the same bits twice, nearer than what they start from."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from ibr_ref import models
from ibr_ref.shadows import Maps, Params, Scene, automatic, controls, folds, prepare
from tests.shadows.quality import map_quality
from tests.shadows.scenes import box, light, params, scene

QUALITIES = sorted(automatic.RECIPES)
SMALL = Params(map_size=64, rows=9, columns=5)


@cache
def chair() -> Scene:
    return models.shadow_stage(models.chair())


@cache
def chair_maps(quality: str) -> Maps:
    return prepare(chair(), SMALL, controls=quality)


def at_offsets(count: int) -> list[Scene]:
    return [replace(chair(), offset=o) for o in np.random.RandomState(5).uniform(-0.6, 0.6, (count, 2))]


def assert_valid(points: Any, size: int) -> None:
    """On the map, its border on the map's, on the lattice, unfolded in the nine grids and at places between them.

    Points are off the lattice only where they would fold on it.
    """
    assert np.array_equal(automatic.snapped(points, size), points)
    for border in (points[:, :, 0], points[:, :, -1], points[:, :, :, 0], points[:, :, :, -1]):
        first = border[0, 0, 1:-1] if border.shape[2] > 2 else border[0, 0]
        axis = [d for d in range(2) if np.isin(first[:, d], (0.0, 1.0)).all()]
        assert any((border[..., d] == border[0, 0, 0, d]).all() for d in axis)
    random = np.random.RandomState(1)
    for j in range(2):
        for i in range(2):
            for s, t in (*random.random_sample((20, 2)), (0, 0), (1, 0), (0, 1), (1, 1)):
                top, bottom = (points[j + k, i] * (1 - s) + points[j + k, i + 1] * s for k in range(2))
                assert controls.folded(top * (1 - t) + bottom * t) is None


@pytest.mark.parametrize("quality", QUALITIES)
def test_registered_points_are_valid(quality: str) -> None:
    assert_valid(chair_maps(quality).controls, 64)


def test_registration_brings_maps_nearer_to_the_rendered_ones() -> None:
    scenes = at_offsets(24)
    found = {
        name: map_quality(scenes, SMALL, prepare(chair(), SMALL, controls=name)) for name in ("identity", "bounds")
    }
    found |= {name: map_quality(scenes, SMALL, chair_maps(name)) for name in QUALITIES}
    means = {name: mean for name, (mean, _) in found.items()}
    assert means["identity"] < means["bounds"], found
    assert min(means["fast"], means["best"]) > means["bounds"] + 0.01, found


@pytest.mark.parametrize("quality", QUALITIES)
def test_the_same_bits_twice(quality: str) -> None:
    again = prepare(chair(), SMALL, controls=quality).controls
    assert again.tobytes() == chair_maps(quality).controls.tobytes()


def test_controls_do_not_depend_on_what_the_maps_hold() -> None:
    """They are those of the silhouette; depths have the same."""
    deep = prepare(chair(), replace(SMALL, content="depth"), controls="fast")
    assert deep.controls.tobytes() == chair_maps("fast").controls.tobytes()


@pytest.mark.long
@pytest.mark.parametrize(
    ("size", "rows", "columns"), [(8, 2, 2), (8, 15, 5), (16, 2, 7), (9, 6, 2), (24, 3, 3), (32, 40, 3)]
)
def test_small_maps_and_few_points(size: int, rows: int, columns: int) -> None:
    small = Params(map_size=size, rows=rows, columns=columns)
    for quality in QUALITIES:
        made = prepare(scene(), small, controls=quality).controls
        assert made.shape == (3, 3, rows, columns, 2)
        assert_valid(made, size)


def test_an_area_light_is_trained_for_the_widened_range() -> None:
    made = prepare(chair(), replace(SMALL, light_samples=9), controls="fast")
    assert made.lines[0][0] < -0.6
    assert_valid(made.controls, 64)
    assert made.controls.tobytes() != chair_maps("fast").controls.tobytes()


def test_without_a_silhouette_in_some_maps_points_are_registered_all_the_same() -> None:
    """The light looks away from the caster at some of the nine places; regular grids are one of the choices."""
    aside = scene(light=light(vertical_fov=8.0), caster=box(0.1), offset_range=((-2.0, 2.0), (-2.0, 2.0)))
    for quality in QUALITIES:
        made = prepare(aside, params(), controls=quality)
        assert not made.texels[0, 0].any()
        assert_valid(made.controls, 64)
        placed = made.choice
        assert placed is not None
        assert placed.chosen.mean >= max(other.mean for other in placed.others if other.name == "identity")


def test_where_no_map_has_a_silhouette_points_are_simple() -> None:
    """Nothing to register, and nothing that could be wrong."""
    away = scene(light=light(target=(0.0, 0.0, 9.0), half_edges=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))))
    for quality in QUALITIES:
        made = prepare(away, params(), controls=quality)
        assert not made.texels.any()
        assert_valid(made.controls, 64)
        assert made.choice is not None
        assert made.choice.chosen.mean == 1.0


@pytest.mark.long
def test_grids_of_very_many_points_are_placed_simply() -> None:
    many = params(map_size=32, rows=90, columns=50)
    made = prepare(scene(), many, controls="best")
    assert made.choice is not None
    tried = (made.choice.chosen, *made.choice.others)
    assert not any("registered" in reach.name for reach in tried)
    assert made.choice.chosen.mean >= max(r.mean for r in tried if r.name in ("bounds", "identity"))


def test_progress_goes_on_to_its_end() -> None:
    said: list[tuple[str, int, int]] = []
    prepare(scene(), params(), controls="fast", progress=lambda what, done, total: said.append((what, done, total)))
    done = [d for _, d, _ in said]
    assert done == sorted(done)
    assert {total for _, _, total in said} == {said[-1][1]}
    assert all(what.startswith("control points") for what, _, _ in said)


# --- A quarter turn --------------------------------------------------------------------------------------------------


def test_a_turned_grid_covers_the_map_with_rows_across() -> None:
    points = controls.turned(np.broadcast_to(controls.regular(3, 4), (3, 3, 3, 4, 2)))[0, 0]
    assert points.shape == (4, 3, 2)
    assert np.allclose(points[0, 0], (0.0, 1.0))
    assert np.allclose(points[-1, 0], (1.0, 1.0))
    assert np.allclose(points[0, -1], (0.0, 0.0))
    assert controls.folded(points) is None


# --- Folds -----------------------------------------------------------------------------------------------------------


def test_bernstein_coefficients_are_those_of_the_area() -> None:
    """At any s and t, for any corners."""
    random = np.random.RandomState(3)
    corners = random.random_sample((50, 4, 3, 2))
    found = folds.coefficients(corners).reshape(50, 3, 3)
    for s, t in random.random_sample((5, 2)):
        weights = np.array([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t])
        p = np.einsum("k,ekad->ead", weights, corners)
        e, f = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
        along = [np.array([(1 - x) ** 2, 2 * x * (1 - x), x**2]) for x in (t, s)]
        area = np.einsum("emn,m,n->e", found, *along)
        np.testing.assert_allclose(area, e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0], atol=1e-14)


def swirl(points: Any, angle: float) -> Any:
    """Grids turned by an angle in the middle, and less and less outwards."""
    x, y = np.moveaxis(points - 0.5, -1, 0)
    turn = angle * np.maximum(0.0, 1.0 - np.hypot(x, y) / 0.5)
    return 0.5 + np.stack([x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)], axis=-1)


def test_a_fold_between_unfolded_grids_is_found() -> None:
    """Turned one way in one map and the other way in the next: in between the middle is inside out."""
    points = np.array(np.broadcast_to(controls.regular(31, 31), (3, 3, 31, 31, 2)))
    assert folds.unfolded(points)
    turned = points.copy()
    turned[:, 0], turned[:, 1] = swirl(points[:, 0], 1.8), swirl(points[:, 1], -1.8)
    assert all(controls.folded(grid) is None for line in turned for grid in line)
    assert controls.folded((turned[0, 0] + turned[0, 1]) / 2) is not None
    assert not folds.unfolded(turned)


def test_the_barrier_s_slope() -> None:
    random = np.random.RandomState(4)
    corners = np.broadcast_to([(0.1, 0.1), (0.6, 0.2), (0.5, 0.7)], (2, 4, 3, 2)) + random.uniform(
        -0.05, 0.05, (2, 4, 3, 2)
    )
    matrix, gradient = np.zeros((2, 24, 24)), np.zeros((2, 24))
    folds.add_barrier(corners, 0.01, 0.5, matrix, gradient)
    step = 1e-6
    for i in range(24):
        ends = []
        for sign in (-1.0, 1.0):
            moved = corners.copy().reshape(2, 24)
            moved[1, i] += sign * step
            ends.append(folds.barrier(moved.reshape(corners.shape), 0.01, 0.5))
        assert gradient[1, i] == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-5, abs=1e-7)
    assert np.array_equal(matrix[1], matrix[1].T)
    assert folds.barrier(corners, 1.0, 0.5) == np.inf
