"""Welsh 2004 against its formula in world vectors."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref import BasePolygon, Camera
from tests.displacement.below import VIEWS, Map, check, compared, polygons, world_axes
from tests.displacement.scenes import SCALE, camera, frame, square


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize("polygon", polygons().values(), ids=polygons())
def test_the_offset_is_the_height_along_the_eye_s_direction(polygon: BasePolygon, view: Camera) -> None:
    """H s w, without its part along the normal, in edges of the polygon."""
    result, rays = compared(polygon, view, "welsh")
    height_map, (_, edge_u, edge_v, normal) = Map(polygon), world_axes(polygon)
    expected = {}
    for pixel, ray in rays.items():
        along = ray.to_eye - (ray.to_eye @ normal) * normal
        offset = np.linalg.lstsq(np.array([edge_u, edge_v]).T, along, rcond=None)[0]
        uv = ray.c + height_map.height(ray.c) * polygon.height_scale * offset
        expected[pixel] = (uv, 0.0) if height_map.there(uv) else None
    check(result, expected, least=40)


def test_the_offset_never_exceeds_the_height() -> None:
    """Its limit: at a grazing angle too, where the true parallax is many times the height."""
    result, rays = compared(square(np.full((2, 2), 0.8)), VIEWS["grazing"], "welsh")
    moved = [
        np.linalg.norm(result.stages["march.hit"][pixel][:2] - ray.c)
        for pixel, ray in rays.items()
        if result.stages["march.hit_index"][pixel] >= 0
    ]
    assert 0.9 * 0.8 * SCALE < max(moved) < 0.8 * SCALE


def test_nothing_is_displaced() -> None:
    """The window depth is the polygon's."""
    polygon = square(np.full((2, 2), 0.8))
    welsh, texture = (frame(polygon, camera(), method=method) for method in ("welsh", "texture"))
    kept = welsh.stages["march.hit_index"] >= 0
    assert kept.sum() > 100
    assert (welsh.depth[kept] == frame(polygon, camera(), method="texture", depth="polygon").depth[kept]).all()
    assert (welsh.stages["march.fetches"] == (texture.stages["raster.face"] == 0)).all()
