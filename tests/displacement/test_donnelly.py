"""Donnelly 2005: distances against all pairs of voxels, steps against a plain loop, and where a plane is found."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ibr_ref import BasePolygon, Camera
from ibr_ref.displacement.donnelly import distance_texture
from tests.displacement.below import VIEWS, Map, check, compared, polygons
from tests.displacement.scenes import Array, camera, noise, square
from tests.pipeline.texels import bilinear, lerp


def all_distances(heights: Array, layers: int, repeat: bool) -> Array:
    """From every voxel's centre to that of the nearest one that the solid reaches into, in units of the whole map."""
    rows, columns = heights.shape
    d, v, u = np.meshgrid(*((np.arange(n) + 0.5) / n for n in (layers, rows, columns)), indexing="ij")
    solid = d + 0.5 / layers >= 1.0 - heights
    across, along = (np.abs(x[..., None] - x[solid]) for x in (u, v))
    if repeat:
        across, along = np.minimum(across, 1 - across), np.minimum(along, 1 - along)
    distances: Array = np.sqrt(across**2 + along**2 + (d[..., None] - d[solid]) ** 2).min(axis=-1)
    return distances


@pytest.mark.parametrize("repeat", [False, True])
@pytest.mark.parametrize("shape", [(6, 9), (1, 5), (7, 1)])
def test_distances_are_the_smallest_of_all(shape: tuple[int, int], repeat: bool) -> None:
    heights = noise(*shape) ** 3
    heights[0, 0] = 1.0
    ours = distance_texture(heights, 5, repeat)
    assert ours.shape == (5, *shape)
    assert np.allclose(ours, all_distances(heights, 5, repeat), atol=1e-12)


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize("polygon", polygons().values(), ids=polygons())
def test_hits_are_those_of_a_plain_loop(polygon: BasePolygon, view: Camera) -> None:
    layers, steps = 6, 9
    result, rays = compared(polygon, view, "donnelly", linear_steps=steps, distance_layers=layers)
    height_map = Map(polygon)
    texture = all_distances(height_map.heights, layers, height_map.repeat)
    expected = {}
    for pixel, ray in rays.items():
        p, direction = np.array([*ray.c, 0.0]), np.array([*-ray.slope, 1.0])
        direction /= np.linalg.norm(direction)
        for _ in range(steps):
            z = min(max(p[2] * layers - 0.5, 0.0), layers - 1.0)
            upper = math.floor(z)
            distances = [
                bilinear(texture[i], p[0], p[1], height_map.repeat) for i in (upper, min(upper + 1, layers - 1))
            ]
            p = p + lerp(distances[0], distances[1], z - upper) * direction
        expected[pixel] = (p[:2], min(p[2], 1.0)) if height_map.there(p[:2]) else None
    clear = {pixel: hit for pixel, hit in expected.items() if hit is None or np.abs(hit[0] - 0.5).max() < 0.5 - 1e-9}
    check(result, clear, least=40)
    assert set(np.unique(result.stages["march.fetches"])) == {0, steps}


def test_a_plane_is_found_within_a_layer() -> None:
    """D = 0.4, layers of 0.1: voxels are solid from the one that ends at 0.4, whose centre is 0.35, on."""
    result, _ = compared(square(np.full((8, 8), 0.6 + 1e-9)), camera(), "donnelly", linear_steps=60, distance_layers=10)
    depth = -result.stages["march.hit"][..., 2]
    assert np.isfinite(depth).sum() > 200
    assert np.nanmax(np.abs(depth - 0.35)) < 1e-3
