"""Texture fetches of many coordinates at once, us and vs (N,), with the pipeline's own functions; and the same literally."""

from __future__ import annotations

import math

import numpy as np

from ibr_ref.array_types import Floats, Ints, Texels, Wrap
from ibr_ref.jit import kernel, prange
from ibr_ref.pipeline.sampling import fetch, footprint, mix_channel, nearest_index


@kernel
def fetch_all(repeat: Wrap, texels: Texels, columns: float, rows: float, us: Floats, vs: Floats, out: Floats) -> None:
    """Bilinear fetches from a one-channel texture, out (N,)."""
    for i in prange(len(us)):
        out[i] = fetch(texels, columns, rows, repeat, us[i], vs[i])


@kernel
def fetch_all_channels(
    repeat: Wrap, texels: Texels, columns: float, rows: float, us: Floats, vs: Floats, out: Floats
) -> None:
    """Bilinear fetches from a three-channel texture, out (N, 3)."""
    for i in prange(len(us)):
        i00, i10, i01, i11, fx, fy = footprint(us[i], vs[i], columns, rows, repeat)
        for channel in range(3):
            out[i, channel] = mix_channel(texels, np.uint32(channel), i00, i10, i01, i11, fx, fy)


@kernel
def touch_all(repeat: Wrap, columns: float, rows: float, us: Floats, vs: Floats, indices: Ints) -> None:
    """The four texels of each bilinear fetch and the one of a nearest fetch: indices (N, 5)."""
    for i in prange(len(us)):
        i00, i10, i01, i11, _, _ = footprint(us[i], vs[i], columns, rows, repeat)
        indices[i, 0], indices[i, 1], indices[i, 2], indices[i, 3] = i00, i10, i01, i11
        indices[i, 4] = nearest_index(us[i], vs[i], columns, rows, repeat)


def wrapped(index: int, size: int, repeat: bool) -> int:
    """The wrap mode."""
    return index % size if repeat else min(max(index, 0), size - 1)


def lerp(a: float, b: float, f: float) -> float:
    """As conventions.md has it."""
    return a * (1 - f) + b * f


def bilinear(image: Floats, u: float, v: float, repeat: bool) -> float:
    """conventions.md, "In short" (bilinear), word by word; image (rows, columns)."""
    rows, columns = image.shape
    x, y = u * columns - 0.5, v * rows - 0.5
    x0, y0 = math.floor(x), math.floor(y)
    fx, fy = x - x0, y - y0
    texel = [
        [float(image[wrapped(y0 + i, rows, repeat), wrapped(x0 + j, columns, repeat)]) for j in (0, 1)] for i in (0, 1)
    ]
    return lerp(lerp(texel[0][0], texel[0][1], fx), lerp(texel[1][0], texel[1][1], fx), fy)


def nearest(u: float, v: float, columns: int, rows: int, repeat: bool) -> int:
    """conventions.md, "In short" (nearest): the flat index."""
    return wrapped(math.floor(v * rows), rows, repeat) * columns + wrapped(math.floor(u * columns), columns, repeat)
