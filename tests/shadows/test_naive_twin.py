"""The naive twin of the shadows against closed forms, stages 1 to 3: light, maps and warp."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ibr_ref.scene import Camera
from tests.naive import shadow_light, shadow_maps, shadows, warp
from tests.shadows.plates import (
    HALF_PLATE,
    HEIGHT,
    PLATE_HEIGHT,
    example,
    moved_controls,
    parameters,
    regular_grid,
    same_controls,
)

# --- Light -----------------------------------------------------------------------------------------------------------


coordinate = st.floats(-10, 10).map(lambda x: round(x, 3))


@settings(max_examples=60, derandomize=True, database=None, deadline=None)
@given(st.tuples(*[coordinate] * 9), st.floats(1.0, 170.0), st.floats(0.01, 5.0), st.floats(6.0, 100.0))
def test_the_light_camera_is_the_packages_look_at(numbers: Any, fov: float, near: float, far: float) -> None:
    eye, target, up = numbers[:3], numbers[3:6], numbers[6:]
    try:
        camera = Camera.look_at(eye=eye, target=target, up=up, vertical_fov=fov, near=near, far=far, width=8, height=8)
    except ValueError:
        return
    light = SimpleNamespace(position=eye, target=target, up=up, vertical_fov=fov, near=near, far=far)
    view, clip = shadow_light.camera_at(light, eye)
    assert np.array_equal(view, camera.view_from_world)
    assert np.array_equal(clip, camera.clip_from_view)


def test_tangents_of_known_angles() -> None:
    assert shadow_light.tangent(45.0) == 1.0
    assert shadow_light.tangent(0.0) == 0.0
    assert shadow_light.tangent(60.0) == pytest.approx(math.sqrt(3.0), rel=3e-16)
    assert shadow_light.tangent(22.5) == pytest.approx(math.sqrt(2.0) - 1.0, rel=3e-16)


def test_nine_samples_are_the_centre_and_then_row_by_row() -> None:
    samples = shadow_light.light_samples_of(example(), parameters(light_samples=9))
    moved = np.array([sample.displacement for sample in samples])
    x, y = 0.2 * 2 / 3, 0.1 * 2 / 3
    expected = [(0, 0), (-x, -y), (0, -y), (x, -y), (-x, 0), (x, 0), (-x, y), (0, y), (x, y)]
    assert moved == pytest.approx(np.array(expected), abs=1e-15)
    five = shadow_light.light_samples_of(example(), parameters(light_samples=5))
    assert [sample.position for sample in five] == [samples[k].position for k in (0, 1, 3, 6, 8)]


def test_coordinates_on_oblique_axes() -> None:
    axes = (2.0, 0.0, 0.0), (1.0, 0.0, 3.0)
    assert shadow_light.on_axes((2.0 * 0.5 + 1.0 * 0.25, 0.0, 3.0 * 0.25), axes) == pytest.approx((0.5, 0.25))


# --- Maps ------------------------------------------------------------------------------------------------------------


def test_positions_hold_the_lights_coordinate_between_the_widened_ends() -> None:
    scene, params = example(), parameters(light_samples=9)
    positions = shadow_maps.map_positions(scene, shadow_light.light_samples_of(scene, params))
    x, y = 0.2 * 2 / 3, 0.1 * 2 / 3
    assert positions[1, :, 0] == pytest.approx([-0.5 - x, 0.1, 0.6 + x])
    assert positions[:, 2, 1] == pytest.approx([-0.4 - y, -0.2, 0.5 + y])


def test_a_light_beside_the_range_leaves_the_middle() -> None:
    scene = example(offset_range=((0.2, 1.0), (-0.4, -0.2)))
    positions = shadow_maps.map_positions(scene, shadow_light.light_samples_of(scene, parameters()))
    assert positions[0, :, 0].tolist() == [0.2, 0.6, 1.0]
    assert positions[:, 0, 1] == pytest.approx([-0.4, -0.3, -0.2])


def plate_in_map(scene: Any, offset: tuple[float, float], size: int) -> tuple[Any, Any]:
    """(columns, rows) intervals of the plate in its map, in texels: similar triangles."""
    focal = 1.0 / math.tan(math.radians(30.0))
    distance = HEIGHT - PLATE_HEIGHT
    light = scene.light.position
    x = [(offset[0] + e - light[0]) * focal / distance for e in (-HALF_PLATE, HALF_PLATE)]
    y = [(offset[1] + e - light[1]) * focal / distance for e in (HALF_PLATE, -HALF_PLATE)]
    return [(value + 1) / 2 * size for value in x], [(1 - value) / 2 * size for value in y]


@pytest.mark.parametrize("offset", [(0.3, 0.2), (-0.5, -0.4), (0.1, -0.2)])
def test_mask_of_a_plate_is_its_rectangle(offset: tuple[float, float]) -> None:
    scene, size = example(), 32
    image = shadow_maps.rendered_map(scene, parameters(), offset, scene.light.position)
    columns, rows = plate_in_map(scene, offset, size)
    centres = np.arange(size) + 0.5
    inside_x = (centres > columns[0]) & (centres < columns[1])
    inside_y = (centres > rows[0]) & (centres < rows[1])
    assert np.array_equal(image, np.outer(inside_y, inside_x).astype(float))
    assert 20 < image.sum() < 200


def test_map_samples_count_the_covered_share() -> None:
    scene, size, k = example(), 32, 4
    image = shadow_maps.rendered_map(scene, parameters(map_samples=k), (0.3, 0.2), scene.light.position)
    columns, rows = plate_in_map(scene, (0.3, 0.2), size)
    assert image.sum() == pytest.approx((columns[1] - columns[0]) * (rows[1] - rows[0]), rel=0.05)
    assert set(np.unique(image * k * k)) <= set(range(k * k + 1))
    assert ((image > 0) & (image < 1)).any()


def test_depth_map_of_a_plate_is_its_window_depth() -> None:
    scene = example()
    mask = shadow_maps.rendered_map(scene, parameters(), (0.3, 0.2), scene.light.position)
    image = shadow_maps.rendered_map(scene, parameters(content="depth"), (0.3, 0.2), scene.light.position)
    distance = HEIGHT - PLATE_HEIGHT
    depth = (10.0 / 9.0) * (1.0 - 1.0 / distance)
    assert np.array_equal(image < 1.0, mask == 1.0)
    assert image[mask == 1.0] == pytest.approx(depth, abs=1e-14)


def test_the_near_plane_cuts_the_caster() -> None:
    scene = example()
    scene.light.near = 2.6  # beyond the plate, at 2.5
    image = shadow_maps.rendered_map(scene, parameters(), (0.3, 0.2), scene.light.position)
    assert not image.any()


def test_a_moved_light_is_an_object_moved_the_other_way() -> None:
    """The claim behind stage 5: the map from a sample is the centre's map of the object at o - d."""
    scene, params = example(), parameters(map_size=64, content="depth")
    for sample in shadow_light.light_samples_of(scene, parameters(light_samples=9)):
        seen = shadow_maps.rendered_map(scene, params, scene.offset, sample.position)
        moved = shadows.offset_seen_from(scene, sample)
        assert seen == pytest.approx(shadow_maps.rendered_map(scene, params, moved, scene.light.position), abs=1e-9)


def test_a_grid_of_maps_gives_its_nearest_or_the_mix_of_four() -> None:
    scene, params = example(), parameters()
    samples = shadow_light.light_samples_of(scene, params)

    def made(x: float, y: float) -> np.ndarray:
        return shadow_maps.rendered_map(scene, params, (x, y), scene.light.position)

    def fetched(x: float, y: float, mix: bool) -> np.ndarray:  # maps at x = -0.5, 0.05, 0.6 and y = -0.4, 0.05, 0.5
        return shadow_maps.grid_map(scene, params, samples, (x, y), 3, mix)

    assert np.array_equal(fetched(0.2, 0.4, False), made(0.05, 0.5))
    assert np.array_equal(fetched(-0.4, -0.1, False), made(-0.5, 0.05))
    assert np.array_equal(fetched(0.6, 0.5, True), made(0.6, 0.5))
    mixed = 0.7 * (0.6 * made(-0.5, -0.4) + 0.4 * made(0.05, -0.4)) + 0.3 * (
        0.6 * made(-0.5, 0.05) + 0.4 * made(0.05, 0.05)
    )
    assert fetched(-0.5 + 0.4 * 0.55, -0.4 + 0.3 * 0.45, True) == pytest.approx(mixed, abs=1e-12)


# --- Warp ------------------------------------------------------------------------------------------------------------


def test_equal_grids_leave_the_image() -> None:
    image = np.random.default_rng(1).random((32, 32))
    grid = warp.plain_grid(moved_controls(2)[1, 2])
    assert warp.warp_image(image, grid, grid, "mask") == pytest.approx(image, abs=0.02)  # snapping: 1/512 of a texel
    regular = warp.plain_grid(regular_grid(3, 5))
    assert warp.warp_image(image, regular, regular, "mask") == pytest.approx(image, abs=1e-13)


def test_a_linear_image_goes_where_the_mesh_takes_it() -> None:
    """Image u, scaled by a half about the origin: twice u on the mesh, and the empty value outside."""
    size = 32
    image = np.tile((np.arange(size) + 0.5) / size, (size, 1))
    source = warp.plain_grid(regular_grid(3, 3))
    target = warp.plain_grid(regular_grid(3, 3) / 2)
    result = warp.warp_image(image, source, target, "depth")
    assert np.all(result[size // 2 :] == 1.0)
    assert np.all(result[:, size // 2 :] == 1.0)
    assert result[: size // 2, : size // 2] == pytest.approx(np.tile(2 * image[0, : size // 2], (size // 2, 1)))


def test_later_triangles_overwrite() -> None:
    """A grid folded back onto itself: its right half, drawn later, covers its left half."""
    image = np.tile((np.arange(16) + 0.5) / 16, (16, 1))
    source = warp.plain_grid(regular_grid(2, 3))
    target = [[(0.0, v), (1.0, v), (0.0, v)] for v in (0.0, 1.0)]
    assert warp.warp_image(image, source, target, "mask").min() > 0.5


@pytest.mark.parametrize("policy", ["dissolve", "nearest"])
@pytest.mark.parametrize("content", ["mask", "depth"])
def test_at_a_prepared_place_the_map_is_the_prepared_one(policy: str, content: str) -> None:
    scene, params = example(), parameters(policy=policy, content=content, map_samples=2)
    positions, images = shadows.prepare(scene, params)
    for j in range(3):
        for i in range(3):
            warped = warp.warped_map(tuple(positions[j, i]), positions, images, same_controls(3, 5), params)
            assert warped.image == pytest.approx(images[j, i], abs=1e-12)
            assert (warped.cell + warped.fraction).tolist() == [float(i), float(j)]


def test_the_middle_line_belongs_to_the_upper_cell() -> None:
    assert warp.cell_of(0.5, [0.0, 0.5, 2.0]) == (1, 0.0)
    assert warp.cell_of(math.nextafter(0.5, 0.0), [0.0, 0.5, 2.0])[0] == 0
    assert warp.cell_of(2.0, [0.0, 0.5, 2.0]) == (1, 1.0)


def moving_images(positions: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """(images, controls): a smooth spot with its control point on it, wherever the object is."""
    images, controls = np.empty((3, 3, size, size)), same_controls(3, 3).copy()
    for j in range(3):
        for i in range(3):
            centre = 0.5 + 0.2 * positions[j, i]
            controls[j, i, 1, 1] = centre
            images[j, i] = spot(centre, size)
    return images, controls


def spot(centre: np.ndarray, size: int) -> np.ndarray:
    """A pyramid that falls from 1 at the centre to 0 at the border, linear on each side."""
    at = (np.arange(size) + 0.5) / size
    x, y = ((np.where(at < c, at / c, (1 - at) / (1 - c))) for c in centre)
    return np.minimum.outer(y, x)


@pytest.mark.parametrize("policy", ["dissolve", "nearest"])
def test_a_spot_moves_with_its_control_point(policy: str) -> None:
    size = 64
    line = np.array([-1.0, 0.0, 1.0])
    positions = np.stack(np.meshgrid(line, line), axis=-1)
    images, controls = moving_images(positions, size)
    for offset in [(-0.7, 0.3), (0.45, 0.5), (0.9, -0.2)]:
        warped = warp.warped_map(offset, positions, images, controls, parameters(policy=policy))
        expected = 0.5 + 0.2 * np.array(offset)
        assert warped.grid[1, 1] == pytest.approx(expected)
        row, column = np.unravel_index(warped.image.argmax(), warped.image.shape)
        assert (np.array([column, row]) + 0.5) / size == pytest.approx(expected, abs=1.0 / size)
        assert np.abs(warped.image - spot(expected, size)).max() < 0.15
