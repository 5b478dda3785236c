"""Percentage-closer soft shadows: exact between parallel planes; otherwise as Fernando's three steps, written out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest

from ibr_ref.io import Frame
from ibr_ref.shadows import Params, Scene, prepare, render
from ibr_ref.shadows.lattice import lattice
from ibr_ref.shadows.light_map import frame_of, map_of
from ibr_ref.shadows.parallel import to_distance, window_around
from ibr_ref.shadows.render import surface_of
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


def distances_in(seen: Scene, params: Params, frame: Frame) -> Array:
    """(S, S) from the light's plane, infinite where the caster is not."""
    return to_distance(np.asarray(frame.stages["warp.image"]), map_of(seen)[1])


def test_the_map_is_one_of_distances_from_the_lights_plane() -> None:
    """A plate 4 below the light; a cube from 3.6 to 4.4, of which the light sees the top alone."""
    params = Params(method="pcss", map_size=128)
    for caster, distance in ((dart(), 4.0), (box(0.4), 3.6)):
        seen = tilted_scene(caster)
        found = distances_in(seen, params, render(seen, params))
        shown = found[found < np.inf]
        assert shown.size > 1000
        assert np.median(shown) == pytest.approx(distance, abs=1e-9)
        assert shown.min() == pytest.approx(distance, abs=1e-9)


class Plain(NamedTuple):
    """One point of the floor, by the steps and names of the paper."""

    shadow: float
    blocker: float
    margin: float
    texel_margin: float


def plain(seen: Scene, params: Params, distances: Array, world: Array) -> Plain:
    """From the map of distances."""
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

    across, up = np.array([x, y]) / d_receiver
    if not (window.low[0] <= across <= window.high[0] and window.low[1] <= up <= window.high[1]):
        return Plain(0.0, 0.0, math.inf, math.inf)
    blockers, margins, edges = [], [], []
    for u, v in region(window.near, params.search_points):
        if not (0.0 <= u <= 1.0 and 0.0 <= v <= 1.0):
            continue
        texel = distances[min(int(v * size), size - 1), min(int(u * size), size - 1)]
        margins.append(abs(texel - (d_receiver - params.bias)))
        edges += [abs(u * size - round(u * size)), abs(v * size - round(v * size))]
        if texel < d_receiver - params.bias:
            blockers.append(texel)
    if not blockers:
        return Plain(0.0, 0.0, min(margins), min(edges))
    total, blocker = 0.0, float(np.mean(blockers))
    for u, v in region(blocker, params.filter_points):
        column, row = u * size - 0.5, v * size - 0.5
        i, j = math.floor(column), math.floor(row)
        for dj in (0, 1):
            for di in (0, 1):
                weight = abs(1 - di - (column - i)) * abs(1 - dj - (row - j))
                texel = distances[min(max(j + dj, 0), size - 1), min(max(i + di, 0), size - 1)]
                total += weight * (texel < d_receiver - params.bias)
                margins.append(abs(texel - (d_receiver - params.bias)))
    return Plain(total / params.filter_points, blocker, min(margins), min(edges))


@pytest.mark.parametrize("bias", [0.0, 1e-3])
def test_the_three_steps_written_out(bias: float) -> None:
    """Of a box, which has blockers at many distances; the floor is at one, so that all pixels have the same window."""
    seen = tilted_scene(box(0.3), size=14)
    params = Params(method="pcss", map_size=96, search_points=23, filter_points=31, bias=bias)
    frame = render(seen, params)
    stages = {name: np.asarray(array) for name, array in frame.stages.items()}
    world, distances = surface_of(seen).varyings, distances_in(seen, params, frame)
    expected = [[plain(seen, params, distances, point) for point in row] for row in world]
    found = stages["project.shadow"]
    assert ((found > 0) & (found < 1)).mean() > 0.15
    for name in Plain._fields:
        theirs = np.array([[getattr(each, name) for each in row] for row in expected])
        np.testing.assert_allclose(stages[f"project.{name}"], theirs, atol=1e-9, err_msg=name)
    blocked, r = stages["project.blocker"] > 0.0, stages["project.coord"][..., 2]
    scale = 1.0 / stages["project.blocker"][blocked] - 1.0 / r[blocked]
    np.testing.assert_allclose(stages["project.penumbra"][blocked], scale, atol=1e-12)
    assert np.array_equal(stages["accumulate.shadow"], found)


def test_without_a_blocker_there_is_light() -> None:
    stages = render(scene(), Params(method="pcss")).stages
    blocker, shadow = np.asarray(stages["project.blocker"]), np.asarray(stages["project.shadow"])
    assert not shadow[blocker == 0.0].any()
    assert not np.asarray(stages["project.penumbra"])[blocker == 0.0].any()
    assert shadow[blocker > 0.0].max() == 1.0
    assert (blocker[blocker > 0.0] >= 3.6 - 1e-9).all()


def test_bands_are_those_of_the_whole_picture() -> None:
    """The map does not depend on what is seen."""
    params = Params(method="pcss", map_size=64)
    whole, band = render(scene(), params), render(scene(), params, rows=(20, 31))
    np.testing.assert_array_equal(whole.color[20:31], band.color)
    assert render(scene(), params, stages=False).stages == {}


def test_what_goes_with_one_map() -> None:
    with pytest.raises(ValueError, match='light_samples: found 5, allowed: 1 with method="pcss"'):
        Params(method="pcss", light_samples=5)
    assert Params(method="pcss").content == "depth"
    with pytest.raises(ValueError, match="maps: found 'Maps', allowed: None with method=\"pcss\""):
        render(scene(), Params(method="pcss"), maps=prepare(scene(), Params(map_size=16), controls="identity"))
