"""The area light by rays: closed forms of squares and spheres, and every triangle tried against the hierarchy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ibr_ref.scene import Camera, Mesh
from ibr_ref.shadows import Params, Scene, SoftParams, render, render_soft
from ibr_ref.shadows.hierarchy import build
from ibr_ref.shadows.lattice import lattice
from ibr_ref.shadows.traced import traced
from tests.shadows.planes import dart, soft_shadow_by, tilted_scene
from tests.shadows.scenes import Array, ball, light, plate, scene
from tests.shadows.test_soft_light import hidden_share, plate_over_floor

RADIUS = 0.3


def below(size: int, height: float) -> Camera:
    """The floor z = -1 from under the caster, straight."""
    return Camera.orthographic(
        eye=(0, 0, -0.5), target=(0, 0, -1), up=(0, 1, 0), view_height=height, near=0.1, far=5, width=size, height=size
    )


def ball_over_floor(half_light: float, size: int = 25, height: float = 1.0) -> Scene:
    """A ball around the origin, a square light in z = 4, the floor z = -1."""
    lamp = light(half_edges=((half_light, 0, 0), (0, half_light, 0)), vertical_fov=60.0)
    return scene(caster=ball(RADIUS, 96), light=lamp, camera=below(size, height), offset=(0.0, 0.0))


@pytest.mark.parametrize("rays", [89, 610])
def test_a_square_hides_of_a_square_what_the_closed_form_says(rays: int) -> None:
    """Edges along the light's: half-planes of the lattice, two a side; the error is a few points of it."""
    found = soft_shadow_by(plate_over_floor(), rays=rays)
    difference = np.abs(found - hidden_share(plate_over_floor()))
    assert difference.max() < 5.0 / rays
    assert difference.mean() < 0.6 / rays


def test_under_the_middle_of_a_sphere_a_disc_of_the_light_is_hidden() -> None:
    """The tangent cone has sin = radius/distance; it cuts the light's plane, 5 above, in a disc: all of it on the light."""
    hidden = 5.0 * math.tan(math.asin(RADIUS / 1.0))
    assert hidden < 2.0
    found = soft_shadow_by(ball_over_floor(2.0, size=1), rays=4181)
    assert found[0, 0] == pytest.approx(math.pi * hidden**2 / 16.0, abs=2e-3)


def test_beside_a_sphere_the_cone_is_cut_aslant() -> None:
    """Each of 300 x 300 points of the light by itself: hidden if it lies within the cone of tangents."""
    seen = ball_over_floor(0.6, size=9)
    found = soft_shadow_by(seen, rays=2584)
    steps = 0.6 * ((2 * np.arange(300) + 1) / 300 - 1)
    lights = np.stack([*np.meshgrid(steps, steps), np.full((300, 300), 4.0)], axis=-1)
    at = (np.arange(9) + 0.5) / 9 - 0.5
    expected = np.zeros((9, 9))
    for row, y in enumerate(-at):
        for column, x in enumerate(at):
            point = np.array([x, y, -1.0])
            rays = lights - point
            along = rays @ -point / np.linalg.norm(rays, axis=-1)
            expected[row, column] = (along > math.sqrt(point @ point - RADIUS**2)).mean()
    assert ((expected > 0.02) & (expected < 0.98)).sum() > 10
    assert np.abs(found - expected).max() < 4e-3


def test_a_point_light_gives_the_shadow_of_a_rendered_map_but_for_its_texels() -> None:
    seen = ball_over_floor(0.0, size=60)
    mapped = render(seen, Params(map_size=1024, method="direct")).stages["accumulate.shadow"]
    found = soft_shadow_by(seen, rays=3)
    assert set(np.unique(found)) == {0.0, 1.0}
    clear = (mapped == 0.0) | (mapped == 1.0)
    assert clear.mean() > 0.97
    assert np.array_equal(found[clear], mapped[clear])


def test_the_lattice_measures_half_planes() -> None:
    for count in (55, 610):
        points = lattice(count)
        assert np.abs(points).max() < 1.0
        for angle in np.linspace(0.1, 3.0, 12):
            share = (points @ (math.cos(angle), math.sin(angle)) > 0.3).mean()
            fine = (lattice(10946) @ (math.cos(angle), math.sin(angle)) > 0.3).mean()
            assert abs(share - fine) < 3.0 / count + 1e-3


# --- The hierarchy ---------------------------------------------------------------------------------------------------


def soup(count: int, seed: int) -> Array:
    """(T, 3, 3) triangles anywhere in a cube; some without an area, some on top of each other."""
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (count, 1, 3)) + random.uniform(-0.4, 0.4, (count, 3, 3))
    corners[::7, 2] = corners[::7, 1]
    corners[3::11] = corners[0]
    return corners


def plain_hits(corners: Array, origin: Array, end: Array) -> bool:
    """Every triangle by itself: o + t d = a + beta u + gamma v, solved."""
    direction = end - origin
    for a, b, c in corners:
        matrix = np.stack([b - a, c - a, -direction], axis=1)
        if abs(np.linalg.det(matrix)) < 1e-12:
            continue
        beta, gamma, t = np.linalg.solve(matrix, origin - a)
        if beta >= 0 and gamma >= 0 and beta + gamma <= 1 and 0 < t < 1:
            return True
    return False


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 40])
def test_the_hierarchy_finds_what_every_triangle_by_itself_does(count: int) -> None:
    corners = soup(count, count)
    vertices, triangles = corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    random = np.random.default_rng(1)
    points, lights = random.uniform(-1.5, 1.5, (1, 60, 3)), random.uniform(-1.5, 1.5, (8, 3))
    points[0, :10, 2] = lights[0, 2]  # a component of the direction is 0
    found = traced(np.zeros((1, 60), np.int32), points, 1, vertices, triangles, lights)
    expected = [np.mean([plain_hits(corners, p, l) for l in lights]) for p in points[0]]
    assert count == 1 or 0.0 < np.mean(expected) < 1.0
    assert found[0].tolist() == expected


def test_boxes_hold_their_triangles() -> None:
    corners = soup(61, 0)
    made = build(corners.reshape(-1, 3), np.arange(183, dtype=np.int32).reshape(-1, 3))
    leaves = len(made.starts) - 1
    assert len(made.low) == 2 * leaves - 1
    assert sorted(map(str, made.corners.tolist())) == sorted(map(str, corners.tolist()))
    assert set(np.diff(made.starts)) <= {2, 3, 4}
    for i in range(leaves - 1):
        for child in (2 * i + 1, 2 * i + 2):
            assert (made.low[i] <= made.low[child]).all()
            assert (made.high[i] >= made.high[child]).all()
    for i in range(leaves):
        held = made.corners[made.starts[i] : made.starts[i + 1]].reshape(-1, 3)
        assert (made.low[leaves - 1 + i] <= held).all()
        assert (made.high[leaves - 1 + i] >= held).all()


# --- The picture -----------------------------------------------------------------------------------------------------


def test_the_caster_and_what_lies_between_it_and_the_light_are_lit() -> None:
    seen = scene(receivers=[plate(6.0, -1.0), plate(0.2, 2.0)], camera=Camera.look_at(
        eye=(0.5, -4.0, 5.0), target=(0.0, 0.0, 0.0), near=0.1, far=20, width=64, height=48))  # fmt: skip
    direct = render(seen, Params(method="direct", map_size=64))
    for method in ("traced", "convolution"):
        frame = render_soft(seen, SoftParams(method=method))
        assert np.array_equal(frame.depth, direct.depth)
        shadow = np.asarray(frame.stages["soft.shadow"])
        dark = np.abs(frame.color - direct.color).max(axis=-1) > 0
        assert shadow.max() == 1.0
        assert not (dark & (shadow == 0.0) & (direct.stages["accumulate.shadow"] == 0.0)).any()
        onto_plate = render_soft(replace(seen, receivers=[plate(0.2, 2.0)]), SoftParams(method=method))
        assert not np.asarray(onto_plate.stages["soft.shadow"]).any()


def test_without_stages_the_same_picture() -> None:
    seen = tilted_scene(dart())
    for method in ("traced", "convolution"):
        whole, bare = (render_soft(seen, SoftParams(method=method), stages=keep) for keep in (True, False))
        assert np.array_equal(whole.color, bare.color)
        assert bare.stages == {}


def test_one_triangle() -> None:
    """The least that a mesh can be."""
    one = Mesh(vertices=[(-0.3, -0.3, 0), (0.3, -0.3, 0), (0, 0.3, 0)], triangles=[(0, 1, 2)])
    shadow = soft_shadow_by(tilted_scene(one))
    assert 0.0 < shadow.mean() < 1.0
