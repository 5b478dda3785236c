"""Fetches of waves have the bits of the fetches one by one, at every coordinate that those are tried at.

Compiled functions fetch at us and vs (N,), into out (N,), or (3, N) and (4, N).
"""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Texels, Wrap
from ibr_ref.jit import LANES, routine
from ibr_ref.pipeline.fetches import fetch_color_wave, fetch_cross_wave, fetch_wave
from ibr_ref.pipeline.waves import lanes, load, store
from tests.pipeline.test_sampling import HOSTILE, columns_and_rows, pairs, wrap_mode
from tests.pipeline.texels import fetch_all, fetch_all_channels


@routine
def fetch_waves(repeat: Wrap, texels: Texels, columns: float, rows: float, us: Floats, vs: Floats, out: Floats) -> None:
    u, v, sample = lanes(), lanes(), lanes()
    for first in range(0, len(us), LANES):
        load(us, first, u)
        load(vs, first, v)
        fetch_wave(texels, columns, rows, repeat, u, v, sample)
        store(sample, out, first)


@routine
def fetch_color_waves(
    repeat: Wrap, texels: Texels, columns: float, rows: float, us: Floats, vs: Floats, out: Floats
) -> None:
    u, v, red, green, blue = lanes(), lanes(), lanes(), lanes(), lanes()
    for first in range(0, len(us), LANES):
        load(us, first, u)
        load(vs, first, v)
        fetch_color_wave(texels, columns, rows, repeat, u, v, red, green, blue)
        store(red, out[0], first)
        store(green, out[1], first)
        store(blue, out[2], first)


@routine
def fetch_cross_waves(
    repeat: Wrap, texels: Texels, columns: float, rows: float, us: Floats, vs: Floats, out: Floats
) -> None:
    u, v, left, right, above, below = lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    for first in range(0, len(us), LANES):
        load(us, first, u)
        load(vs, first, v)
        fetch_cross_wave(texels, columns, rows, repeat, u, v, left, right, above, below)
        store(left, out[0], first)
        store(right, out[1], first)
        store(above, out[2], first)
        store(below, out[3], first)


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


@columns_and_rows
@wrap_mode
def test_a_texel_beside(columns: int, rows: int, repeat: bool | None) -> None:
    """Also in waves that all lie inside, on and next to the lines between texels, where rounding decides."""
    texels = np.random.RandomState(2).uniform(0, 1, rows * columns)
    us, vs = places(columns, rows)
    lines = np.resize(np.arange(1.5, max(columns - 2.0, 1.6)), 20 * LANES)
    beside = np.random.RandomState(3).choice([-1e-16, 0.0, 1e-16, 0.3], (2, len(lines)))
    us = np.concatenate([us, lines / columns + beside[0], np.full(LANES, np.nan)])
    vs = np.concatenate([vs, np.full(len(lines), 0.5) + beside[1], np.full(LANES, 0.5)])
    single, waves = np.empty(len(us)), np.empty((4, len(us)))
    fetch_cross_waves(repeat, texels, float(columns), float(rows), us, vs, waves)
    steps = ((-1.0 / columns, 0.0), (1.0 / columns, 0.0), (0.0, -1.0 / rows), (0.0, 1.0 / rows))
    for wave, (step_u, step_v) in zip(waves, steps, strict=True):
        fetch_all(repeat, texels, float(columns), float(rows), us + step_u, vs + step_v, single)
        assert_array_equal(wave, single)
