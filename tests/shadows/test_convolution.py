"""Soler & Sillion's convolution: exact between parallel planes; the FFT and the light's image against plain sums."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.shadows import SoftParams, render_soft
from ibr_ref.shadows.convolution import convolved, light_image, plane_distances
from ibr_ref.shadows.parallel import Frame, Window
from tests.shadows.planes import dart, soft_shadow_by, tilted_scene
from tests.shadows.scenes import box
from tests.shadows.test_soft_light import hidden_share, plate_over_floor

WINDOW = Window(np.array([-0.5, -0.3]), np.array([0.7, 0.6]), 1.0, 2.0)
HALF_EDGES = np.array([[0.3, 0.1], [-0.1, 0.2]])


def test_between_parallel_planes_it_is_the_closed_form() -> None:
    truth = hidden_share(plate_over_floor())
    for size, most in ((128, 0.05), (512, 0.012)):
        difference = np.abs(
            soft_shadow_by(plate_over_floor(), method="convolution", map_size=size, map_samples=8) - truth
        )
        assert difference.max() < most


def test_any_shapes_in_parallel_planes() -> None:
    """A dart before a parallelogram, turned about: as the rays say."""
    seen = tilted_scene(dart())
    truth = soft_shadow_by(seen, rays=4181)
    assert ((truth > 0.0) & (truth < 1.0)).mean() > 0.2
    found = soft_shadow_by(seen, method="convolution", map_size=1024, map_samples=4)
    assert np.abs(found - truth).max() < 8e-3


def test_a_thick_caster_is_taken_for_a_plane() -> None:
    """The planes' approximation errs where the caster is near the floor, as the paper says of it; rays do not."""
    seen = tilted_scene(box(0.3))
    difference = np.abs(soft_shadow_by(seen, method="convolution") - soft_shadow_by(seen))
    assert 0.02 < difference.max() < 0.5


def test_a_point_light_leaves_the_mask() -> None:
    seen = tilted_scene(dart(), half_edges=np.zeros((2, 3)))
    frame = render_soft(seen, SoftParams(method="convolution", map_size=64, receiver_planes=1))
    image = np.asarray(frame.stages["soft.maps"])[0]
    assert np.abs(image - np.round(image)).max() < 1e-12
    assert 0.1 < image.mean() < 0.9


def test_the_fft_is_the_sum() -> None:
    """Texel by texel: of the occluder's texels, those that the light's image reaches, mirrored in its centre."""
    random = np.random.default_rng(0)
    occluder = (random.random((24, 24)) < 0.4).astype(float)
    frame = Frame(np.eye(4), HALF_EDGES)
    (found,) = convolved(occluder, frame, WINDOW, 2.0, np.array([4.0]))
    light = light_image(HALF_EDGES, WINDOW, 24, 1 / 2.0 - 1 / 4.0)
    reach = len(light) // 2
    assert reach > 1
    for row in range(24):
        for column in range(24):
            total = 0.0
            for j in range(-reach, reach + 1):
                for i in range(-reach, reach + 1):
                    if 0 <= row - j < 24 and 0 <= column - i < 24:
                        total += light[reach + j, reach + i] * occluder[row - j, column - i]
            assert found[row, column] == pytest.approx(total, abs=1e-12)


@pytest.mark.parametrize("size", [24, 25])
def test_the_lights_image_is_the_parallelogram(size: int) -> None:
    """Each texel's share of it, by points inside it; rows go downwards, y upwards."""
    light = light_image(HALF_EDGES, WINDOW, size, 0.5)
    assert light.sum() == pytest.approx(1.0)
    reach = len(light) // 2
    texel = (WINDOW.high - WINDOW.low) / size
    expected = np.zeros_like(light)
    steps = (2 * np.arange(400) + 1) / 400 - 1
    for g in steps:
        x, y = (0.5 * (np.outer(steps, HALF_EDGES[0]) + g * HALF_EDGES[1])).T
        columns, rows = np.floor(x / texel[0] + reach + 0.5), np.floor(-y / texel[1] + reach + 0.5)
        np.add.at(expected, (rows.astype(int), columns.astype(int)), 1 / 400**2)
    assert np.abs(light - expected).max() < 0.05 * expected.max()


def test_a_light_of_no_size_is_one_texel() -> None:
    assert light_image(np.zeros((2, 2)), WINDOW, 16, 1.0).tolist() == [[1.0]]
    assert light_image(HALF_EDGES, WINDOW, 16, 0.0).tolist() == [[1.0]]


def test_planes_lie_evenly_in_the_lights_size() -> None:
    distances = np.array([1.0, 5.0, 3.0, 4.0])
    planes = plane_distances(distances, 2.0, 3)
    assert np.allclose(planes, [5.0, 1 / ((1 / 5 + 1 / 3) / 2), 3.0])
    assert np.allclose(plane_distances(distances, 2.0, 1), planes[1])
    assert (plane_distances(distances, 6.0, 2) > 6.0).all()
