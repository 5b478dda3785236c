"""Cone maps against all pairs of texels; cone steps and relaxed cone steps against plain loops."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ibr_ref import BasePolygon, Camera
from ibr_ref.displacement.cones import cone_map
from tests.displacement.below import VIEWS, Below, Map, check, compared, polygons
from tests.displacement.scenes import Array, block, camera, noise, spike, square
from tests.pipeline.texels import bilinear

MAPS = {
    "noise": noise(11, 14),
    "few heights": np.round(noise(9, 9) * 3) / 3,
    "a box": block(20, 20, 7, 13, 0.9),
    "a spike": spike(17, 9, 8, 4, 1.0),
    "one texel": np.full((1, 1), 0.5),
}


def frozen(heights: Array) -> Array:
    copy = np.array(heights)
    copy.setflags(write=False)
    return copy


def way_out(heights: Array, repeat: bool, here: Array, height: float, there: Array, top: float) -> float:
    """The ratio of the authors' shader, its 127 steps without any leaving early."""
    depth = max(1.0 - top, 1.0 / 255.0)
    slope = (there - here) / depth
    d = depth + (1.0 - depth) / 128
    for _ in range(1, 128):
        p = here + slope * d
        inside = (repeat or bool(((p >= 0) & (p <= 1)).all())) and bilinear(heights, *p.tolist(), repeat) >= 1.0 - d
        if not inside:
            break
        d += (1.0 - depth) / 128
    rise = (1.0 - d) - height
    return float(np.linalg.norm(slope * d) / rise) if rise > 0 else 1.0


def all_cones(heights: Array, repeat: bool, relaxed: bool) -> Array:
    """Every texel against every other, of the map and of its eight neighbours where it repeats."""
    rows, columns = heights.shape
    shifts = range(-1, 2) if repeat else range(1)
    ratios = np.ones(heights.shape)
    for i, j, k, m in np.ndindex(rows, columns, rows, columns):
        height, top = heights[i, j], heights[k, m]
        if not top > height:
            continue
        here = np.array([(j + 0.5) / columns, (i + 0.5) / rows])
        for x in shifts:
            for y in shifts:
                there = np.array([(m + 0.5) / columns + x, (k + 0.5) / rows + y])
                ratio = float(np.linalg.norm(there - here)) / (top - height)
                if relaxed and ratio < ratios[i, j]:
                    ratio = way_out(heights, repeat, here, height, there, top)
                ratios[i, j] = min(ratios[i, j], ratio)
    return ratios


@pytest.mark.parametrize("repeat", [False, True])
@pytest.mark.parametrize("relaxed", [False, True])
@pytest.mark.parametrize("name", MAPS)
def test_ratios_are_the_smallest_of_all(name: str, relaxed: bool, repeat: bool) -> None:
    ours, all_pairs = cone_map(frozen(MAPS[name]), repeat, relaxed), all_cones(MAPS[name], repeat, relaxed)
    assert np.abs(ours - all_pairs).max() < 1e-9


def test_a_relaxed_cone_is_never_narrower() -> None:
    plain, relaxed = (cone_map(frozen(MAPS["a box"]), False, wide) for wide in (False, True))
    assert (relaxed >= plain).all()
    assert (relaxed > 1.5 * plain).sum() > 50


def cone_depth(ray: Below, height_map: Map, ratios: Array, steps: int) -> float:
    """Where the ray leaves each cone: at the distance c (g - x) from its axis, x below the start."""
    d, speed = 0.0, float(np.linalg.norm(ray.slope))
    for _ in range(steps):
        p = ray.at(d)
        gap = max(0.0, 1.0 - height_map.height(p) - d)
        ratio = bilinear(ratios, *p.tolist(), height_map.repeat)
        d += gap / (1.0 + speed / ratio)
    return d


def halved(ray: Below, height_map: Map, d: float, halvings: int) -> float:
    """The middle of what is left of [0, d]."""
    low, high = 0.0, d
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        inside = height_map.there(ray.at(middle)) and middle >= 1.0 - height_map.height(ray.at(middle))
        low, high = (low, middle) if inside else (middle, high)
    return 0.5 * (low + high)


@pytest.mark.parametrize("method", ["cone", "relaxed_cone"])
@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize("polygon", polygons().values(), ids=polygons())
def test_hits_are_those_of_a_plain_loop(polygon: BasePolygon, view: Camera, method: str) -> None:
    result, rays = compared(polygon, view, method, linear_steps=8, binary_steps=5)
    height_map, relaxed = Map(polygon), method == "relaxed_cone"
    ratios = cone_map(frozen(height_map.heights), height_map.repeat, relaxed)
    expected = {}
    for pixel, ray in rays.items():
        d = cone_depth(ray, height_map, ratios, 8)
        d = halved(ray, height_map, d, 5) if relaxed else d
        expected[pixel] = (ray.at(d), d) if height_map.there(ray.at(d)) else None
    clear = {pixel: hit for pixel, hit in expected.items() if hit is None or np.abs(hit[0] - 0.5).max() < 0.5 - 1e-9}
    check(result, clear, least=40)
    assert set(np.unique(result.stages["march.fetches"])) == {0, 13 if relaxed else 8}


def test_cone_steps_do_not_pass_a_smooth_surface() -> None:
    """A dome of 64 x 64 texels: more and more steps come near the first intersection, and never behind it."""
    x = (np.arange(64) + 0.5) / 64 - 0.5
    polygon = square(np.clip(0.9 - 3.0 * (x[:, None] ** 2 + x**2), 0.0, 1.0))
    first = -compared(polygon, camera(), "maximum_mipmap")[0].stages["march.hit"][..., 2]
    before = math.inf
    for steps in (4, 16, 64):
        short = first + compared(polygon, camera(), "cone", linear_steps=steps)[0].stages["march.hit"][..., 2]
        assert np.nanmin(short) > -2e-3
        assert np.nanmax(short) < before
        before = float(np.nanmax(short))
    assert before < 1e-2
