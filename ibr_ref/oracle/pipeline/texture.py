"""A bilinear fetch of `Number`s: affine along each axis within a cell, so its slopes are the cell's."""

from __future__ import annotations

from functools import reduce

import numpy as np

from ibr_ref.affine.rows import SLOPES, UNIT
from ibr_ref.array_types import Ints
from ibr_ref.oracle.accept.fetch import Texture, filter_error, lerp, spread_around
from ibr_ref.oracle.arithmetic.bounds import Bounds
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.arithmetic.symbols import all_of, over_symbols


def texel_position(do: Bounds, coordinate: Number, size: int, repeat: bool) -> Number:
    """Where a coordinate lies, in texels from the first one's centre, with the rounding of weights."""
    x = do.subtract(do.multiply(coordinate, float(size)), 0.5)
    if repeat and do.device.wrapping:
        x = x.off_by(2.0 * do.device.wrapping * UNIT * (np.abs(x.value) + 1.0))
    return x.off_by(do.device.weight_step)


def fetch(do: Bounds, texture: Texture, x: Number, y: Number) -> Number:
    """(n,) or (n, C) at texel positions. Where their box reaches into other cells: all that is found there, no slopes."""
    off_x, off_y = (np.where(np.isfinite(c.deviation), c.deviation, 1e9) for c in (x, y))
    at_x, at_y = (np.clip(np.where(np.isfinite(c.value), c.value, 0.0), -1e9, 1e9) for c in (x, y))
    (t00, t10, t01, t11), f, g = texture.cell(at_x, at_y)
    wide = texture.spread
    along, down = lerp(t10 - t00, t11 - t01, g), lerp(t01 - t00, t11 - t10, f)
    twist = np.abs(t11 - t10 - t01 + t00)
    value = lerp(lerp(t00, t10, f), lerp(t01, t11, f), g)
    error = np.abs(along) * wide(x.error + 0.0 * at_x) + np.abs(down) * wide(y.error + 0.0 * at_y)
    error = error + twist * wide(off_x * off_y)
    names = all_of(x.names, y.names)
    ways = (over_symbols(c.rows, c.names, names)[SLOPES:] for c in (x, y))
    slopes = {
        k: along * wide(s + 0.0 * at_x) + down * wide(t + 0.0 * at_y) for k, s, t in zip(names, *ways, strict=True)
    }
    largest = reduce(np.maximum, [np.abs(t) for t in (t00, t10, t01, t11)])
    cut = (np.floor(at_x - off_x) != np.floor(at_x + off_x)) | (np.floor(at_y - off_y) != np.floor(at_y + off_y))
    if cut.any():
        error[cut] = spread_around(texture, *(a[cut].copy() for a in (at_x, at_y, off_x, off_y, value)))
        largest[cut] = texture.largest
        for s in slopes.values():
            s[cut] = 0.0
    return Number(do, value, error + filter_error(texture, do.device, largest), slopes, do.lane(x, y))


def below_highest(do: Bounds, texture: Texture, u: Number, v: Number, h: Number) -> Ints:
    """The samples (u, v, h) that are not certainly above every texel that a fetch there may see."""
    wrapping = do.device.wrapping if texture.repeat else 0.0
    # Of u W and of - 0.5, relative to u W, or to 0.5 where that is less.
    off = 2.0 * (do.device.operation + wrapping) * UNIT
    texels, sure = [], np.ones(h.shape, np.bool_)
    for c, size in ((u, texture.texels.shape[1]), (v, texture.texels.shape[0])):
        x = c.value * size
        sure &= c.deviation * size + off * (np.abs(x) + 1.0) + do.device.weight_step < 1.0
        texels.append(np.floor(np.clip(np.nan_to_num(x), -1e9, 1e9)).astype(np.int64))
    # A fetch at x takes the texels floor(x - 0.5) and the next one, so those within 1 of floor(x); off by one, within 2.
    most = Texture(texture.extremes(2)[1], texture.repeat).at(texels[1], texels[0])
    most = most + filter_error(texture, do.device, texture.largest)
    with np.errstate(invalid="ignore"):
        return np.flatnonzero(~(sure & (h.low > most)))
