"""Clipping, against the same polygons cut in rational numbers."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from ibr_ref.pipeline.clip import ClippedTriangles, clip_triangles

derandomized = settings(derandomize=True, deadline=None, max_examples=60)

Corner = tuple[float, float, float, float]
Exact = list[Fraction]

WIDTH, HEIGHT = 64, 32
GUARD_X, GUARD_Y = 2**21 // WIDTH, 2**21 // HEIGHT


def clip(corners: list[Corner], indices: object = ((0, 1, 2),), varyings: object = None) -> ClippedTriangles:
    values = np.zeros((len(corners), 1)) if varyings is None else np.array(varyings, np.float64)
    return clip_triangles(np.array(corners, np.float64), values, np.array(indices, np.int32), WIDTH, HEIGHT)


def cut(polygon: list[Exact], plane: list[int]) -> list[Exact]:
    """The part of a convex polygon where x, y, z, w times `plane` is >= 0."""
    result = []
    for here, there in pairwise([*polygon, polygon[0]] if polygon else []):
        d_here, d_there = (sum(a * b for a, b in zip(plane, p, strict=False)) for p in (here, there))
        if d_here >= 0:
            result.append(here)
        if d_here * d_there < 0 or (d_here < 0 and d_there == 0) or (d_here == 0 and d_there < 0):
            result.append([(a * d_there - b * d_here) / (d_there - d_here) for a, b in zip(here, there, strict=True)])
    return result


def clipped(corners: list[Corner], values: list[float]) -> list[Exact]:
    """The polygon that is left of a triangle, its varying as fifth component."""
    polygon = [[Fraction(x) for x in (*corner, value)] for corner, value in zip(corners, values, strict=True)]
    for plane in ([0, 0, 1, 0], [0, 0, -1, 1]):
        polygon = cut(polygon, plane)
    if any(abs(p[0]) > GUARD_X * p[3] or abs(p[1]) > GUARD_Y * p[3] for p in polygon):
        for plane in ([1, 0, 0, GUARD_X], [-1, 0, 0, GUARD_X], [0, 1, 0, GUARD_Y], [0, -1, 0, GUARD_Y]):
            polygon = cut(polygon, plane)
    return polygon


quarters = st.integers(-12, 12).map(lambda k: k / 4)
depths = st.integers(-8, 16).map(lambda k: k / 4)
weights = st.integers(1, 8).map(lambda k: k / 4)
huge = st.integers(-12, 12).map(lambda k: k * 2.0**18)
corners_near = st.tuples(quarters, quarters, depths, weights)
corners_far = st.tuples(huge, huge, depths, weights)


@derandomized
@given(
    st.lists(st.one_of(corners_near, corners_far), min_size=3, max_size=3), st.lists(quarters, min_size=3, max_size=3)
)
def test_what_is_left_is_the_polygon_cut_in_rational_numbers(corners: list[Corner], values: list[float]) -> None:
    """Near, far, then the guard band, fanned from the first vertex. The distances from the near and far plane are exact
    here, later ones carry the crossings' rounding: 2^-53 of the largest number, doubled by each of six planes at most.
    """
    expected = clipped(corners, values)
    result = clip(corners, varyings=np.array(values)[:, None])
    assume(not any(a == b for a, b in pairwise([*expected, *expected[:1]])))  # a corner on a plane: doubled by rounding
    assert len(result.source) == max(0, len(expected) - 2)
    for fan, (corner, value) in enumerate(zip(result.clip, result.varyings, strict=True)):
        for got, wanted in zip(
            np.concatenate([corner, value], axis=1), (expected[0], *expected[fan + 1 : fan + 3]), strict=True
        ):
            np.testing.assert_allclose(
                got, [float(x) for x in wanted], rtol=0, atol=64 * 2.0**-53 * np.abs(corners).max()
            )


def test_a_triangle_inside_keeps_its_bits() -> None:
    corners = [(0.1, -0.7, 0.0, 1.0), (5.5, 0.3, 3.0, 3.0), (-1e4, 2.0, 0.3, 1.1)]
    result = clip(corners, varyings=[[0.1], [0.2], [0.3]])
    assert_array_equal(result.clip[0], corners)
    assert_array_equal(result.varyings[0], [[0.1], [0.2], [0.3]])


@pytest.mark.parametrize("z", [-1e-300, -1.0, 1.0000000000000002, 7.0])
def test_a_triangle_beyond_a_plane_vanishes(z: float) -> None:
    assert len(clip([(0, 0, z, 1), (1, 0, z, 1), (0, 1, z, 1)]).source) == 0


@pytest.mark.parametrize("z", [0.0, 1.0])
def test_a_triangle_in_a_plane_stays(z: float) -> None:
    assert len(clip([(0, 0, z, 1), (1, 0, z, 1), (0, 1, z, 1)]).source) == 1


anything = st.floats(-4.0, 4.0)
outside = st.tuples(anything, anything, st.floats(-4.0, -0.001), st.floats(-3.0, 4.0))
inside = st.tuples(anything, anything, st.floats(0.001, 0.4), st.floats(0.5, 4.0))


@derandomized
@given(inside, outside, st.one_of(inside, outside), st.one_of(inside, outside))
def test_triangles_that_share_an_edge_get_the_same_crossing(a: Corner, b: Corner, c: Corner, d: Corner) -> None:
    """In whichever direction they run through it, and whatever their third corner: bit for bit."""
    both = {}
    for indices in ((0, 1, 2), (1, 0, 3)):
        result = clip([a, b, c, d], [indices])
        both[indices] = {p.tobytes() for p in result.clip.reshape(-1, 4)}
    t = a[2] / (a[2] - b[2])
    crossing = np.array([x * (1.0 - t) + y * t for x, y in zip(a, b, strict=True)])
    assert crossing.tobytes() in both[0, 1, 2] & both[1, 0, 3]


def test_triangles_keep_their_order_and_name_their_source() -> None:
    """The second is cut into two, the third vanishes."""
    corners = [(0, 0, 0.5, 1), (1, 0, 0.5, 1), (0, 1, 0.5, 1), (0, 0, -0.5, 1), (1, 1, -0.5, 1), (2, 1, -0.5, 1)]
    result = clip(corners, [(0, 1, 2), (1, 2, 3), (3, 4, 5), (2, 1, 0)])
    assert result.source.tolist() == [0, 1, 1, 3]


def test_the_guard_band_begins_beyond_2_to_the_20_pixels() -> None:
    """In ndc 2^21/width; a corner just on it is left alone, one just outside is cut off."""
    on = [(float(GUARD_X), -float(GUARD_Y), 0.5, 1.0), (0.0, 0.0, 0.5, 1.0), (0.0, float(GUARD_Y), 0.5, 1.0)]
    assert_array_equal(clip(on).clip[0], on)
    beyond = [(np.nextafter(GUARD_X, np.inf), 0.0, 0.5, 1.0), *on[1:]]
    result = clip(beyond)
    assert len(result.source) == 2
    assert result.clip[..., 0].max() <= GUARD_X


def test_a_triangle_across_all_six_planes_has_nine_corners() -> None:
    """The plane X + Y + Z = 0 cuts the cube [-1, 1]^3 in a hexagon; the triangle cuts off every other corner of it."""
    cube = 1.9 * np.array([(1, 0, -1), (-1, 1, 0), (0, -1, 1)])
    corners = [(x * GUARD_X, y * GUARD_Y, (z + 1) / 2, 1.0) for x, y, z in cube]
    result = clip(corners)
    assert len(result.source) == 7, "as many as there can be"
    x, y, z, w = np.moveaxis(result.clip, 2, 0)
    for distance in (z, w - z, GUARD_X * w - abs(x), GUARD_Y * w - abs(y)):
        assert distance.min() >= -1e-9 * GUARD_Y, "within rounding of the largest coordinate"


def test_no_triangles_give_no_triangles() -> None:
    result = clip_triangles(np.empty((0, 4)), np.empty((0, 3)), np.empty((0, 3), np.int32), WIDTH, HEIGHT)
    assert result.clip.shape == (0, 3, 4)
    assert result.varyings.shape == (0, 3, 3)
