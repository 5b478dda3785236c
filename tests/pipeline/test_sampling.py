"""Texture fetches, against the sentences of conventions.md, "Texture fetches", in plain Python."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

from tests.pipeline.texels import bilinear, fetch_all, fetch_all_channels, nearest, touch_all

SIZES = [(1, 1), (1, 5), (5, 1), (2, 2), (4, 3), (7, 16), (33, 8)]
HOSTILE = [np.nan, np.inf, -np.inf, 1e300, -1e300, 1e18, -1e18, 2.0**31, -(2.0**31), 2.0**40, 1e10, -1e10, 5e-324, -0.0]

columns_and_rows = pytest.mark.parametrize(("columns", "rows"), SIZES)
wrap_mode = pytest.mark.parametrize("repeat", [None, True], ids=["clamp", "repeat"])


def coordinates(size: int, rng: np.random.RandomState) -> NDArray[np.float64]:
    """Texel centres and borders and their neighbours in float64, and anything from -3 to 4: about two hundred."""
    special = np.concatenate([np.arange(-size, 2 * size + 1) / size, (np.arange(-size, 2 * size) + 0.5) / size])
    neighbours = [np.nextafter(special, -np.inf), special, np.nextafter(special, np.inf)]
    return rng.permutation(np.concatenate([*neighbours, rng.uniform(-3.0, 4.0, 100)]))


def pairs(columns: int, rows: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Texture coordinates (u, v) to fetch at."""
    rng = np.random.RandomState(columns + 100 * rows)
    us, vs = coordinates(columns, rng), coordinates(rows, rng)
    count = max(len(us), len(vs))
    return np.resize(us, count), np.resize(vs, count)


@columns_and_rows
@wrap_mode
def test_a_bilinear_fetch_has_the_bits_of_the_convention(columns: int, rows: int, repeat: bool | None) -> None:
    image = np.random.RandomState(0).uniform(0, 1, (rows, columns))
    us, vs = pairs(columns, rows)
    got = np.empty(len(us))
    fetch_all(repeat, image.reshape(-1), float(columns), float(rows), us, vs, got)
    assert_array_equal(
        got, [bilinear(image, u, v, bool(repeat)) for u, v in zip(us.tolist(), vs.tolist(), strict=True)]
    )


@wrap_mode
def test_the_channels_of_a_colour_are_fetched_alike(repeat: bool | None) -> None:
    image = np.random.RandomState(0).uniform(0, 1, (3, 4, 3))
    us, vs = pairs(4, 3)
    got = np.empty((len(us), 3))
    fetch_all_channels(repeat, image.reshape(-1), 4.0, 3.0, us, vs, got)
    for channel in range(3):
        alone = np.empty(len(us))
        fetch_all(repeat, np.ascontiguousarray(image[..., channel]).reshape(-1), 4.0, 3.0, us, vs, alone)
        assert_array_equal(got[:, channel], alone)


@columns_and_rows
@wrap_mode
def test_a_nearest_fetch_reads_the_texel_of_the_convention(columns: int, rows: int, repeat: bool | None) -> None:
    us, vs = pairs(columns, rows)
    indices = np.empty((len(us), 5), np.int64)
    touch_all(repeat, float(columns), float(rows), us, vs, indices)
    expected = [nearest(u, v, columns, rows, bool(repeat)) for u, v in zip(us.tolist(), vs.tolist(), strict=True)]
    assert_array_equal(indices[:, 4], expected)


@wrap_mode
def test_a_texel_centre_returns_the_texel(repeat: bool | None) -> None:
    """Sizes that are powers of two: the centres are exact."""
    image = np.random.RandomState(0).uniform(0, 1, (4, 8))
    vs, us = np.meshgrid((np.arange(4) + 0.5) / 4, (np.arange(8) + 0.5) / 8, indexing="ij")
    got = np.empty(32)
    fetch_all(repeat, image.reshape(-1), 8.0, 4.0, us.reshape(-1), vs.reshape(-1), got)
    assert_array_equal(got.reshape(4, 8), image)


@columns_and_rows
@wrap_mode
def test_no_coordinate_reads_outside_the_texture(columns: int, rows: int, repeat: bool | None) -> None:
    """NaN, infinities, numbers beyond any integer: some texel, never a crash."""
    us, vs = (a.reshape(-1) for a in np.meshgrid(HOSTILE, [*HOSTILE, 0.3, 1.0]))
    for first, second in ((us, vs), (vs, us)):
        indices = np.empty((len(us), 5), np.int64)
        touch_all(repeat, float(columns), float(rows), first, second, indices)
        assert indices.min() >= 0
        assert indices.max() < columns * rows


@wrap_mode
def test_a_huge_finite_coordinate_returns_a_value_of_the_texture(repeat: bool | None) -> None:
    """Where no number between two texel centres is left, fractions are 0."""
    image = np.random.RandomState(0).uniform(0, 1, (5, 6))
    us, vs = np.array([1e300, -1e300, 1e18, 0.25, 0.25]), np.array([0.4, 0.4, -1e18, 1e300, -1e300])
    got = np.empty(len(us))
    fetch_all(repeat, image.reshape(-1), 6.0, 5.0, us, vs, got)
    assert (got >= image.min()).all()
    assert (got <= image.max()).all()


def test_clamp_holds_the_border_and_repeat_goes_around() -> None:
    image = np.array([[0.0, 1.0, 2.0, 3.0]]).reshape(-1)
    us = np.array([-0.5, 0.0, 0.125, 0.875, 1.0, 1.5])
    vs = np.full(6, 0.5)
    got = np.empty(6)
    fetch_all(None, image, 4.0, 1.0, us, vs, got)
    assert got.tolist() == [0.0, 0.0, 0.0, 3.0, 3.0, 3.0]
    fetch_all(True, image, 4.0, 1.0, us, vs, got)
    assert got.tolist() == [1.5, 1.5, 0.0, 3.0, 1.5, 1.5]
