"""Triangles that reach far out of the picture, or through the near plane, against the projection of each pixel."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.pipeline.rasterizer import draw

WIDTH, HEIGHT = 20, 12
SLACK = 1 / 128
"""Pixels. Snapping moves each corner, and so every point of an edge, by at most 1/512 along x and y; clipped corners,
up to 2^20 pixels away, are rounded to 2^-30 pixels: whoever is farther than this from all edges must be right."""


def truth(clip: NDArray[np.float64]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(surely covered, surely not covered) for each pixel, from the clip coordinates (3, 4) of one triangle.

    The point of the triangle's plane that projects to window (x, y) has the weights b with sum b_i (x_i, y_i, w_i)
    proportional to (x_ndc, y_ndc, 1): no clipping is needed to find it.
    """
    yes, no = np.ones((HEIGHT, WIDTH), bool), np.ones((HEIGHT, WIDTH), bool)
    inverse = np.linalg.inv(clip[:, [0, 1, 3]].T)
    for dx in (-SLACK, 0.0, SLACK):
        for dy in (-SLACK, 0.0, SLACK):
            x, y = np.meshgrid(np.arange(WIDTH) + 0.5 + dx, np.arange(HEIGHT) + 0.5 + dy)
            ndc = np.stack([2 * x / WIDTH - 1, 1 - 2 * y / HEIGHT, np.ones_like(x)])
            b = np.einsum("ij,jyx->iyx", inverse, ndc)
            z = np.einsum("iyx,i->yx", b, clip[:, 2])  # as w = sum b_i w_i = 1
            inside = (b >= 0).all(axis=0) & (z >= 0) & (z <= 1)
            yes &= inside
            no &= ~inside
    return yes, no


def check(clip: NDArray[np.float64]) -> int:
    """Compare one triangle; the number of pixels that it surely covers."""
    drawing = draw(clip, [(0, 1, 2)], WIDTH, HEIGHT)
    yes, no = truth(clip)
    assert drawing.count.max() <= 1, "the fan's own edges are drawn once"
    assert (drawing.count[yes] == 1).all()
    assert (drawing.count[no] == 0).all()
    assert (yes | no).mean() > 0.9, "the comparison must not be empty"
    covered = drawing.count == 1
    assert (drawing.depth[covered] >= 0).all()
    assert (drawing.depth[covered] <= 1).all()
    return int(yes.sum())


@pytest.mark.parametrize("reach", [1e2, 1e4, 1e6, 1e8])
def test_corners_far_outside_the_picture_do_not_move_its_pixels(reach: float) -> None:
    rng = np.random.RandomState(1)
    seen = 0
    for _ in range(12):
        angles = rng.uniform(0, 2 * np.pi) + np.array([0.0, 2.1, 4.2]) + rng.uniform(-0.5, 0.5, 3)
        w = rng.uniform(0.5, 2.0, 3)
        offset = rng.uniform(-1, 1, 2)
        clip = np.stack(
            [w * (offset[0] + reach * np.cos(angles)), w * (offset[1] + reach * np.sin(angles)), w * 0.5, w], axis=1
        )
        clip[rng.randint(3), :2] = rng.uniform(-0.9, 0.9, 2)  # one corner in the picture
        seen += check(clip)
    assert seen > 100


@pytest.mark.parametrize("reach", [1e12, 1e30, 1e200])
def test_the_edge_functions_of_any_finite_triangle_fit_into_64_bits(reach: float) -> None:
    """|window| <= 2^20 pixels around the picture's centre: products of two differences stay below 2^58.

    Where an edge of so long a triangle runs is another matter: from about 1e13 pixels on float64 has lost it.
    """
    corners = [(-reach, -reach, 0.5, 1.0), (reach, -reach, 0.5, 1.0), (0.0, reach, 0.5, 1.0)]
    drawing = draw(corners, [(0, 1, 2), (0, 2, 1)], WIDTH, HEIGHT)
    largest = 256 * (2**20 + max(WIDTH, HEIGHT))
    assert np.abs(drawing.triangles.x).max() <= largest
    assert np.abs(drawing.triangles.y).max() <= largest
    assert drawing.count.max() <= 2
    if reach <= 1e12:
        assert (drawing.count == 2).all(), "both cover the whole picture"


def test_a_pair_of_huge_triangles_covers_each_pixel_once() -> None:
    """Their common edge runs through the picture, clipped at the guard band from either side."""
    a, b = (-3e9, -1.1e9, 0.5, 1.0), (5e9, 2e9, 0.5, 1.0)
    c, d = (-4e9, 6e9, 0.5, 1.0), (3e9, -7e9, 0.5, 1.0)
    for second in ((0, 1, 3), (1, 0, 3), (3, 0, 1)):
        assert (draw([a, b, c, d], [(0, 1, 2), second], WIDTH, HEIGHT).count == 1).all()


def perspective(points: NDArray[np.float64], near: float, far: float) -> NDArray[np.float64]:
    """Clip coordinates of view-space points; focal length 1 in half heights."""
    x, y, z = points.T
    return np.stack([x * HEIGHT / WIDTH, y, (far * z + near * far) / (near - far), -z], axis=1)


def test_triangles_through_the_near_plane_show_their_front_part_only() -> None:
    rng = np.random.RandomState(2)
    seen = behind = 0
    for _ in range(60):
        clip = perspective(rng.uniform(-2.5, 2.5, (3, 3)), 0.125, 100.0)
        if (clip[:, 2] < 0).all():
            assert draw(clip, [(0, 1, 2)], WIDTH, HEIGHT).count.sum() == 0
        elif (clip[:, 2] < 0).any():
            behind += 1
            seen += check(clip)
    assert behind > 20
    assert seen > 500


def test_triangles_through_the_far_plane_end_there() -> None:
    rng = np.random.RandomState(3)
    seen = 0
    for _ in range(30):
        points = rng.uniform(-2.5, 2.5, (3, 3))
        points[:, 2] = rng.uniform(-3.0, -0.2, 3)
        seen += check(perspective(points, 0.125, 1.5))
    assert seen > 400


def test_a_mesh_through_the_near_plane_has_no_cracks() -> None:
    """A plane under the camera, from behind it to the far plane, in many triangles: one layer wherever it is seen."""
    lines = np.array([-3.0, -1.3, 0.1, 0.77, 2.9])
    depths = np.array([2.0, -0.1, -0.5, -1.9, -7.0])
    points = np.array([(x, -0.4, z) for z in depths for x in lines])
    indices = []
    for i in range(4):
        for j in range(4):
            a, c = 5 * i + j, 5 * i + j + 5
            indices += [(a, a + 1, c + 1), (a, c + 1, c)]
    drawing = draw(perspective(points, 0.125, 100.0), indices, WIDTH, HEIGHT)
    assert drawing.count.max() == 1
    y_ndc = 1 - 2 * (np.arange(HEIGHT) + 0.5) / HEIGHT
    below = y_ndc < -0.4 / 7.0
    seen = below & (-0.4 / np.minimum(y_ndc, -1e-9) > 0.125)
    x_view = (2 * (np.arange(WIDTH) + 0.5) / WIDTH - 1) * WIDTH / HEIGHT * (-0.4 / np.minimum(y_ndc, -1e-9))[:, None]
    inside = seen[:, None] & (x_view > -2.99) & (x_view < 2.89)
    assert inside.sum() > 60
    assert (drawing.count[inside] == 1).all()
