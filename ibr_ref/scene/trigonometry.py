"""Sine, cosine and tangent with the same bits on every machine.

The C library's differ in the last bit from version to version, and a camera's matrix enters every pixel. Here the
series are summed in decimal arithmetic of 60 digits and rounded once. Slow (tens of microseconds), for scene
descriptions only.
"""

from __future__ import annotations

import math
from decimal import Decimal, localcontext

_DIGITS = 60
_PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211706798")


def _sine_cosine(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Taylor series after reduction to [-pi, pi]."""
    angle -= 2 * _PI * (angle / (2 * _PI)).to_integral_value()
    sine, cosine, term, n = Decimal(0), Decimal(0), Decimal(1), 0
    while abs(term) > Decimal(10) ** -_DIGITS or n < 2:
        sign = -1 if n % 4 > 1 else 1
        if n % 2:
            sine += sign * term
        else:
            cosine += sign * term
        n += 1
        term = term * angle / n
    return sine, cosine


def sine_cosine(angle: float) -> tuple[float, float]:
    """Sine and cosine of an angle in radians, |angle| up to 1e6."""
    with localcontext() as context:
        context.prec = _DIGITS + 20
        sine, cosine = _sine_cosine(Decimal(angle))
        return float(sine), float(cosine)


def arctangent(y: float, x: float) -> float:
    """The angle, in radians from -pi to pi, of the direction (x, y)."""
    with localcontext() as context:
        context.prec = _DIGITS + 20
        angle = Decimal(math.atan2(y, x))  # right to 1e-15 in any library; what is missing is its own tangent, to 1e-45
        sine, cosine = _sine_cosine(angle)
        across, along = Decimal(y) * cosine - Decimal(x) * sine, Decimal(x) * cosine + Decimal(y) * sine
        return float(angle + across / along if along else angle)


def tangent_of_degrees(degrees: float) -> float:
    """Tangent of an angle in degrees."""
    with localcontext() as context:
        context.prec = _DIGITS + 20
        sine, cosine = _sine_cosine(Decimal(degrees) * _PI / 180)
        return float(sine / cosine)
