"""Bézier patches: what they interpolate, what they reproduce, and that they meet."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ibr_ref.io.bezier import tessellate
from tests.io.test_images import small

THIRDS = np.arange(4) / 3.0
FLAT = np.stack([*np.meshgrid(THIRDS, THIRDS, indexing="ij"), np.zeros((4, 4))], axis=2)
"""x along the first axis, y along the second: the parameters themselves."""
PATCHES = arrays(np.float64, (2, 4, 4, 3), elements=st.floats(-1e6, 1e6))


def grid(patches, quads):
    """(P, quads + 1, quads + 1, 3)."""
    return tessellate(np.asarray(patches), quads)[0].reshape(len(patches), quads + 1, quads + 1, 3)


def de_casteljau(points, t):
    """Exactly: corners cut until one is left."""
    while len(points) > 1:
        points = [[(1 - t) * a + t * b for a, b in zip(p, q, strict=True)] for p, q in pairwise(points)]
    return points[0]


@small
@given(patches=PATCHES, quads=st.integers(1, 7))
def test_corners_are_control_points(patches, quads):
    np.testing.assert_array_equal(grid(patches, quads)[:, ::quads, ::quads], patches[:, ::3, ::3])


@small
@given(patches=PATCHES, quads=st.integers(1, 5), place=st.tuples(st.integers(0, 5), st.integers(0, 5)))
def test_every_vertex_is_that_of_de_casteljau(patches, quads, place):
    i, j = place[0] % (quads + 1), place[1] % (quads + 1)
    rows = [[[Fraction(x) for x in point] for point in row] for row in patches[1].tolist()]
    row = [de_casteljau([line[k] for line in rows], Fraction(i, quads)) for k in range(4)]
    expected = [float(x) for x in de_casteljau(row, Fraction(j, quads))]
    np.testing.assert_allclose(grid(patches, quads)[1, i, j], expected, rtol=0, atol=1e-14 * np.abs(patches).max())


@small
@given(patches=PATCHES, quads=st.integers(1, 7))
def test_a_patch_has_the_same_bits_from_any_side(patches, quads):
    """So two that share a border meet without a gap, whichever way they run along it."""
    forwards = grid(patches, quads)
    np.testing.assert_array_equal(grid(patches[:, ::-1], quads)[:, ::-1], forwards)
    np.testing.assert_array_equal(grid(patches[:, :, ::-1], quads)[:, :, ::-1], forwards)
    for side in (0, -1):
        border = grid(np.broadcast_to(patches[:, side, None], patches.shape), quads)[:, 0]
        np.testing.assert_array_equal(forwards[:, side], border)


@pytest.mark.parametrize("quads", [1, 2, 6, 13])
def test_a_flat_patch_is_flat_and_even(quads):
    points = grid([FLAT], quads)[0]
    assert (points[..., 2] == 0.0).all()
    even = np.arange(quads + 1) / quads
    np.testing.assert_allclose(points[..., 0], np.broadcast_to(even[:, None], points.shape[:2]), atol=2e-16)
    np.testing.assert_allclose(points[..., 1], np.broadcast_to(even, points.shape[:2]), atol=2e-16)


def test_cubics_are_reproduced():
    """The control points of t³ are 0, 0, 0, 1, those of t² are 0, 0, 1/3, 1."""
    cubic, square = np.array([0.0, 0, 0, 1]), np.array([0.0, 0, 1 / 3, 1])
    patch = FLAT.copy()
    patch[..., 2] = cubic[:, None] * square
    x, y, z = grid([patch], 8)[0].transpose(2, 0, 1)
    np.testing.assert_allclose(z, x**3 * y**2, atol=1e-15)


@pytest.mark.parametrize("quads", [1, 6])
def test_triangles_cover_the_patch_once_wound_alike(quads):
    vertices, triangles = tessellate(np.stack([FLAT, FLAT + np.array((0, 0, 1))]), quads)
    assert vertices.shape == (2 * (quads + 1) ** 2, 3)
    assert triangles.shape == (4 * quads**2, 3)
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    # Along the first axis, then back by the second: clockwise from +z, as the patches of the teapot have their outside.
    np.testing.assert_allclose(np.cross(b - a, c - a), [[0, 0, -1 / quads**2]] * len(triangles), atol=1e-15)
    assert (vertices[triangles[: 2 * quads**2]][..., 2] == 0.0).all()
    np.testing.assert_allclose(vertices[triangles[2 * quads**2 :]][..., 2], 1.0, rtol=1e-15)


def test_a_border_that_is_one_point_keeps_its_triangles():
    patch = FLAT.copy()
    patch[0] = (0.0, 0.5, 0.0)
    vertices, triangles = tessellate(patch[None], 4)
    assert len(triangles) == 32
    np.testing.assert_array_equal(vertices[:5], [(0.0, 0.5, 0.0)] * 5)
