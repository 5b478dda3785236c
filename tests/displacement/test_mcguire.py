"""McGuire 2005: the steps against a plain loop, the mip chain against means."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ibr_ref import BasePolygon, Camera
from ibr_ref.displacement.mcguire import levels_at, mip_chain
from tests.displacement.below import VIEWS, Below, Expected, Map, check, compared, polygons
from tests.displacement.scenes import camera, frame, noise, spike, square
from tests.pipeline.texels import bilinear, lerp


def steps_down(ray: Below, height_map: Map, steps: int, bias: float) -> tuple[Expected, int]:
    """The hit and the samples taken."""
    chain = mip_chain(height_map.heights)
    fine = min(math.floor(bias), len(chain) - 1)
    coarse = min(fine + 1, len(chain) - 1)
    count = math.floor(lerp(2.0 * steps, steps, ray.cosine) + 0.5)
    for k in range(count + 1):
        p = ray.at(k / count)
        if not height_map.there(p):
            return None, k
        heights = [bilinear(chain[level], *p.tolist(), height_map.repeat) for level in (fine, coarse)]
        if k / count >= 1.0 - lerp(heights[0], heights[1], min(bias, len(chain) - 1.0) - fine):
            return (p, k / count), k + 1
    raise AssertionError("the last sample is at depth 1")


@pytest.mark.parametrize("bias", [0.0, 0.75, 2.0, 30.0])
@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize("polygon", polygons().values(), ids=polygons())
def test_hits_and_fetches_are_those_of_a_plain_loop(polygon: BasePolygon, view: Camera, bias: float) -> None:
    result, rays = compared(polygon, view, "mcguire", linear_steps=7, lod_bias=bias)
    walks = {pixel: steps_down(ray, Map(polygon), 7, bias) for pixel, ray in rays.items()}
    check(result, {pixel: hit for pixel, (hit, _) in walks.items()}, least=20)
    clear = result.stages["march.margin"] > 1e-9
    assert all(result.stages["march.fetches"][pixel] == n for pixel, (_, n) in walks.items() if clear[pixel])


@pytest.mark.parametrize("shape", [(8, 16), (7, 5), (1, 1), (1, 9), (13, 2)])
def test_levels_keep_the_mean_and_end_at_one_texel(shape: tuple[int, int]) -> None:
    image = noise(*shape)
    chain = mip_chain(image)
    assert [level.shape for level in chain[1:]] == [
        (max(1, shape[0] >> k), max(1, shape[1] >> k)) for k in range(1, len(chain))
    ]
    assert chain[-1].shape == (1, 1)
    assert all(level.mean() == pytest.approx(image.mean(), abs=1e-15) for level in chain)


def test_a_level_of_an_even_map_is_the_mean_of_two_by_two() -> None:
    image = noise(4, 6)
    assert np.allclose(mip_chain(image)[1], image.reshape(2, 2, 3, 2).mean(axis=(1, 3)), atol=1e-16)


def test_a_texel_of_an_odd_map_s_half_is_the_mean_of_what_it_covers() -> None:
    """Three to one: 2.5 texels of five each."""
    assert np.allclose(
        mip_chain(np.array([[1.0, 0.5, 0.25, 0.0, 1.0]]))[1], [[(1 + 0.5 + 0.125) / 2.5, (0.125 + 1) / 2.5]]
    )


def test_levels_beyond_the_last_are_the_last() -> None:
    fine, coarse, share = levels_at(mip_chain(noise(4, 4)), 30.0)
    assert (fine.texels.size, coarse.texels.size, share) == (1, 1, 0.0)


@pytest.mark.parametrize(("bias", "highest"), [(0.0, 1.0), (1.0, 0.25), (2.0, 0.0625), (1.5, 0.15625)])
def test_a_bias_lowers_what_it_blurs(bias: float, highest: float) -> None:
    """A spike of one texel has a quarter of its height a level on: the bias does not find it, it takes it away."""
    view = camera(eye=(0.9, -0.1, 0.6), target=(0.5, 0.5, -0.15), vertical_fov=24.0, width=160, height=120)
    result = frame(square(spike(64, 64, 32, 32, 1.0)), view, method="mcguire", linear_steps=400, lod_bias=bias)
    found = 1.0 + np.nanmax(result.stages["march.hit"][..., 2])
    assert 0.5 * highest < found <= highest
