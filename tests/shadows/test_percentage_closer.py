"""Percentage-closer soft shadows: exact between parallel planes; otherwise as Fernando's three steps, written out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ibr_ref.shadows import Scene, SoftParams, render_soft
from ibr_ref.shadows.lattice import lattice
from ibr_ref.shadows.parallel import window_around
from ibr_ref.shadows.render import surface_of
from ibr_ref.shadows.soft import frame_of
from ibr_ref.shadows.vertex import place
from tests.shadows.planes import dart, soft_shadow_by, tilted_scene
from tests.shadows.scenes import Array, box, scene
from tests.shadows.test_soft_light import hidden_share, plate_over_floor


def test_between_parallel_planes_it_is_the_closed_form() -> None:
    truth = hidden_share(plate_over_floor())
    found = soft_shadow_by(plate_over_floor(), method="pcss", map_size=1024, search_points=610, filter_points=610)
    difference = np.abs(found - truth)
    assert difference.max() < 0.015
    assert difference.mean() < 2e-3


def test_any_shapes_in_parallel_planes() -> None:
    seen = tilted_scene(dart())
    truth = soft_shadow_by(seen, rays=4181)
    found = soft_shadow_by(seen, method="pcss", map_size=1024, search_points=987, filter_points=987)
    assert np.abs(found - truth).max() < 0.015


def test_the_map_holds_distances_from_the_lights_plane() -> None:
    """A plate 4 below the light; a cube from 3.6 to 4.4, of which the light sees the top alone."""
    for caster, distance in ((dart(), 4.0), (box(0.4), 3.6)):
        found = np.asarray(render_soft(tilted_scene(caster), SoftParams(method="pcss")).stages["soft.map"])
        seen = found[found < np.inf]
        assert seen.size > 1000
        assert np.median(seen) == pytest.approx(distance, abs=1e-9)
        assert seen.min() == pytest.approx(distance, abs=1e-9)


def plain(seen: Scene, params: SoftParams, distances: Array, world: Array) -> float:
    """The share for one point of the floor, from the map, by the steps and names of the paper."""
    size = len(distances)
    caster = place(np.asarray(seen.caster.vertices), seen.axes, np.asarray(seen.offset))
    frame = frame_of(seen, caster.mean(axis=0))
    x, y, z, _ = frame.view_from_world @ (*world, 1.0)
    d_receiver = -z
    window = window_around(frame, caster, d_receiver)

    def region(at_distance: float, count: int) -> Array:
        """Where the rays from the point to the light cross a plane parallel to it, as texture coordinates (u, v)."""
        lights = lattice(count) @ frame.half_edges
        crossing = lights + (np.array([x, y]) - lights) * (at_distance / d_receiver)
        places = crossing / at_distance
        low, high = window.low, window.high
        return np.stack(
            [(places[:, 0] - low[0]) / (high[0] - low[0]), (high[1] - places[:, 1]) / (high[1] - low[1])], axis=1
        )

    blockers = []
    for u, v in region(window.near, params.search_points):
        texel = distances[min(int(v * size), size - 1), min(int(u * size), size - 1)]
        if texel < d_receiver - params.bias:
            blockers.append(texel)
    if not blockers:
        return 0.0
    total = 0.0
    for u, v in region(float(np.mean(blockers)), params.filter_points):
        column, row = u * size - 0.5, v * size - 0.5
        i, j = math.floor(column), math.floor(row)
        for dj in (0, 1):
            for di in (0, 1):
                weight = abs(1 - di - (column - i)) * abs(1 - dj - (row - j))
                inside = distances[min(max(j + dj, 0), size - 1), min(max(i + di, 0), size - 1)]
                total += weight * (inside < d_receiver - params.bias)
    return total / params.filter_points


@pytest.mark.parametrize("bias", [0.0, 1e-3])
def test_the_three_steps_written_out(bias: float) -> None:
    """Of a box, which has blockers at many distances; the floor is at one, so that all pixels have the same window."""
    seen = tilted_scene(box(0.3), size=14)
    params = SoftParams(method="pcss", map_size=96, search_points=23, filter_points=31, bias=bias)
    frame = render_soft(seen, params)
    found, distances = np.asarray(frame.stages["soft.shadow"]), np.asarray(frame.stages["soft.map"])
    world = surface_of(seen).varyings
    expected = [[plain(seen, params, distances, point) for point in row] for row in world]
    assert ((found > 0) & (found < 1)).mean() > 0.15
    assert np.abs(found - expected).max() < 1e-9


def test_without_a_blocker_there_is_light() -> None:
    frame = render_soft(scene(), SoftParams(method="pcss"))
    blocker, shadow = np.asarray(frame.stages["soft.blocker"]), np.asarray(frame.stages["soft.shadow"])
    assert not shadow[np.isinf(blocker)].any()
    assert shadow[blocker < np.inf].max() == 1.0
    assert (blocker[blocker < np.inf] >= 3.6 - 1e-9).all()
