"""Stage accumulate: the sum of all light samples' shadows, each times 1 / N."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.device import TINY, UNIT, Device
from ibr_ref.oracle.referees.shadows.transform import centered, gamma


def accumulated(shadows: Sequence[Bounded], unorm8: bool) -> Bounded:
    """The sum of N shadows (n,)."""
    device = shadows[0].device
    if unorm8:
        return _in_bytes(shadows, device)
    count = len(shadows)
    weight = 1.0 / count
    value = reduce(np.add, [weight * shadow.value for shadow in shadows])
    error = weight * reduce(np.add, [np.asarray(shadow.error) for shadow in shadows])
    size = weight * reduce(np.add, [shadow.size for shadow in shadows])
    # 1 / N as a quotient and stored, a product; N sums, in each of which the sum so far is a product with the factor 1.
    rounding = gamma(device, 2.0 + 2.0 * count, 1.0) * size + 2.0 * count * TINY
    # The reference's sum ends at 1; a float buffer does not clamp, and a port's may be above by its roundings.
    return Bounded(np.minimum(value, 1.0), error + rounding, device)


def in_bytes(found: Floats, device: Device) -> Bools:
    """Which numbers of a port may be what an 8-bit buffer holds: k / 255, as a quotient or a product with its inverse."""
    with np.errstate(invalid="ignore", over="ignore"):
        steps = np.rint(255.0 * found)
        return np.asarray(np.abs(found - steps / 255.0) <= (device.quotient + device.operation) * UNIT, np.bool_)


def _in_bytes(shadows: Sequence[Bounded], device: Device) -> Bounded:
    """alpha and every sum are rounded to bytes and saturate.

    Where the device converts to the nearest byte (0.5) the sums are those of the conventions. Elsewhere blending may round
    source and product too: up to one step away from the unrounded sum at each addition (shadows/method.md, "In 8 bits").
    """
    slack = 0.5 if device.byte == 0.5 else max(device.byte, 1.0)
    weight = np.floor(255.0 / len(shadows) + 0.5) / 255.0
    low = high = np.zeros(np.shape(shadows[0].value))
    for shadow in shadows:
        # 255 c is a product of a sum of a product, in float32.
        off = 3.0 * 255.0 * device.operation * UNIT
        least, most = (s / 255.0 + weight * e for s, e in ((low, shadow.low), (high, shadow.high)))
        low = np.clip(np.ceil(255.0 * least - off - slack), 0.0, 255.0)
        high = np.clip(np.floor(255.0 * most + off + slack), 0.0, 255.0)
    result = centered(low / 255.0, high / 255.0, device)
    # A byte comes back as k / 255: a quotient.
    return result.widened(device.quotient * UNIT)
