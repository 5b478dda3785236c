"""The output merger: 8-bit rounding, additive blending, the depth test."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from ibr_ref.pipeline.merge import blend_add, passes, to_unorm8


def test_the_256_levels_stay_themselves() -> None:
    for k in range(256):
        assert to_unorm8(k / 255) == k / 255


def test_other_values_go_to_the_nearest_level_and_ties_up() -> None:
    values = np.random.RandomState(0).uniform(0, 1, 500)
    for value in values.tolist():
        assert to_unorm8(value) == math.floor(255 * value + 0.5) / 255
    assert to_unorm8(0.5 / 255) == 1 / 255
    assert to_unorm8(np.nextafter(0.5 / 255, 0.0)) == 0.0
    assert to_unorm8(0.5) == 128 / 255


@pytest.mark.parametrize(
    ("value", "level"),
    [(-0.1, 0.0), (-np.inf, 0.0), (np.nan, 0.0), (-0.0, 0.0), (1.0001, 1.0), (1e300, 1.0), (np.inf, 1.0)],
)
def test_what_is_outside_is_clamped(value: float, level: float) -> None:
    assert to_unorm8(value) == level


def test_float_blending_adds_without_rounding_or_limit() -> None:
    rng = np.random.RandomState(0)
    target, source = rng.uniform(0, 1, 10000), rng.uniform(0, 1, 10000)
    before = target.copy()
    blend_add(target, source, 0.7, False)
    assert_array_equal(target, before + 0.7 * source)
    assert target.max() > 1.0


@pytest.mark.parametrize("alpha", [0.0, 0.1, 1 / 9, 0.5, 1.0])
def test_8_bit_blending_rounds_alpha_and_every_sum(alpha: float) -> None:
    rng = np.random.RandomState(1)
    target, source = np.floor(rng.uniform(0, 256, 5000)) / 255, np.floor(rng.uniform(0, 256, 5000)) / 255
    weight = math.floor(255 * alpha + 0.5) / 255
    expected = [
        math.floor(255 * min(t + weight * s, 1.0) + 0.5) / 255 for t, s in zip(target.tolist(), source, strict=True)
    ]
    blend_add(target, source, alpha, True)
    assert_array_equal(target, expected)


def test_8_bit_blending_saturates_and_loses_small_contributions() -> None:
    """Nine layers of 1/9 are 28/255 each, 252/255 together; white stays white; less than half a level adds nothing."""
    target = np.zeros(3)
    for _ in range(9):
        blend_add(target, np.array([1.0, 1.0, 0.0]), 1 / 9, True)
    assert_array_equal(target, [252 / 255, 252 / 255, 0.0])
    for _ in range(3):
        blend_add(target, np.array([1.0, 0.0, 0.004]), 1.0, True)
    assert_array_equal(target, [1.0, 252 / 255, 3 / 255])
    faint = np.zeros(1)
    for _ in range(100):
        blend_add(faint, np.array([0.4 / 255]), 1.0, True)
    assert faint[0] == 0.0


def test_the_depth_test_is_less() -> None:
    assert passes(0.25, 0.5)
    assert not passes(0.5, 0.5), "on a tie the earlier primitive stays"
    assert not passes(0.75, 0.5)
    assert not passes(math.nan, 1.0)
