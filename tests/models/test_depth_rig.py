"""Reference images: depths by closed form, masks by another rasterizer, cameras all around, the same bits everywhere."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from ibr_ref import Camera, DepthImage, Mesh, io, models
from ibr_ref.models.depth_rig import COUNTS, directions
from tests.models.surfaces import corners, digest
from tests.naive.depth_image import world_points
from tests.naive.raster import triangle_fragments

Array = NDArray[np.float64]

RIG = "42090b1e4bc226c9db2576de92a70f2fd5986f8b4ba15c5f2ec0a457ece50816"
CUBE = Mesh(
    vertices=[(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    triangles=[
        triangle
        for a, b, c, d in [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        for triangle in ((a, b, c), (a, c, d))
    ],
    color=(0.3, 0.6, 0.9),
)


def points(image: DepthImage) -> Array:
    """(P, 3) world positions of the valid pixels, by the naive twin of splatting's unprojection."""
    return np.array([point for row in world_points(image) for point in row if point is not None])


def off_ray(image: DepthImage) -> float:
    """How far a point may be off the mesh: the snapping of 1/512 pixel on either axis, at the farthest depth."""
    _, depth, mask = image.arrays
    f_x, f_y = image.camera.intrinsics[0, 0], image.camera.intrinsics[1, 1]
    return float(depth[mask].max()) * math.hypot(1.0 / f_x, 1.0 / f_y) / 512.0 + 1e-12


def rays(camera: Camera) -> Array:
    """(H, W, 3) world directions through the pixels' centres, as long as their component along the view axis is 1."""
    (f_x, _, c_x), (_, f_y, c_y), _ = camera.intrinsics
    column, row = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    view = np.stack([(column - c_x) / f_x, -(row - c_y) / f_y, -np.ones(column.shape)], axis=2)
    return view @ camera.world_from_view[:3, :3].T


def entry(camera: Camera, radius: float) -> Array:
    """(H, W) depths where the rays meet a sphere around the origin first; NaN where they miss it."""
    ray, eye = rays(camera), camera.eye[:3]
    a, b, c = (ray * ray).sum(axis=2), (ray * eye).sum(axis=2), eye @ eye - radius * radius
    root = b * b - a * c
    return (-b - np.sqrt(np.where(root >= 0.0, root, np.nan))) / a


# Depths


def test_a_plane_across_the_view_has_one_depth() -> None:
    mesh = Mesh(vertices=[(-9, -9, 1), (9, -9, 1), (9, 9, 1), (-9, 9, 1)], triangles=[(0, 1, 2), (0, 2, 3)])
    camera = Camera.look_at(eye=(0.3, 0.2, 4), target=(0.3, 0.2, 0), up=(0, 1, 0), width=32, height=24)
    image = models.depth_image(mesh, camera)
    assert np.asarray(image.mask).all()
    np.testing.assert_allclose(image.depth, 3.0, rtol=4e-16)
    np.testing.assert_allclose(image.color, 0.8, rtol=4e-16)


@pytest.mark.parametrize(("near", "far"), [(1.0, 5.0), (1e-6, 1e6)])
def test_a_plane_that_runs_away_is_exact_to_rounding(near: float, far: float) -> None:
    """Its corners are those of the picture, where nothing is snapped: 1/depth runs from 1/2 on the left to 1/4."""
    mesh = Mesh(vertices=[(-2, -2, -2), (4, -4, -4), (4, 4, -4), (-2, 2, -2)], triangles=[(0, 1, 2), (0, 2, 3)])
    camera = Camera.look_at(
        eye=(0, 0, 0), target=(0, 0, -1), up=(0, 1, 0), vertical_fov=90, near=near, far=far, width=64, height=64
    )
    image = models.depth_image(mesh, camera)
    expected = 1.0 / (0.5 - 0.25 * (np.arange(64) + 0.5) / 64)
    np.testing.assert_allclose(image.depth, np.broadcast_to(expected, (64, 64)), rtol=1e-15)


def test_a_tilted_plane_seen_by_parallel_rays() -> None:
    mesh = Mesh(vertices=[(-1, -1, 0), (1, -1, 1), (1, 1, 3), (-1, 1, 2)], triangles=[(0, 1, 2), (0, 2, 3)])
    camera = Camera.orthographic(
        eye=(0, 0, 9), target=(0, 0, 0), up=(0, 1, 0), view_height=2.0, near=1, far=20, width=16, height=16
    )
    x = (np.arange(16) + 0.5) / 8 - 1
    np.testing.assert_allclose(models.depth_image(mesh, camera).depth, 9.0 - (1.5 + 0.5 * x - x[:, None]), rtol=1e-15)


@pytest.mark.parametrize("count", COUNTS)
def test_every_point_of_a_cube_lies_on_it(count: int) -> None:
    for image in models.depth_rig(CUBE, count, size=48):
        beyond = np.abs(points(image)) - 1.0
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        distance = np.where(outside > 0.0, outside, np.abs(beyond.max(axis=1)))
        assert distance.max() <= off_ray(image)


@pytest.mark.parametrize("segments", [8, 48])
def test_the_depths_of_a_sphere_are_those_of_ray_and_sphere(segments: int) -> None:
    """Between the spheres that hold the mesh between them; so are the masks, at the silhouette."""
    mesh = models.sphere(2.0, segments)
    for image in models.depth_rig(mesh, 9, size=64):
        _, depth, mask = image.arrays
        slack = off_ray(image)
        nearest = entry(image.camera, 2.0 + slack)
        farthest = entry(image.camera, 2.0 * math.sqrt(math.cos(2.0 * math.pi / segments)) - slack)
        assert mask[np.isfinite(farthest)].all()
        assert not mask[np.isnan(nearest)].any()
        assert (depth[mask] >= nearest[mask]).all()
        sure = np.isfinite(farthest)
        assert sure.sum() > mask.sum() // 2
        assert (depth[sure] <= farthest[sure]).all()


def test_every_point_of_a_knot_lies_on_it() -> None:
    """The distance to the nearest triangle, the projection onto each plane kept where it is inside."""
    mesh = models.knot(36, 8)
    a, b, c = corners(mesh).transpose(1, 0, 2)
    for image in models.depth_rig(mesh, 4, size=32):
        distance = np.array([nearest_triangle(p, a, b, c) for p in points(image)])
        assert distance.max() <= off_ray(image)


def nearest_triangle(p: Array, a: Array, b: Array, c: Array) -> float:
    """The distance of p to the nearest of the triangles with corners (T, 3) each."""
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    inside = np.ones(len(a), bool)
    to_edges = np.full(len(a), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along, to_p = end - start, p - start
        inside &= (np.cross(along, to_p) * normal).sum(axis=1) >= 0.0
        share = np.clip((to_p * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
        to_edges = np.minimum(to_edges, np.linalg.norm(to_p - share[:, None] * along, axis=1))
    return float(np.where(inside, np.abs(((p - a) * normal).sum(axis=1)), to_edges).min())


# Masks and colours


def naive_picture(mesh: Mesh, camera: Camera) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Colours, depths and mask, fragment by fragment in Python."""
    clip = []
    for vertex, color in zip(
        np.asarray(mesh.vertices), np.broadcast_to(mesh.color, np.shape(mesh.vertices)), strict=True
    ):
        x, y, z = vertex.tolist()
        view = [m[0] * x + m[1] * y + m[2] * z + m[3] for m in camera.view_from_world.tolist()]
        rows = camera.clip_from_view.tolist()
        projected = [m[0] * view[0] + m[1] * view[1] + m[2] * view[2] + m[3] * view[3] for m in rows]
        clip.append([*projected, -view[2], *color.tolist()])
    size = (camera.height, camera.width)
    nearest, values = np.ones(size), np.zeros((*size, 4))
    for triangle in np.asarray(mesh.triangles).tolist():
        for column, row, depth, varyings in triangle_fragments(*(clip[i] for i in triangle), *size[::-1]):
            if depth < nearest[row, column]:
                nearest[row, column], values[row, column] = depth, varyings
    return values[..., 1:], values[..., 0], nearest < 1.0


@pytest.mark.parametrize("name", ["sphere", "knot", "cube"])
def test_pictures_are_those_of_another_rasterizer(name: str) -> None:
    mesh = {"sphere": models.sphere(1.0, 8), "knot": models.knot(12, 4), "cube": CUBE}[name]
    for image in models.depth_rig(mesh, 4, size=24):
        color, depth, mask = naive_picture(mesh, image.camera)
        np.testing.assert_array_equal(image.mask, mask)
        np.testing.assert_array_equal(image.depth, depth)
        np.testing.assert_array_equal(image.color, np.clip(color, 0.0, 1.0))


def test_an_object_behind_the_camera_leaves_the_picture_empty() -> None:
    image = models.depth_image(CUBE, Camera.look_at(eye=(5, 0, 0), target=(9, 0, 0), width=8, height=8))
    assert not np.asarray(image.mask).any()


# Cameras


@pytest.mark.parametrize("count", COUNTS)
def test_the_object_fits_into_every_picture(count: int) -> None:
    offset = np.array([7.0, -3.0, 2.0])
    mesh = models.knot(24, 6)
    moved = Mesh(vertices=np.asarray(mesh.vertices) + offset, triangles=mesh.triangles, color=mesh.color)
    rig = models.depth_rig(moved, count, size=40)
    assert len(rig) == count
    for image in rig:
        mask = np.asarray(image.mask)
        assert mask.any()
        border = np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])
        assert not border.any()
        vertices = np.asarray(moved.vertices)
        depths = -(vertices @ image.camera.view_from_world[2, :3] + image.camera.view_from_world[2, 3])
        assert image.camera.near < depths.min()
        assert depths.max() < image.camera.far


@pytest.mark.parametrize(("count", "apart"), [(4, 97.0), (9, 60.0), (16, 45.0), (32, 31.0)])
def test_the_cameras_are_spread_evenly(count: int, apart: float) -> None:
    towards = directions(count)
    np.testing.assert_allclose(np.linalg.norm(towards, axis=1), 1.0, rtol=1e-15)
    cosines = towards @ towards.T
    np.fill_diagonal(cosines, -1.0)
    assert math.degrees(math.acos(cosines.max())) > apart
    assert np.abs(towards.mean(axis=0)).max() < 0.11


@pytest.mark.parametrize("count", [9, 16, 32])
def test_all_of_a_sphere_is_seen(count: int) -> None:
    mesh = models.sphere()
    vertices = np.asarray(mesh.vertices)
    seen = np.zeros(len(vertices), bool)
    for image in models.depth_rig(mesh, count, size=4):
        seen |= ((image.camera.eye[:3] - vertices) * vertices).sum(axis=1) > 0.0
    assert seen.all()


def test_vertices_of_no_triangle_do_not_count() -> None:
    stray = np.concatenate([np.asarray(CUBE.vertices), [[1e3, 0, 0]]])
    mesh = Mesh(vertices=stray, triangles=CUBE.triangles, color=CUBE.color)
    for image, other in zip(models.depth_rig(mesh, 4, size=16), models.depth_rig(CUBE, 4, size=16), strict=True):
        np.testing.assert_array_equal(image.depth, other.depth)


@pytest.mark.parametrize(("count", "size", "paper"), [(4, 210, 45_012), (9, 189, 83_521), (16, 201, 167_980)])
def test_the_papers_numbers_of_points_are_reached(count: int, size: int, paper: int) -> None:
    found = sum(int(np.asarray(image.mask).sum()) for image in models.depth_rig(models.kettle(), count, size=size))
    assert found == pytest.approx(paper, rel=0.01)


def test_a_rig_survives_the_way_through_a_file(tmp_path: Path) -> None:
    rig = models.depth_rig(models.sphere(1.0, 16), 4, size=16)
    io.write_simple_texture(tmp_path / "rig.xmt", rig)
    for image, read in zip(rig, io.read_simple_texture(tmp_path / "rig.xmt"), strict=True):
        np.testing.assert_array_equal(read.mask, image.mask)
        step = (image.camera.far - image.camera.near) / 65534
        assert np.abs(np.asarray(read.depth) - np.asarray(image.depth)).max() <= step


# The same bits


def rig_digest() -> str:
    """Of a rig's arrays and cameras."""
    rig = models.depth_rig(models.knot(60, 12), 9, size=64)
    cameras = [(image.camera.view_from_world, image.camera.clip_from_view) for image in rig]
    return digest(*(array for image in rig for array in image.arrays), *(m for pair in cameras for m in pair))


@pytest.mark.long
@pytest.mark.parametrize("switches", [{"NUMBA_NUM_THREADS": "1"}, {"NUMBA_NUM_THREADS": "2"}], ids=["one", "two"])
def test_bits_do_not_depend_on_the_number_of_threads(switches: dict[str, str]) -> None:
    command = [sys.executable, "-c", "from tests.models import test_depth_rig as t; print(t.rig_digest())"]
    root = Path(__file__).parents[2]
    done = subprocess.run(
        command, cwd=root, env={**os.environ, **switches}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout.strip() == RIG


# What is refused


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("mesh", {"mesh": "cube"}),
        ("mesh", {"mesh": models}),
        ("count", {"count": 5}),
        ("count", {"count": 0}),
        ("count", {"count": 9.5}),
        ("count", {"count": "9"}),
        ("count", {"count": True}),
        ("count", {"count": 64}),
        ("size", {"size": 0}),
        ("size", {"size": 4097}),
        ("size", {"size": 1.5}),
        ("mesh.vertices", {"mesh": Mesh(vertices=[(1, 2, 3)], triangles=[(0, 0, 0)])}),
        ("mesh.vertices", {"mesh": Mesh(vertices=[(1e9, 0, 0), (1e9, 0, 1e-3)], triangles=[(0, 1, 1)])}),
        ("mesh.vertices", {"mesh": Mesh(vertices=[(0, 0, 0), (1e200, 0, 0)], triangles=[(0, 1, 1)])}),
    ],
)
def test_bad_arguments_are_named(field: str, arguments: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=rf"^{field}: found .*allowed: [^\n]*$"):
        models.depth_rig(**{"mesh": CUBE, **arguments})
