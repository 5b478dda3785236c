"""Sine, cosine, tangent, arctangent: the nearest float64 to the true value."""

from __future__ import annotations

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest

from ibr_ref.scene.trigonometry import arctangent, sine_cosine, tangent_of_degrees

DIGITS = 50


def arctangent_of_inverse(n: int) -> Decimal:
    """arctan(1/n) by its series."""
    total, power, k = Decimal(0), Decimal(1) / n, 0
    while power > Decimal(10) ** -(DIGITS + 5):
        total += (-1) ** k * power / (2 * k + 1)
        power /= n * n
        k += 1
    return total


def true_tangent(degrees: float) -> Decimal:
    """Lambert's continued fraction x/(1 - x^2/(3 - x^2/(5 - ...))), with Machin's pi."""
    with localcontext() as context:
        context.prec = DIGITS + 10
        pi = 4 * (4 * arctangent_of_inverse(5) - arctangent_of_inverse(239))
        x = Decimal(degrees) * pi / 180
        value = Decimal(0)
        for odd in range(121, 0, -2):
            value = x * x / (odd - value)
        return value / x


def ulps(a: float, b: float) -> float:
    return abs(a - b) / math.ulp(b)


def test_the_tangent_is_correctly_rounded() -> None:
    rng = np.random.RandomState(0)
    for degrees in [*rng.uniform(0.01, 89.99, 60).tolist(), 1e-9, 22.5, 30.0, 60.0, 89.9999999, 90 - 2.0**-40]:
        assert tangent_of_degrees(degrees) == float(true_tangent(degrees))


def test_tangents_that_are_known_exactly() -> None:
    assert tangent_of_degrees(45.0) == 1.0
    assert tangent_of_degrees(0.0) == 0.0
    assert tangent_of_degrees(30.0) == float(1 / Decimal(3).sqrt())
    assert tangent_of_degrees(60.0) == float(Decimal(3).sqrt())
    assert tangent_of_degrees(22.5) == float(Decimal(2).sqrt() - 1)


def test_sine_and_cosine_are_those_of_the_mathematics_library() -> None:
    """It is good to within one unit in the last place."""
    for angle in np.random.RandomState(1).uniform(-1000, 1000, 300).tolist():
        sine, cosine = sine_cosine(angle)
        assert ulps(sine, math.sin(angle)) <= 1
        assert ulps(cosine, math.cos(angle)) <= 1


@pytest.mark.parametrize("angle", [0.0, 1e-300, 5e-324, math.pi, -math.pi, math.pi / 2, 1e6])
def test_special_angles(angle: float) -> None:
    """The float64 pi is not pi: its sine is the part that is missing, and has to come out to its last bit."""
    sine, cosine = sine_cosine(angle)
    assert ulps(sine, math.sin(angle)) <= 1
    assert ulps(cosine, math.cos(angle)) <= 1


def test_the_arctangent_turns_back() -> None:
    """Against the mathematics library to within one unit in the last place, and where the angle is known."""
    for y, x in np.random.RandomState(2).uniform(-10, 10, (300, 2)).tolist():
        assert ulps(arctangent(y, x), math.atan2(y, x)) <= 1
    for y, x in [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (1e-300, 1e300), (1.0, 1e-17), (0.0, 0.0)]:
        assert arctangent(y, x) == math.atan2(y, x)
    assert arctangent(1.0, 1.0) == math.pi / 4
    assert arctangent(math.sqrt(3.0), 1.0) == pytest.approx(math.pi / 3, rel=2**-51)
