"""Fetches of waves have the bits of the fetches one by one, at every coordinate that those are tried at."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

from ibr_ref.jit import LANES, routine
from ibr_ref.pipeline.fetches import fetch_color_wave, fetch_wave
from ibr_ref.pipeline.waves import lanes, load, store
from tests.pipeline.test_sampling import HOSTILE, columns_and_rows, pairs, wrap_mode
from tests.pipeline.texels import fetch_all, fetch_all_channels


@routine
def fetch_waves(repeat, texels, columns, rows, us, vs, out):
    u, v, sample = lanes(), lanes(), lanes()
    for first in range(0, len(us), LANES):
        load(us, first, u)
        load(vs, first, v)
        fetch_wave(texels, columns, rows, repeat, u, v, sample)
        store(sample, out, first)


@routine
def fetch_color_waves(repeat, texels, columns, rows, us, vs, out):
    u, v, red, green, blue = lanes(), lanes(), lanes(), lanes(), lanes()
    for first in range(0, len(us), LANES):
        load(us, first, u)
        load(vs, first, v)
        fetch_color_wave(texels, columns, rows, repeat, u, v, red, green, blue)
        store(red, out[0], first)
        store(green, out[1], first)
        store(blue, out[2], first)


def places(columns: int, rows: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Whole waves of coordinates."""
    us, vs = pairs(columns, rows)
    size = -(-(len(us) + len(HOSTILE)) // LANES) * LANES
    return np.resize(np.append(us, HOSTILE), size), np.resize(np.append(vs, HOSTILE[::-1]), size)


@columns_and_rows
@wrap_mode
def test_one_channel(columns: int, rows: int, repeat: bool | None) -> None:
    texels = np.random.RandomState(0).uniform(0, 1, rows * columns)
    us, vs = places(columns, rows)
    single, waves = np.empty(len(us)), np.empty(len(us))
    fetch_all(repeat, texels, float(columns), float(rows), us, vs, single)
    fetch_waves(repeat, texels, float(columns), float(rows), us, vs, waves)
    assert_array_equal(waves, single)


@columns_and_rows
@wrap_mode
def test_three_channels(columns: int, rows: int, repeat: bool | None) -> None:
    texels = np.random.RandomState(1).uniform(0, 1, rows * columns * 3)
    us, vs = places(columns, rows)
    single, waves = np.empty((len(us), 3)), np.empty((3, len(us)))
    fetch_all_channels(repeat, texels, float(columns), float(rows), us, vs, single)
    fetch_color_waves(repeat, texels, float(columns), float(rows), us, vs, waves)
    assert_array_equal(waves.T, single)
