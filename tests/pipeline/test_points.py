"""Splats: who covers what in exact fractions, the depth test in order, and the same buffers however the list is cut."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

from ibr_ref.pipeline.points import BAND_ROWS, Splats, Target, draw_splats, target_for

WIDTH, HEIGHT = 19, 2 * BAND_ROWS + 5
"""Three bands of rows, the last one short."""

Splat = tuple[float, float, float, float]
"""Window x and y, width, depth."""

pytestmark = pytest.mark.usefixtures("one_thread")

derandomized = settings(derandomize=True, deadline=None, max_examples=200)


def drawn(splats: list[Splat], *, disc: bool = False, base: int = 0, target: Target | None = None,
          width: int = WIDTH, height: int = HEIGHT) -> Target:  # fmt: skip
    """Draw a list into new buffers, or into those given."""
    table = np.array(splats, np.float64).reshape(-1, 4)
    target = target_for(width, height, True) if target is None else target
    x, y, width, depth = (column.copy() for column in table.T)
    draw_splats(Splats(x, y, depth, width), disc, base, target)
    return target


def snapped(x: float) -> Fraction:
    """To the nearest 256th, ties to even, in exact arithmetic."""
    return Fraction(round(256 * Fraction(x)), 256)


def squares(center: float, width: float, size: int) -> dict[int, Fraction]:
    """(i + 1/2 - c)^2 of the pixels of an axis whose centres lie in [c - w/2, c + w/2), in exact arithmetic."""
    half, off = Fraction(width) / 2, Fraction(1, 2) - snapped(center)
    return {i: (i + off) ** 2 for i in range(size) if -half <= i + off < half}


def covered(x: float, y: float, width: float, disc: bool) -> NDArray[np.bool_]:
    """(H, W) the pixels that a splat covers, in exact arithmetic."""
    result = np.zeros((HEIGHT, WIDTH), bool)
    limit = Fraction(width) ** 2 / 4
    across = squares(x, width, WIDTH)
    for row, dy2 in squares(y, width, HEIGHT).items():
        result[row, [column for column, dx2 in across.items() if not disc or dx2 + dy2 <= limit]] = True
    return result


# 256ths and half-256ths: centres and borders of pixels, and ties of the snapping; all exact in float64.
lattice_x = st.integers(-4 * 512, (WIDTH + 4) * 512).map(lambda k: k / 512)
lattice_y = st.integers(-4 * 512, (HEIGHT + 4) * 512).map(lambda k: k / 512)
anywhere_x = st.floats(-4.0, WIDTH + 4.0)
anywhere_y = st.floats(-4.0, HEIGHT + 4.0)
xs, ys = st.one_of(lattice_x, anywhere_x), st.one_of(lattice_y, anywhere_y)
dyadic = st.integers(0, 12 * 128).map(lambda k: k / 128)
widths = st.one_of(dyadic, st.sampled_from([0.0, 1.0, 2.0, 3.0, 0.5, 100.0]))
"""In 128ths, so that the borders of a square are exact in float64: borders fall on the centres of pixels."""


# Coverage


@derandomized
@given(xs, ys, widths)
def test_a_square_covers_the_centres_within_half_open_borders(x: float, y: float, width: float) -> None:
    assert_array_equal(drawn([(x, y, width, 0.5)]).overdraw, covered(x, y, width, disc=False))


@derandomized
@given(xs, ys, widths)
def test_a_disc_covers_the_centres_within_its_radius_inside_the_square(x: float, y: float, width: float) -> None:
    assert_array_equal(drawn([(x, y, width, 0.5)], disc=True).overdraw, covered(x, y, width, disc=True))


@derandomized
@given(lattice_x, lattice_y, st.integers(0, WIDTH - 1), st.booleans(), st.sampled_from([-1, 0, 1]))
def test_borders_through_the_centre_of_a_pixel(x: float, y: float, column: int, disc: bool, more: int) -> None:
    """And 1/256 beside it: the half-open rule and every tie of the snapping decide about a whole column."""
    width = max(0.0, 2.0 * abs(column + 0.5 - x) + more / 128)
    assert_array_equal(drawn([(x, y, width, 0.5)], disc=disc).overdraw, covered(x, y, width, disc))


@derandomized
@given(xs, ys, st.floats(0.0, 30.0), st.booleans())
def test_any_width_to_the_rounding_of_the_borders(x: float, y: float, width: float, disc: bool) -> None:
    """Borders of other widths are rounded twice, by 2^-48 pixel at most below 64; the slack moves them by 2^-46.

    A disc's dx^2 + dy^2, up to 2 r^2, has a relative error of 4 2^-53, r^2 2^-50 in all; the slack makes r 2^-45 of r^2.
    """
    count = drawn([(x, y, width, 0.5)], disc=disc).overdraw
    slack = 2.0**-45
    inner = covered(x, y, max(0.0, width - slack), disc)
    outer = covered(x, y, width + slack, disc)
    assert (count[inner] == 1).all()
    assert (count[~outer] == 0).all()


@pytest.mark.parametrize(
    ("x", "width", "columns"),
    [
        (2.5, 1.0, [2]),  # [2, 3) holds the centre 2.5
        (2.0, 1.0, [1]),  # [1.5, 2.5): the left border counts, the right one does not
        (3.0, 1.0, [2]),
        (3.0, 2.0, [2, 3]),  # [2, 4)
        (2.5, 2.0, [1, 2]),  # [1.5, 3.5)
        (2.5, 0.0, []),  # a half-open interval of no length holds nothing
        (2.5, 2.0**-7, [2]),
        (2.0, 2.0**-7, []),
        (2.5 + 1 / 512, 2.0**-8, [2]),  # 2.5 is 640/256, even: ties go there
        (2.5 + 3 / 512, 2.0**-7, []),  # up to 642/256: [2.50390625, ...)
        (2.5 - 1 / 512, 2.0**-8, [2]),  # up to 640/256
        (2.5 + 1 / 256, 2.0**-7, [2]),  # [2.5, ...)
        (2.5 - 1 / 256, 2.0**-7, []),  # [..., 2.5)
    ],
)
def test_an_axis_by_hand(x: float, width: float, columns: list[int]) -> None:
    """Every column and every row alike."""
    across = drawn([(x, 4.5, width, 0.5)]).overdraw
    assert np.flatnonzero(across.any(axis=0)).tolist() == columns
    along = drawn([(4.5, x, width, 0.5)]).overdraw
    assert np.flatnonzero(along.any(axis=1)).tolist() == columns


def test_squares_side_by_side_cover_everything_once() -> None:
    """Centres one width apart, at any offset: neither a gap nor an overlap. Snapping does not move the lattice."""
    for offset in (0.0, 0.25, 0.5, 1 / 256, 255 / 256):
        for width in (1.0, 1.5, 2.0, 3.25):
            steps = range(-2, 40)
            lattice = [(offset + i * width, offset + j * width, width, 0.5) for i in steps for j in steps]
            assert (drawn(lattice).overdraw == 1).all(), (offset, width)


def test_discs_by_hand() -> None:
    """Radius 1: the pixels to the left and above lie at exactly 1; those to the right and below are not in the square."""
    assert drawn([(4.5, 5.5, 1.0, 0.5)], disc=True).overdraw.sum() == 1
    three = drawn([(4.5, 5.5, 2.0, 0.5)], disc=True).overdraw
    assert np.argwhere(three).tolist() == [[4, 4], [5, 3], [5, 4]]
    nine = drawn([(4.5, 5.5, 3.0, 0.5)], disc=True).overdraw  # corners at sqrt(2) < 1.5
    assert nine[4:7, 3:6].all()
    assert nine.sum() == 9


# What is far, wide, or not a number


FAR = [-1e300, -1e19, -(2.0**63), -(2.0**31), -1e5, 1e5, 2.0**31, 2.0**63, 1e19, 1e300, np.inf, -np.inf, np.nan]


@pytest.mark.parametrize("disc", [False, True])
@pytest.mark.parametrize("x", FAR)
def test_splats_far_outside_cover_nothing(x: float, disc: bool) -> None:
    for place in ((x, 4.5), (4.5, x), (x, x), (x, -x)):
        target = drawn([(*place, 64.0, 0.5)], disc=disc)
        assert (target.splat == -1).all()
        assert (target.depth == 1.0).all()
        assert (target.overdraw == 0).all()
        assert np.isinf(target.second).all()


@pytest.mark.parametrize("width", [2.0**20, 2.0**31, 1e19, 1e150])
def test_splats_of_any_width_cover_the_whole_picture(width: float) -> None:
    for disc in (False, True):
        assert (drawn([(4.5, 4.5, width, 0.5)], disc=disc).overdraw == 1).all()
    assert (drawn([(-width / 4, width / 4, width, 0.5)]).overdraw == 1).all()


def test_a_nan_width_covers_nothing() -> None:
    assert (drawn([(4.5, 4.5, np.nan, 0.5)]).overdraw == 0).all()


@pytest.mark.parametrize("disc", [False, True])
def test_splats_over_every_border_and_corner(disc: bool) -> None:
    for x in (-3.0, -1.0, 0.0, 9.5, WIDTH, WIDTH + 1.0, WIDTH + 3.0):
        for y in (-3.0, -1.0, 0.0, BAND_ROWS, HEIGHT, HEIGHT + 1.0, HEIGHT + 3.0):
            count = drawn([(x, y, 6.0, 0.5)], disc=disc).overdraw
            assert_array_equal(count, covered(x, y, 6.0, disc), err_msg=f"{x}, {y}")


# Depth test


def in_order(splats: list[Splat], disc: bool) -> tuple[NDArray[Any], ...]:
    """Winner, depth, overdraw and second by definition: all the splats of a pixel, sorted by depth, then by index."""
    splat, depth = np.full((HEIGHT, WIDTH), -1), np.ones((HEIGHT, WIDTH))
    overdraw, second = np.zeros((HEIGHT, WIDTH), int), np.full((HEIGHT, WIDTH), np.inf)
    masks = [covered(x, y, w, disc) for x, y, w, _ in splats]
    for row in range(HEIGHT):
        for column in range(WIDTH):
            found = sorted((splats[i][3], i) for i, mask in enumerate(masks) if mask[row, column])
            overdraw[row, column] = len(found)
            if found and found[0][0] < 1.0:
                depth[row, column], splat[row, column] = found[0]
            if len(found) > 1:
                second[row, column] = found[1][0]
    return splat, depth, overdraw, second


def compare(target: Target, expected: tuple[NDArray[Any], ...]) -> None:
    for name, array in zip(("splat", "depth", "overdraw", "second"), expected[:4], strict=True):
        assert_array_equal(getattr(target, name), array, err_msg=name)


depths = st.sampled_from([0.0, 0.25, 0.25, 0.5, 0.5 + 2.0**-52, 1.0])
lists = st.lists(st.tuples(xs, ys, st.sampled_from([0.0, 0.5, 1.0, 3.0, 7.5, 60.0]), depths), min_size=1, max_size=12)


@settings(derandomized, max_examples=60)
@given(lists, st.booleans())
def test_the_nearest_wins_and_of_ties_the_first(splats: list[Splat], disc: bool) -> None:
    compare(drawn(splats, disc=disc), in_order(splats, disc))


@derandomized
@given(lists, st.booleans(), st.data())
def test_any_cut_of_the_list_gives_the_same_buffers(splats: list[Splat], disc: bool, data: Any) -> None:
    cuts = sorted(data.draw(st.lists(st.integers(0, len(splats)), max_size=4)))
    parts = target_for(WIDTH, HEIGHT, True)
    for first, stop in zip([0, *cuts], [*cuts, len(splats)], strict=True):
        drawn(splats[first:stop], disc=disc, base=first, target=parts)
    compare(parts, drawn(splats, disc=disc))


@derandomized
@given(lists, st.booleans())
def test_without_the_buffers_of_the_stages_the_same_winners(splats: list[Splat], disc: bool) -> None:
    bare = drawn(splats, disc=disc, target=target_for(WIDTH, HEIGHT, False))
    kept = drawn(splats, disc=disc)
    assert_array_equal(bare.splat, kept.splat)
    assert_array_equal(bare.depth, kept.depth)
    assert bare.overdraw.shape == bare.second.shape == (0, WIDTH)


@derandomized
@given(lists, st.randoms(use_true_random=False))
def test_the_order_of_the_list_matters_to_ties_alone(splats: list[Splat], random: Any) -> None:
    order = list(range(len(splats)))
    random.shuffle(order)
    here, there = drawn(splats), drawn([splats[i] for i in order])
    for name in ("depth", "overdraw", "second"):
        assert_array_equal(getattr(there, name), getattr(here, name), err_msg=name)
    certain = (here.splat >= 0) & (here.second > here.depth)
    assert_array_equal(np.array(order)[there.splat[certain]], here.splat[certain])


def test_a_depth_of_1_covers_and_never_wins() -> None:
    target = drawn([(4.5, 4.5, 3.0, 1.0), (4.5, 4.5, 1.0, 1.0)])
    assert (target.splat == -1).all()
    assert target.overdraw.sum() == 10
    assert target.second[4, 4] == 1.0


def test_indices_start_at_the_base() -> None:
    splats = [(4.5, 4.5, 1.0, 0.5), (6.5, 4.5, 1.0, 0.5)]
    target = drawn(splats, base=2**31 - 2)
    assert target.splat[4, [4, 6]].tolist() == [2**31 - 2, 2**31 - 1]
    drawn(splats, base=0, target=target)
    assert target.splat[4, [4, 6]].tolist() == [2**31 - 2, 2**31 - 1], "on a tie what was drawn before stays"


def test_no_splats() -> None:
    target = drawn([])
    assert (target.splat == -1).all()


@pytest.mark.parametrize(
    ("width", "height"), [(1, 1), (3, 1), (1, 50), (40, BAND_ROWS), (2, 8 * BAND_ROWS), (2, 8 * BAND_ROWS + 1)]
)
def test_pictures_of_any_number_of_bands(width: int, height: int) -> None:
    """Each pixel its own splat, the last column and row as well; the order of the bands leaves none out."""
    splats = [(x + 0.5, y + 0.5, 1.0, 0.5) for y in range(height) for x in range(width)]
    target = drawn(splats, width=width, height=height)
    assert_array_equal(target.splat, np.arange(width * height).reshape(height, width))


def test_many_splats_on_two_threads_are_those_of_one() -> None:
    """Enough for every part of the list and every band to have some; half of the depths tie."""
    random = np.random.RandomState(0)
    table = np.stack([random.uniform(-5, 205, 20000), random.uniform(-5, 155, 20000), random.uniform(0, 9, 20000),
                      np.floor(random.uniform(0, 8, 20000)) / 8], axis=1)  # fmt: skip
    splats = [tuple(row) for row in table.tolist()]
    one = drawn(splats, width=200, height=150)  # type: ignore[arg-type]
    numba.set_num_threads(min(2, numba.config.NUMBA_NUM_THREADS))
    two = drawn(splats, width=200, height=150)  # type: ignore[arg-type]
    compare(two, tuple(one))
    assert (one.overdraw > 5).mean() > 0.9
