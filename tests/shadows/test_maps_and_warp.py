"""Stages maps and warp by themselves: bit for bit the twin's, and what must hold of any map and of any grid."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ibr_ref.scene import AreaLight
from ibr_ref.shadows import maps, warp
from ibr_ref.shadows.draw import Image, draw
from ibr_ref.shadows.spans import spans
from tests.naive import shadow_light, shadow_maps
from tests.naive import warp as twin
from tests.shadows.plates import example, moved_controls, parameters, regular_grid

Array = NDArray[np.float64]

LEVELS = np.arange(256.0)

derandomized = settings(derandomize=True, deadline=None, max_examples=40)


# --- Maps ------------------------------------------------------------------------------------------------------------


def soup(seed: int, triangles: int = 12) -> tuple[Array, NDArray[np.int32]]:
    """Random triangles around the origin."""
    random = np.random.RandomState(seed)
    vertices = random.uniform(-1.0, 1.0, (3 * triangles, 3))
    return vertices, random.permutation(3 * triangles).reshape(-1, 3).astype(np.int32)


def view_of(light: AreaLight, size: int, vertices: Array, triangles: NDArray[np.int32]) -> maps.View:
    camera = light.camera(size)
    axes = np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
    return maps.View(vertices, triangles, axes, camera.view_from_world, camera.clip_from_view)


def lamp(**changes: Any) -> AreaLight:
    values = {"position": (0.1, -0.2, 4.0), "target": (0.3, 0.1, 0.0), "vertical_fov": 60.0, "near": 1.0, "far": 10.0}
    return AreaLight(**{**values, **changes})


@derandomized
@given(st.integers(0, 1000), st.integers(8, 33), st.integers(1, 3), st.sampled_from([1.0, 3.5, 4.2]))
def test_maps_are_the_twins(seed: int, size: int, k: int, near: float) -> None:
    """Also where the near plane cuts the caster, or all of it is behind the light."""
    light = lamp(near=near)
    vertices, triangles = soup(seed)
    offset = np.random.RandomState(seed).uniform(-0.5, 0.5, 2)
    view = view_of(light, size, vertices, triangles)
    caster = SimpleNamespace(vertices=vertices, triangles=triangles)
    scene = example(light=light, caster=caster)
    for content, ours in (
        ("mask", maps.mask(view, offset, size, k) / (k * k)),
        ("depth", maps.depth(view, offset, size)),
    ):
        params = parameters(map_size=size, content=content, map_samples=k)
        theirs = shadow_maps.rendered_map(scene, params, tuple(offset.tolist()), tuple(light.position))
        assert np.array_equal(ours, theirs), content


@derandomized
@given(st.tuples(*[st.integers(-64, 64)] * 3), st.integers(0, 100))
def test_moving_light_and_object_together_changes_no_map(steps: tuple[int, int, int], seed: int) -> None:
    """In steps of 1/8, which floats hold exactly, along the axes; the third number is not used by the object."""
    vertices, triangles = soup(seed)
    vertices = np.round(vertices * 64) / 64
    moved = np.array([steps[0] / 8, steps[1] / 8, 0.0])
    here = lamp(position=(0.0, 0.0, 4.0), target=(0.0, 0.0, 0.0))
    there = lamp(position=np.array([0.0, 0.0, 4.0]) + moved, target=moved)
    offset = np.array([0.25, -0.5])
    a, b = (view_of(light, 32, vertices, triangles) for light in (here, there))
    assert np.array_equal(maps.depth(a, offset, 32), maps.depth(b, offset + moved[:2], 32))
    assert np.array_equal(maps.mask(a, offset, 32, 2), maps.mask(b, offset + moved[:2], 32, 2))


@derandomized
@given(st.floats(-170, 170), st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3))
def test_a_moved_light_looks_the_same_way(fov: float, x: float, y: float, z: float) -> None:
    light = lamp(vertical_fov=abs(fov) + 1.0)
    camera, moved = light.camera(16), light.camera(16, (x, y, z))
    theirs = shadow_light.camera_at(light, (x, y, z))
    assert np.array_equal(moved.view_from_world, theirs.view_from_world)
    assert np.array_equal(moved.clip_from_view, theirs.clip_from_view)
    assert np.array_equal(moved.view_from_world[:, :3], camera.view_from_world[:, :3])
    assert moved.eye.tolist() == [x, y, z, 1.0]


def test_positions_hold_the_lights_own_coordinates_between() -> None:
    low, high = np.array([-1.0, 2.0]), np.array([3.0, 5.0])
    inside = maps.positions(low, high, np.array([0.5, 2.5]))
    assert inside[0, :, 0].tolist() == [-1.0, 0.5, 3.0]
    assert inside[:, 0, 1].tolist() == [2.0, 2.5, 5.0]
    assert inside[2, 1].tolist() == [0.5, 5.0]
    beside = maps.positions(low, high, np.array([-7.0, 5.0]))
    assert beside[1, 1].tolist() == [1.0, 3.5]


# --- One warp --------------------------------------------------------------------------------------------------------


def naive_warp(image: Array, source: Array, target: Array, content: str) -> Array:
    return twin.warp_image(image, twin.plain_grid(source), twin.plain_grid(target), content)


def source_of(image: NDArray[Any], grid: Array, outside: float) -> Image:
    levels = LEVELS if image.dtype == np.uint8 else None
    return Image(image.reshape(-1), levels, spans(image, levels, outside), grid)


def warped(image: NDArray[Any], source: Array, target: Array, outside: float) -> Array:
    """Also checks that what is drawn beside its spans is blank."""
    out = np.empty(image.shape)
    first, stop = draw(source_of(image, source, outside), None, 0.0, target, outside, out).T[..., None]
    columns = np.arange(len(out))
    assert (out[(columns < first) | (columns >= stop)] == outside).all()
    return out


sizes = st.tuples(st.integers(2, 6), st.integers(2, 6))


def drawn_image(random: np.random.RandomState, size: int, depth: bool, boxes: float) -> NDArray[Any]:
    """Random texels, where they are not blank: in a few boxes of up to this share of the side; 0: everywhere."""
    image = random.random_sample((size, size)) if depth else random.randint(0, 16, (size, size)).astype(np.uint8)
    if boxes == 0.0:
        return image
    solid = np.zeros((size, size), bool)
    for top, left in random.randint(0, size, (random.randint(0, 4), 2)):
        height, width = random.randint(1, 2 + int(boxes * size), 2)
        solid[top : top + height, left : left + width] = True
    return np.where(solid, image, np.array(depth, image.dtype))


@derandomized
@given(
    st.integers(0, 10000),
    st.integers(8, 40),
    sizes,
    st.booleans(),
    st.sampled_from([0.05, 0.2, 0.5]),
    st.sampled_from([0.0, 0.1, 0.4]),
)
def test_a_warp_is_the_twins(
    seed: int, size: int, shape: tuple[int, int], depth: bool, force: float, boxes: float
) -> None:
    """Also of maps that are blank in part, of grids that fold, and whose border leaves that of the map."""
    random = np.random.RandomState(seed)
    source, target = (
        np.clip(regular_grid(*shape) + random.uniform(-force, force, (*shape, 2)), 0.0, 1.0) for _ in range(2)
    )
    image = drawn_image(random, size, depth, boxes)
    ours = warped(image, source, target, float(depth))
    theirs = naive_warp(image.astype(np.float64), source, target, "depth" if depth else "mask")
    assert np.array_equal(ours, theirs)


@derandomized
@given(st.integers(0, 1000), st.floats(0.0, 1.0), st.sampled_from([0.0, 0.2]))
def test_two_images_are_warped_as_one_by_one_and_mixed(seed: int, share: float, boxes: float) -> None:
    random = np.random.RandomState(seed)
    images = [drawn_image(random, 24, True, boxes) for _ in range(2)]
    first, second, target = moved_controls(seed)[0]
    both = np.empty((24, 24))
    sources = [source_of(i, g, 1.0) for i, g in zip(images, (first, second), strict=True)]
    draw(*sources, share, target, 1.0, both)
    one, other = (warped(i, g, target, 1.0) for i, g in zip(images, (first, second), strict=True))
    assert np.array_equal(both, one * (1.0 - share) + other * share)


@derandomized
@given(
    st.integers(0, 10000),
    st.integers(90, 200),
    st.tuples(st.integers(2, 4), st.integers(2, 4)),
    st.booleans(),
    st.sampled_from([0.02, 0.2, 0.5]),
)
def test_what_is_not_fetched_is_blank(seed: int, size: int, shape: tuple[int, int], two: bool, force: float) -> None:
    """Long runs, of which a part may be live: the same as where every texel counts as solid."""
    random = np.random.RandomState(seed)
    first, second, target = (
        np.clip(regular_grid(*shape) + random.uniform(-force, force, (*shape, 2)), 0.0, 1.0) for _ in range(3)
    )
    sources = [source_of(drawn_image(random, size, True, 0.1), grid, 1.0) for grid in (first, second)]
    everywhere = [source._replace(spans=np.full((size, 2), (0, size), np.int32)) for source in sources]
    out, expected = np.empty((2, size, size))
    draw(sources[0], sources[1] if two else None, 0.3, target, 1.0, out)
    draw(everywhere[0], everywhere[1] if two else None, 0.3, target, 1.0, expected)
    assert np.array_equal(out, expected)


@pytest.mark.parametrize("shape", [(2, 2), (3, 5), (15, 5), (5, 15)])
def test_the_regular_grid_leaves_the_image(shape: tuple[int, int]) -> None:
    image = np.random.RandomState(0).random_sample((64, 64))
    grid = regular_grid(*shape)
    on_lattice = np.rint(grid * 64 * 256) / (64 * 256)
    assert np.abs(warped(image, on_lattice, on_lattice, 0.0) - image).max() < 1e-12


# --- The stage -------------------------------------------------------------------------------------------------------


@derandomized
@given(
    st.integers(0, 1000),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.booleans(),
    st.booleans(),
    st.sampled_from([0.0, 0.2, 0.5]),
    st.booleans(),
)
def test_the_stage_is_the_twins(
    seed: int, x: float, y: float, nearest: bool, depth: bool, boxes: float, even: bool
) -> None:
    positions = maps.positions(np.array([-1.0, -1.0]), np.array([1.0, 1.0]), np.array([0.3, 0.0]))
    random = np.random.RandomState(seed)
    images = np.stack([drawn_image(random, 20, depth, boxes) for _ in range(9)]).reshape(3, 3, 20, 20)
    levels = None if depth else np.arange(256) / 16.0
    controls = moved_controls(seed)
    nine = warp.Nine(images, levels, spans(images, levels, float(depth)), controls, float(depth))
    depths = None if even else random.uniform(0.5, 2.0, (3, 3))
    ours = warp.warp_stage(nine, *warp.locate(positions, np.array([x, y])), depths, nearest)
    params = parameters(policy="nearest" if nearest else "dissolve", content="depth" if depth else "mask")
    theirs = twin.warped_map((x, y), positions, images if depth else images / 16.0, controls, params, depths)
    for name in theirs._fields:
        assert np.array_equal(getattr(ours, name), getattr(theirs, name)), name
