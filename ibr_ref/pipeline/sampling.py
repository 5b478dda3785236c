"""Texture fetches: bilinear and nearest, with the wrap modes clamp and repeat.

Textures are flat, C-ordered arrays of float64 texels: ``(rows * columns)`` for one channel, ``(rows * columns * 3)``
for colours. Texel (column j, row i) has its centre at ((j + 0.5)/columns, (i + 0.5)/rows); row 0 is v = 0.
Scalars only, no branches: in a loop over lanes LLVM turns the fetches into gathers. The wrap mode is a type, not a
value: `repeat` is None for clamp and True for repeat, so that Numba compiles the other branch away (a flag at run time
would make every fetch pay for both: +50 %, measured).
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Texels, Wrap
from ibr_ref.jit import device

Footprint = tuple[np.uint32, np.uint32, np.uint32, np.uint32, float, float]
"""Indices of the texels t00, t10, t01 and t11, and the fractions fx and fy of the way to the second ones."""

_FAR = 1073741824.0  # 2^30: texel coordinates beyond it are clamped before they become integers


@device
def clamped(x: float, low: float, high: float) -> float:
    """x in [low, high]; NaN becomes low."""
    x = x if x > low else low
    return x if x < high else high


@device
def lerp(a: float, b: float, f: float) -> float:
    """a (1 - f) + b f."""
    return a * (1.0 - f) + b * f


@device
def _neighbours(x_floor: float, size: float, repeat: Wrap) -> tuple[np.int32, np.int32]:
    """The two neighbouring texel indices along an axis, inside [0, size - 1]; clamped as floats, as int(nan) is INT_MIN."""
    if repeat is None:
        low = np.int32(clamped(x_floor, -1.0, size - 1.0))
        last = np.int32(size - 1.0)
        return max(low, np.int32(0)), min(np.int32(low + np.int32(1)), last)
    x = clamped(x_floor, -_FAR, _FAR)
    low = np.int32(x - np.floor(x / size) * size)  # exact: integers of at most 30 bits
    high = np.int32(low + np.int32(1))
    return low, high if high < np.int32(size) else np.int32(0)


@device
def footprint(u: float, v: float, columns: float, rows: float, repeat: Wrap) -> Footprint:
    """Bilinear footprint: indices (uint32) of the texels t00, t10, t01, t11, and the fractions fx, fy."""
    x = u * columns - 0.5
    y = v * rows - 0.5
    x_floor = np.floor(x)
    y_floor = np.floor(y)
    x0, x1 = _neighbours(x_floor, columns, repeat)
    y0, y1 = _neighbours(y_floor, rows, repeat)
    stride = np.int32(columns)
    top = np.int32(y0 * stride)
    bottom = np.int32(y1 * stride)
    return (
        np.uint32(top + x0),
        np.uint32(top + x1),
        np.uint32(bottom + x0),
        np.uint32(bottom + x1),
        x - x_floor,
        y - y_floor,
    )


@device
def mix(texels: Texels, i00: np.uint32, i10: np.uint32, i01: np.uint32, i11: np.uint32, fx: float, fy: float) -> float:
    """The bilinear mix of four texels of a one-channel texture."""
    top = texels[i00] * (1.0 - fx) + texels[i10] * fx
    bottom = texels[i01] * (1.0 - fx) + texels[i11] * fx
    return top * (1.0 - fy) + bottom * fy


@device
def mix_channel(
    texels: Texels, channel: np.uint32, i00: np.uint32, i10: np.uint32, i01: np.uint32, i11: np.uint32, fx: float,
    fy: float,
) -> float:  # fmt: skip
    """The bilinear mix of one channel (uint32) of a three-channel texture."""
    three = np.uint32(3)
    top = texels[i00 * three + channel] * (1.0 - fx) + texels[i10 * three + channel] * fx
    bottom = texels[i01 * three + channel] * (1.0 - fx) + texels[i11 * three + channel] * fx
    return top * (1.0 - fy) + bottom * fy


@device
def fetch(texels: Texels, columns: float, rows: float, repeat: Wrap, u: float, v: float) -> float:
    """Bilinear fetch from a one-channel texture."""
    i00, i10, i01, i11, fx, fy = footprint(u, v, columns, rows, repeat)
    return mix(texels, i00, i10, i01, i11, fx, fy)


@device
def nearest_index(u: float, v: float, columns: float, rows: float, repeat: Wrap) -> np.uint32:
    """Index (uint32) of the texel that a nearest fetch reads."""
    x = np.floor(u * columns)
    y = np.floor(v * rows)
    if repeat is None:
        column = np.int32(clamped(x, 0.0, columns - 1.0))
        row = np.int32(clamped(y, 0.0, rows - 1.0))
    else:
        column, _ = _neighbours(x, columns, repeat)
        row, _ = _neighbours(y, rows, repeat)
    return np.uint32(row * np.int32(columns) + column)
