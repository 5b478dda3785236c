"""Tatarchuk 2005: against a plain loop, and where its secant is exact."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref import BasePolygon, Camera
from tests.displacement.below import VIEWS, Below, Expected, Map, check, compared, polygons
from tests.displacement.scenes import square


def search(ray: Below, height_map: Map, least: int, most: int) -> Expected:
    """The hit, by the intersection of two straight lines given by two points each."""
    count = int(most + (least - most) * ray.cosine)
    before = 1.0
    for k in range(1, count + 1):
        p = ray.at(k / count)
        if not height_map.there(p):
            return None
        height = height_map.height(p)
        if height > 1.0 - k / count:
            gap_before, gap = before - (1.0 - (k - 1) / count), height - (1.0 - k / count)
            d = (k - 1 + gap_before / (gap_before - gap)) / count
            return (ray.at(d), d) if height_map.there(ray.at(d)) else None
        before = height
    return (ray.at(1.0), 1.0) if height_map.there(ray.at(1.0)) else None


@pytest.mark.parametrize(("least", "most"), [(8, 50), (1, 3), (5, 5)])
@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize("polygon", polygons().values(), ids=polygons())
def test_hits_are_those_of_a_plain_loop(polygon: BasePolygon, view: Camera, least: int, most: int) -> None:
    result, rays = compared(polygon, view, "tatarchuk", min_steps=least, max_steps=most)
    check(result, {pixel: search(ray, Map(polygon), least, most) for pixel, ray in rays.items()}, least=20)


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
def test_on_a_plane_few_steps_are_exact(view: Camera) -> None:
    """Heights h = 0.2 + 0.5 u between texel centres: the ray C - d a meets 1 - d = 0.2 + 0.5 (C_u - d a_u)."""
    heights = 0.2 + 0.5 * (np.arange(64) + 0.5)[None] / 64
    result, rays = compared(square(heights), view, "tatarchuk", min_steps=4, max_steps=6)
    checked = 0
    for pixel, ray in rays.items():
        d = (0.8 - 0.5 * ray.c[0]) / (1.0 - 0.5 * ray.slope[0])
        step = 1.0 / int(6 - 2 * ray.cosine)
        ends = [ray.at(np.floor(d / step) * step), ray.at(np.ceil(d / step) * step)]
        if d > step and all(1 / 128 < p[0] < 1 - 1 / 128 and 0 < p[1] < 1 for p in ends):
            checked += 1
            assert result.stages["march.hit"][pixel][2] == pytest.approx(-d, abs=1e-12)
    assert checked > 60
