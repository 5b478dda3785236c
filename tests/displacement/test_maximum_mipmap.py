"""The quadtree's hits against the height field in rational numbers, its values against all texels."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from ibr_ref import BasePolygon, Camera
from ibr_ref.displacement.quadtree import build
from tests.displacement.below import VIEWS, Below, compared
from tests.displacement.height_field import Ray, first_inside, rational
from tests.displacement.scenes import Array, block, camera, frame, noise, spike, square

MAPS = {
    "noise": noise(13, 9),
    "a box": block(24, 24, 9, 15, 0.9),
    "a spike": spike(32, 17, 20, 8, 0.95),
    "a wide map": noise(1, 40),
    "one texel": np.full((1, 1), 0.5),
    "nothing": np.zeros((5, 5)),
    "all at the top": np.ones((4, 4)),
}

MOST_LINES = 60
"""Rays of a repeated map that cross more cells are left out: rational numbers are slow."""


def solid_ray(ray: Below, bounded: bool) -> Ray | None:
    """From the polygon, where h is 1 in the solid below it, to depth 1 or the map's border."""
    start, end = rational(np.array([*ray.c, 1.0])), rational(np.array([*ray.at(1.0), 0.0]))
    last = Fraction(1)
    for a, b in zip(start[:2], end[:2], strict=True):
        if bounded and a != b:
            last = min(last, max((0 - a) / (b - a), (1 - a) / (b - a)))
    return Ray(start, end, Fraction(0), last)


@pytest.mark.parametrize("domain", ["clip", "repeat"])
@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize("name", MAPS)
def test_hits_are_first_intersections(name: str, view: Camera, domain: str) -> None:
    heights = MAPS[name]
    result, rays = compared(square(heights, domain=domain), view, "maximum_mipmap")
    checked = 0
    for pixel, ray in list(rays.items())[::5]:
        if np.abs(ray.slope * heights.shape[::-1]).sum() > MOST_LINES:
            continue
        solid = solid_ray(ray, domain == "clip")
        t = first_inside(heights, solid, domain == "repeat")
        t = 1.0 if t is None and solid is not None and solid.last == 1 else t
        found = result.stages["march.hit"][pixel]
        checked += 1
        if t is None:
            assert result.stages["march.hit_index"][pixel] == -1
        else:
            assert found == pytest.approx([*ray.at(float(t)), -float(t)], abs=1e-9), pixel
    assert checked > 30


@pytest.mark.parametrize("repeat", [False, True])
@pytest.mark.parametrize("heights", MAPS.values(), ids=MAPS)
def test_every_node_holds_the_largest_of_its_texels(heights: Array, repeat: bool) -> None:
    """Cell (i, j) of the finest level lies between the texels i - 1 and i, j - 1 and j (repeated: i and i + 1)."""
    tree = build(heights, repeat)
    rows, columns = heights.shape
    for level, offset in enumerate(tree.offsets):
        for i, j in np.ndindex(int(tree.rows[level]), int(tree.columns[level])):
            size = 2**level
            if repeat:
                row, column = (
                    np.arange(i * size, min((i + 1) * size, rows) + 1),
                    np.arange(j * size, min((j + 1) * size, columns) + 1),
                )
                expected = heights[np.ix_(row % rows, column % columns)].max()
            else:
                row, column = np.arange(i * size - 1, (i + 1) * size), np.arange(j * size - 1, (j + 1) * size)
                expected = heights[np.ix_(np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1))].max()
            assert tree.values[offset + i * tree.columns[level] + j] == expected


def test_a_spike_costs_few_fetches() -> None:
    """On 512 x 512 texels with one spike most rays look at a handful of nodes, where a search by cells visits hundreds."""
    result, _ = compared(square(spike(512, 512, 300, 300, 0.9)), camera(width=96, height=72), "maximum_mipmap")
    covered = result.stages["raster.face"] == 0
    assert np.median(result.stages["march.fetches"][covered]) < 40


def fine_relief(polygon: BasePolygon) -> Array:
    found: Array = frame(polygon, camera(), method="relief", linear_steps=4096, binary_steps=8).stages["march.hit"]
    return found


def test_relief_mapping_with_many_steps_comes_to_the_same() -> None:
    polygon = square(noise(8, 8))
    ours = frame(polygon, camera(), method="maximum_mipmap").stages["march.hit"]
    kept = np.isfinite(ours[..., 2])
    assert kept.sum() > 150
    assert np.abs(ours - fine_relief(polygon))[kept].max() < 1e-5
