"""The output merger: depth test and additive alpha blending.

One writer per pixel: whoever calls these for a pixel does so in submission order.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.jit import device, kernel, prange


@device
def passes(depth: float, stored: float) -> bool:
    """Depth test LESS: on a tie the earlier primitive stays."""
    return depth < stored


@device
def to_unorm8(value: float) -> float:
    """The nearest of the 256 levels of [0, 1], as a float: floor(255 c + 0.5)/255 after clamping."""
    value = value if value > 0.0 else 0.0
    value = value if value < 1.0 else 1.0
    return np.floor(255.0 * value + 0.5) / 255.0


@kernel
def blend_add(target: Floats, source: Floats, alpha: float, unorm8: bool) -> None:
    """Additive alpha blending (GL_SRC_ALPHA, GL_ONE): target += alpha source, both flat float64 arrays.

    unorm8: alpha and every sum are rounded to 8 bits and saturate, as in an 8-bit frame buffer.
    """
    weight = to_unorm8(alpha) if unorm8 else alpha
    chunk = 4096
    for part in prange((target.size + chunk - 1) // chunk):
        for i in range(part * chunk, min(target.size, (part + 1) * chunk)):
            total = target[i] + weight * source[i]
            target[i] = to_unorm8(total) if unorm8 else total
