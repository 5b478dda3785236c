"""Waves: the vector instructions do what the Python beside them says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from ibr_ref.array_types import Floats, Indices, Lanes
from ibr_ref.jit import LANES, routine
from ibr_ref.pipeline import waves
from ibr_ref.pipeline.waves import index_lanes, lanes, largest, load, load_indices, smallest, store, store_indices


@routine
def moved(source: Floats, indices: Indices, first: int, floats: Floats, whole: Indices) -> None:
    """Through the lanes and back, one wave further on; all (N,)."""
    wave, numbers = lanes(), lanes()
    load(source, first, wave)
    load_indices(indices, first, numbers)
    store(wave, floats, first + LANES)
    store_indices(numbers, whole, first + LANES)


@routine
def extremes(values: Lanes) -> tuple[float, float]:
    wave = lanes()
    load(values, 0, wave)
    return smallest(wave), largest(wave)


@routine
def extremes_as_meant(values: Lanes) -> tuple[float, float]:
    wave = lanes()
    waves._load(values, 0, wave)
    return waves._smallest(wave), waves._largest(wave)


@routine
def shares_nothing() -> tuple[int, int, int]:
    """Two arrays of lanes, written one after the other."""
    first, second = index_lanes(), index_lanes()
    for lane in range(LANES):
        first[lane] = lane
    for lane in range(LANES):
        second[lane] = -1
    return first.sum(), second.sum(), len(first)


@pytest.mark.parametrize("first", [0, 1, 7, LANES])
def test_a_wave_goes_through_the_lanes_from_any_element_on(first: int) -> None:
    size = 4 * LANES
    source, indices = np.random.RandomState(0).uniform(-1, 1, size), np.arange(size, dtype=np.int32) - 50
    floats, whole = np.full(size, 9.0), np.full(size, 9, np.int32)
    moved(source, indices, first, floats, whole)
    wave, target = slice(first, first + LANES), slice(first + LANES, first + 2 * LANES)
    assert_array_equal(floats[target], source[wave])
    assert_array_equal(whole[target], indices[wave])
    assert (np.delete(floats, np.r_[target]) == 9.0).all()
    assert (np.delete(whole, np.r_[target]) == 9).all()


@pytest.mark.parametrize("place", range(LANES))
def test_the_extremes_are_found_in_every_lane(place: int) -> None:
    values = np.random.RandomState(place).uniform(-1, 1, LANES)
    values[place], values[(place + 11) % LANES] = -5.0, np.inf
    assert extremes(values) == (-5.0, np.inf)


@pytest.mark.parametrize("place", [0, 5, 16, 31])
def test_even_what_makes_no_sense_is_the_same(place: int) -> None:
    values: Any = np.random.RandomState(place).uniform(-1, 1, LANES)
    values[place] = np.nan
    assert_array_equal(extremes(values), extremes_as_meant(values))


def test_lanes_are_arrays_of_their_own() -> None:
    assert shares_nothing() == (LANES * (LANES - 1) // 2, -LANES, LANES)
