"""Colours as ports hand them in: bytes or floats."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.affine.rows import UNIT
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.device import GL


def allows_color(color: Bounded, found: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Whether each number of a picture is legal where the shader's output is `color`.

    A byte k may stand for any number of which 255 c, clamped to [0, 255], is no farther from k than the device's conversion
    allows; the interval's ends are moved by the clamp, not beyond.
    """
    if found.dtype != np.uint8:
        return color.allows(found.astype(np.float64))
    steps = found.astype(np.float64)
    low, high = (255.0 * np.clip(end, 0.0, 1.0) for end in (color.low, color.high))
    slack = color.device.byte + 255.0 * 2.0**-24  # 255 c is a float32 product
    return np.asarray((steps >= low - slack) & (steps <= high + slack), np.bool_)


def color_bytes(color: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Colours as the conventions make bytes of them: floor(255 c + 0.5) after clamping."""
    return np.floor(255.0 * np.clip(color, 0.0, 1.0) + 0.5).astype(np.uint8)


def read_back(color: NDArray[np.float64]) -> NDArray[np.generic]:
    """The bytes of a picture of floats that are all k / 255: it was read back from bytes. Another one as it is."""
    steps = 255.0 * color
    if not np.isfinite(steps).all() or steps.min(initial=0.0) < 0.0 or steps.max(initial=0.0) > 255.0:
        return color
    nearest = np.rint(steps)
    # k / 255 is a quotient, of the loosest device, and stored as a float32.
    if (np.abs(steps - nearest) > (GL.quotient + 1.0) * UNIT * nearest).any():
        return color
    return nearest.astype(np.uint8)
