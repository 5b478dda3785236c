"""Light samples: more of them come nearer to the area light, in closed form and on real casters; the warp stays off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ibr_ref import models
from ibr_ref.scene import Camera
from ibr_ref.shadows import Scene, prepare
from tests.shadows.quality import Array, light_samples, soft_difference, soft_shadow
from tests.shadows.scenes import light, params, plate, scene

HALF_PLATE, HALF_LIGHT = 0.3, 0.4
BELOW = Camera.orthographic(
    eye=(0.1, 0.05, -0.5), target=(0.1, 0.05, -1.0), up=(0, 1, 0), view_height=1.2, near=0.1, far=5, width=60, height=60
)
"""The floor z = -1 as it is seen from under the caster."""


def plate_over_floor() -> Scene:
    """A square in z = 0 under a square light in z = 4 that looks down."""
    edges = ((HALF_LIGHT, 0.0, 0.0), (0.0, HALF_LIGHT, 0.0))
    lamp = light(vertical_fov=30.0, half_edges=edges)
    return scene(caster=plate(HALF_PLATE), light=lamp, camera=BELOW, offset=(0.1, 0.05))


def hidden_share(seen: Scene) -> Array:
    """(H, W) how much of the light the plate hides from each pixel's point of the floor: a product, as both are squares.

    The way to a point l of the light goes through 0.8 p + 0.2 l in the plate's plane.
    """
    size = seen.camera.width
    at = ((np.arange(size) + 0.5) / size - 0.5) * 1.2
    shares = []
    for p, c in ((at + 0.1, 0.1), (-at + 0.05, 0.05)):
        ends = [np.clip((c + side * HALF_PLATE - 0.8 * p) / 0.2, -HALF_LIGHT, HALF_LIGHT) for side in (-1, 1)]
        shares.append((ends[1] - ends[0]) / (2 * HALF_LIGHT))
    return np.outer(shares[1], shares[0])


def test_samples_converge_to_the_area_light() -> None:
    """Texels are small beside the steps of a penumbra's edge: otherwise both beat, as all edges are along the axes."""
    seen = plate_over_floor()
    truth = hidden_share(seen)
    assert truth.max() == 1.0
    assert truth.min() == 0.0
    assert ((truth > 0.0) & (truth < 1.0)).mean() > 0.2
    found = {}
    for count in (1, 5, 9, 64, 256):
        rendered = params(map_size=1024, method="direct")
        found[count] = soft_difference(soft_shadow(seen, rendered, samples=light_samples(seen, count)), truth)
    values = list(found.values())
    assert values == sorted(values, reverse=True), found
    assert found[9] < 0.06, found
    assert found[256] < 0.012, found


@pytest.mark.long
@pytest.mark.parametrize("name", ["chair", "kettle"])
def test_samples_of_a_real_caster_converge_and_the_warp_stays_off(name: str) -> None:
    seen = models.shadow_stage(getattr(models, name)(), offset=(0.31, -0.24), width=64, height=48)
    rendered, warping = params(map_size=96, method="direct"), params(map_size=96, rows=15, columns=5)
    limit = soft_shadow(seen, rendered, samples=light_samples(seen, 576))
    direct, warped = {}, {}
    for count in (1, 9, 64):
        samples = light_samples(seen, count)
        maps = prepare(seen, replace(warping, light_samples=samples))
        truth = soft_shadow(seen, rendered, samples=samples)
        direct[count] = soft_difference(truth, limit)
        warped[count] = soft_difference(soft_shadow(seen, warping, maps, samples), truth)
    assert direct[1] > direct[9] > direct[64] > 0.0, direct
    assert direct[64] < direct[1] / 2, direct
    assert 0.0 < max(warped.values()) < 0.15, warped


def test_batches_add_up() -> None:
    seen, samples = plate_over_floor(), light_samples(plate_over_floor(), 81)
    assert isinstance(samples, np.ndarray)
    one_by_one = [soft_shadow(seen, params(method="direct", light_samples=samples[i : i + 1])) for i in range(81)]
    together = soft_shadow(seen, params(method="direct"), samples=samples)
    assert np.allclose(together, np.mean(one_by_one, axis=0), atol=1e-12, rtol=0)
