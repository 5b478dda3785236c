"""Triangles: who covers which pixel, and the values there, against exact arithmetic."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from tests.pipeline.rasterizer import Point, at_window, covered, draw, edge

SIZE = 16
ULP = 2.0**-52
LEAST = Fraction(1, 2**1074)
derandomized = settings(derandomize=True, deadline=None, max_examples=60)

anywhere = st.integers(-400, 256 * SIZE + 400)
on_centres = st.integers(-2, 2 * SIZE + 2).map(lambda k: 128 * k)  # corners and edges through pixel centres: ties
points = st.tuples(st.one_of(on_centres, anywhere), st.one_of(on_centres, anywhere))


def count(corners: list[Point], indices: list[tuple[int, int, int]]) -> np.ndarray:
    return draw(at_window(corners, SIZE), indices, SIZE, SIZE).count


@derandomized
@given(st.lists(points, min_size=3, max_size=3))
def test_a_triangle_covers_the_centres_that_exact_integers_say(corners: list[Point]) -> None:
    assert_array_equal(count(corners, [(0, 1, 2)]), covered(corners, SIZE, SIZE))


@derandomized
@given(st.lists(points, min_size=3, max_size=3))
def test_neither_orientation_nor_first_corner_matters(corners: list[Point]) -> None:
    first = count(corners, [(0, 1, 2)])
    for indices in ((1, 2, 0), (2, 0, 1), (2, 1, 0), (1, 0, 2), (0, 2, 1)):
        assert_array_equal(count(corners, [indices]), first)


@derandomized
@given(st.lists(points, min_size=4, max_size=4), st.booleans())
def test_triangles_that_share_an_edge_cover_each_pixel_exactly_once(corners: list[Point], same_way: bool) -> None:
    a, b, c, d = corners
    assume(edge(a, b, c) * edge(a, b, d) < 0)
    drawn = count(corners, [(0, 1, 2), (0, 1, 3) if same_way else (1, 0, 3)])
    assert drawn.max() <= 1
    for row, column in np.argwhere(drawn == 0):
        centre = (256 * int(column) + 128, 256 * int(row) + 128)
        strictly_between = min(a, b) < centre < max(a, b)
        assert not (edge(a, b, centre) == 0 and strictly_between), "a hole in the shared edge"


@derandomized
@given(st.lists(points, min_size=3, max_size=3), st.lists(st.integers(1, 9), min_size=3, max_size=3))
def test_a_triangle_cut_at_an_inner_point_covers_what_it_covered(corners: list[Point], weights: list[int]) -> None:
    a, b, c = corners
    p = tuple(
        sum(w * corner[axis] for w, corner in zip(weights, corners, strict=True)) // sum(weights) for axis in (0, 1)
    )
    sides = edge(a, b, p), edge(b, c, p), edge(c, a, p)
    assume(all(s > 0 for s in sides) or all(s < 0 for s in sides))
    parts = count([*corners, p], [(0, 1, 3), (1, 2, 3), (2, 0, 3)])
    assert_array_equal(parts, count(corners, [(0, 1, 2)]))


def test_a_grid_of_triangles_covers_the_picture_exactly_once() -> None:
    """Corners on pixel centres, on pixel corners and in between; the diagonals through centres as well."""
    rng = np.random.RandomState(0)
    lines = [np.unique([0, 4096, *128 * rng.randint(1, 32, 12), *rng.randint(1, 4096, 5)]).tolist() for _ in range(2)]
    corners = [(x, y) for y in lines[1] for x in lines[0]]
    indices = []
    for i in range(len(lines[1]) - 1):
        for j in range(len(lines[0]) - 1):
            a = i * len(lines[0]) + j
            c = a + len(lines[0])
            indices += [(a, a + 1, c + 1), (a, c + 1, c)] if rng.randint(2) else [(c, a, a + 1), (a + 1, c, c + 1)]
    assert (count(corners, indices) == 1).all()


def test_window_coordinates_that_are_ties_snap_to_even() -> None:
    """The window is 16 pixels wide: x_ndc = (n + 1/2)/2048 - 1 lies exactly between n and n + 1 256ths."""
    halves = [0, 1, 2, 3, 100, 101, 4094, 4095, -1, -2, -3]
    clip = [((n + 0.5) / 2048 - 1, 1 - (n + 0.5) / 2048, 0.5, 1.0) for n in halves]
    triangles = draw(clip, [(i, i, i) for i in range(len(halves))], SIZE, SIZE).triangles
    even = [n if n % 2 == 0 else n + 1 for n in halves]
    assert triangles.x[:, 0].tolist() == even
    assert triangles.y[:, 0].tolist() == even


@derandomized
@given(st.lists(st.tuples(*[st.floats(-3.0, 3.0)] * 2, st.floats(0.25, 8.0)), min_size=3, max_size=3))
def test_window_coordinates_are_rounded_to_the_nearest_256th(corners: list[tuple[float, float, float]]) -> None:
    triangles = draw([(x, y, 0.1, w) for x, y, w in corners], [(0, 1, 2)], 640, 480).triangles
    for corner, (x, y, w) in enumerate(corners):
        assert triangles.x[0, corner] == round(256.0 * ((x / w + 1.0) / 2.0 * 640.0))
        assert triangles.y[0, corner] == round(256.0 * ((1.0 - y / w) / 2.0 * 480.0))


@pytest.mark.parametrize(
    "corners",
    [
        [(700, 700), (700, 700), (700, 700)],
        [(128, 128), (128, 128), (3968, 3968)],
        [(128, 128), (1152, 1152), (3968, 3968)],
        [(128, 128), (3968, 128), (1152, 128)],
        [(384, 3968), (384, 128), (384, 1152)],
    ],
    ids=["a point", "two corners", "collinear", "on a row of centres", "on a column of centres"],
)
def test_a_triangle_without_area_covers_nothing(corners: list[Point]) -> None:
    assert count(corners, [(0, 1, 2)]).sum() == 0


def test_a_triangle_whose_area_vanishes_in_snapping_covers_nothing() -> None:
    """Three corners on the diagonal through the centres, one off it by 2^-12 pixel."""
    clip = np.array(at_window([(128, 128), (3968, 3968), (1152, 1152)], SIZE))
    clip[2, 0] += 2.0**-12 / SIZE
    assert draw(clip, [(0, 1, 2)], SIZE, SIZE).count.sum() == 0


@pytest.mark.parametrize("thickness", [1, 2, 3])
@pytest.mark.parametrize("across", [(1, 0), (0, 1)])
def test_slivers_of_one_256th_cover_the_centres_in_them(thickness: int, across: Point) -> None:
    a, b = (128, 128), (3968, 3967)
    corners = [a, b, (b[0] - thickness * across[0], b[1] - thickness * across[1])]
    expected = covered(corners, SIZE, SIZE)
    assert_array_equal(count(corners, [(0, 1, 2)]), expected)
    other = [a, b, (b[0] + thickness * across[0], b[1] + thickness * across[1])]
    both = count([*corners, other[2]], [(0, 1, 2), (0, 1, 3)])
    assert both.max() == 1, "the two slivers share their long side, which runs close by all centres of the diagonal"
    assert_array_equal(both, expected + covered(other, SIZE, SIZE))


def exact_weights(corners: list[Point], column: int, row: int) -> list[int]:
    """E_0, E_1, E_2 of the pixel, positive inside."""
    p = (256 * column + 128, 256 * row + 128)
    sign = 1 if edge(*corners) > 0 else -1
    a, b, c = corners
    return [sign * edge(b, c, p), sign * edge(c, a, p), sign * edge(a, b, p)]


@settings(derandomized, max_examples=25)
@given(
    st.lists(st.tuples(*[st.floats(-1.5, 1.5)] * 2, st.floats(0.125, 8.0)), min_size=3, max_size=3),
    st.lists(st.floats(1e-3, 1e3), min_size=3, max_size=3),
    st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3),
)
@example([(0.0, 0.0, 1.0), (0.0, 1.0, 1.0), (1.5, 0.0, 1.0)], [1.0] * 3, [0.0, 0.0, 2.0**-1023])
def test_varyings_are_perspective_correct_to_the_last_bits(
    corners: list[tuple[float, float, float]], values: list[float], depths: list[float]
) -> None:
    """(sum E a/w)/(sum E/w) in rational numbers. All terms are positive, so that the relative error is at most that of
    the eight rounded operations on the longest path, 2^-53 each: 4 ulp. (Depth: six; where it is subnormal, each is
    of half the least number.)
    """
    clip = [(x * w, y * w, z * w, w) for (x, y, w), z in zip(corners, depths, strict=True)]
    drawing = draw(clip, [(0, 1, 2)], SIZE, SIZE, np.array(values)[:, None])
    assume(drawing.count.any())
    window = [
        (round(256.0 * ((x / w + 1.0) / 2.0 * SIZE)), round(256.0 * ((1.0 - y / w) / 2.0 * SIZE)))
        for x, y, _, w in clip
    ]
    w = [Fraction(p[3]) for p in clip]
    for row, column in np.argwhere(drawing.count):
        e = exact_weights(window, int(column), int(row))
        over_w = sum(e[i] / w[i] for i in range(3))
        value = sum(e[i] * Fraction(values[i]) / w[i] for i in range(3)) / over_w
        depth = sum(e[i] * Fraction(clip[i][2]) / w[i] for i in range(3)) / sum(e)
        assert abs(Fraction(drawing.varyings[0, row, column]) - value) <= 4 * ULP * value
        assert abs(Fraction(drawing.depth[row, column]) - depth) <= 4 * Fraction(ULP) * depth + 6 * LEAST


def test_a_varying_that_is_the_same_at_all_corners_is_the_same_everywhere() -> None:
    """To 4 ulp (0 and 1 exactly); and where the corners have the same w, varyings are linear in the window."""
    clip = [(-2.0, -2.0, 0.5, 1.0), (9.0, -2.0, 3.0, 4.0), (0.0, 30.0, 1.0, 9.0)]
    drawing = draw(clip, [(0, 1, 2)], 64, 48, [[0.7, 1.0, 0.0]] * 3)
    inside = drawing.count == 1
    assert inside.any()
    assert (drawing.varyings[1][inside] == 1.0).all()
    assert (drawing.varyings[2][inside] == 0.0).all()
    np.testing.assert_allclose(drawing.varyings[0][inside], 0.7, rtol=4 * ULP)
    flat = draw(at_window([(0, 0), (8192, 0), (0, 8192)], SIZE), [(0, 1, 2)], SIZE, SIZE, [[0.0], [32.0], [0.0]])
    assert_array_equal(flat.varyings[0], np.broadcast_to(np.arange(SIZE) + 0.5, (SIZE, SIZE)))
