"""Fetches whose position is not exact: every value that the texture has where the device may look.

A bilinear fetch is a continuous function of its position, affine along each axis within a cell between four texel centres.
So within one cell it moves by at most the cell's steepest side along each axis times the move; where the box of possible
positions reaches into other cells, its extremes lie on the corners of the box and where cell borders cut it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Floats
from ibr_ref.oracle.accept.bounded import Bounded, exact
from ibr_ref.oracle.device import Device

FARTHEST = 1e9
"""Texels beyond it are not told apart: a float32 does not, and whole numbers end somewhere."""

FILTER_ROUNDINGS = 8.0
"""Of a filter in float arithmetic: two nested lerps, each 1 - f, two products and a sum on numbers no larger than the
largest texel in reach, and one rounding of the texel itself."""


def _of_windows(texels: Floats, reach: int, axis: int, extreme: np.ufunc) -> Floats:
    """The extreme of 2 reach + 1 neighbours along an axis, by windows that grow to twice their width.

    `scipy.ndimage` has filters for it, and takes as long to import as a small case takes to be judged.
    """
    windows, width, wanted = np.moveaxis(texels, axis, 0), 1, 2 * reach + 1
    while width < wanted:
        step = min(width, wanted - width)
        windows = extreme(windows[:-step], windows[step:])
        width += step
    return np.moveaxis(windows, 0, axis)


@dataclass(frozen=True, eq=False)
class Texture:
    """(H, W) or (H, W, C) texels and how coordinates outside are wrapped."""

    texels: Floats
    repeat: bool = False

    @cached_property
    def largest(self) -> float:
        """The largest magnitude of a texel."""
        return float(np.max(np.abs(self.texels)))

    @cached_property
    def of_bytes(self) -> bool:
        """Whether all texels are k / 255, and so may lie in a UNORM8 texture."""
        codes = np.rint(255.0 * self.texels)
        return bool(((codes >= 0.0) & (codes <= 255.0)).all() and (codes / 255.0 == self.texels).all())

    @cached_property
    def _extremes(self) -> dict[int, tuple[Floats, Floats]]:
        return {}

    def extremes(self, reach: int) -> tuple[Floats, Floats]:
        """The least and the largest texel no farther than `reach` from each texel along both axes, kept for later."""
        if reach not in self._extremes:
            mode: Literal["wrap", "edge"] = "wrap" if self.repeat else "edge"
            around = np.pad(self.texels, [(reach, reach)] * 2 + [(0, 0)] * (self.texels.ndim - 2), mode)
            least, most = (_of_windows(_of_windows(around, reach, 0, f), reach, 1, f) for f in (np.minimum, np.maximum))
            self._extremes[reach] = (least, most)
        return self._extremes[reach]

    def at(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> Floats:
        """Texels by index, after the wrap mode."""
        height, width = self.texels.shape[:2]
        return self._gather(self._wrapped(rows, height) * width + self._wrapped(columns, width))

    def cell(self, x: Floats, y: Floats) -> tuple[list[Floats], Floats, Floats]:
        """The four texels (00, 10, 01, 11; x first) around x = u W - 0.5, y = v H - 0.5, and the fractions."""
        height, width = self.texels.shape[:2]
        x0, y0 = np.floor(x), np.floor(y)
        column, row = (np.clip(c, -FARTHEST, FARTHEST).astype(np.int64) for c in (x0, y0))
        columns = [self._wrapped(column + j, width) for j in (0, 1)]
        rows = [self._wrapped(row + i, height) * width for i in (0, 1)]
        return [self._gather(r + c) for r in rows for c in columns], self.spread(x - x0), self.spread(y - y0)

    @cached_property
    def _flat(self) -> Floats:
        return np.ascontiguousarray(self.texels.reshape(-1, *self.texels.shape[2:]))

    def _gather(self, index: NDArray[np.int64]) -> Floats:
        return np.asarray(self._flat.take(index, axis=0))

    def _wrapped(self, index: NDArray[np.int64], count: int) -> NDArray[np.int64]:
        if self.repeat:
            return np.asarray(index % count)
        return np.minimum(np.maximum(index, 0), count - 1)

    def bilinear(self, x: Floats, y: Floats) -> Floats:
        """The reference's fetch at x = u W - 0.5, y = v H - 0.5."""
        (t00, t10, t01, t11), f, g = self.cell(x, y)
        return lerp(lerp(t00, t10, f), lerp(t01, t11, f), g)

    def spread(self, fraction: Any) -> Any:
        """(n,) for each channel alike."""
        return fraction[..., None] if self.texels.ndim == 3 else fraction


def fetch(texture: Texture, u: Bounded, v: Bounded) -> Bounded:
    """A bilinear fetch at coordinates (n,) that may be off; the result is (n,) or (n, C)."""
    device = u.device
    height, width = texture.texels.shape[:2]
    half = exact(0.5, device)
    x, y = u * exact(float(width), device) - half, v * exact(float(height), device) - half
    off_x, off_y = (_finite(c.error + device.weight_step) for c in (x, y))
    at_x, at_y = (np.where(np.isfinite(c.value), c.value, 0.0) for c in (x, y))
    (t00, t10, t01, t11), f, g = texture.cell(at_x, at_y)
    value = lerp(lerp(t00, t10, f), lerp(t01, t11, f), g)
    slope_x = np.maximum(np.abs(t10 - t00), np.abs(t11 - t01))
    slope_y = np.maximum(np.abs(t01 - t00), np.abs(t11 - t10))
    error = slope_x * texture.spread(off_x) + slope_y * texture.spread(off_y)
    crossing = (np.floor(at_x - off_x) != np.floor(at_x + off_x)) | (np.floor(at_y - off_y) != np.floor(at_y + off_y))
    largest = reduce(np.maximum, [np.abs(t) for t in (t00, t10, t01, t11)])
    if crossing.any():
        largest[crossing] = texture.largest
        error[crossing] = spread_around(texture, *(a[crossing] for a in (at_x, at_y, off_x, off_y, value)))
    return Bounded(value, error + filter_error(texture, device, largest), device)


def filter_error(texture: Texture, device: Device, largest: Any) -> Any:
    """By how much a filter's arithmetic may be off, on texels of a magnitude of `largest` at the most."""
    return FILTER_ROUNDINGS * device.operation * UNIT * largest + (device.filter_step if texture.of_bytes else 0.0)


def highest_around(texture: Texture, u: Bounded, v: Bounded) -> Floats:
    """(n,) no bilinear fetch of a texture (H, W) at these coordinates is higher; infinite where they may be far off."""
    off = 2.0 * u.device.operation * UNIT  # of u W and of - 0.5, relative to u W, or to 0.5 where that is less
    texels, sure = [], np.ones(np.broadcast(u.value, v.value).shape, np.bool_)
    for c, size in ((u, texture.texels.shape[1]), (v, texture.texels.shape[0])):
        x = c.value * size
        sure &= c.error * size + off * (np.abs(x) + 1.0) + c.device.weight_step < 1.0
        texels.append(np.floor(np.clip(np.nan_to_num(x), -FARTHEST, FARTHEST)).astype(np.int64))
    # A fetch at x takes the texels floor(x - 0.5) and the next one, so those within 1 of floor(x); off by one, within 2.
    most = Texture(texture.extremes(2)[1], texture.repeat).at(texels[1], texels[0])
    return np.where(sure, most + filter_error(texture, u.device, texture.largest), np.inf)


def _finite(error: Floats) -> Floats:
    return np.where(np.isfinite(error), error, FARTHEST)


def spread_around(texture: Texture, x: Floats, y: Floats, off_x: Floats, off_y: Floats, value: Floats) -> Floats:
    """The largest difference from `value` in the boxes around x, y."""
    at_x, at_y = np.stack(_stations(x, off_x))[:, None], np.stack(_stations(y, off_y))[None]
    found = texture.bilinear(*np.broadcast_arrays(at_x, at_y))
    error = np.asarray(np.abs(found - value).max(axis=(0, 1)))
    wide = np.maximum(off_x, off_y)
    for reach in (1, 2, 4, 8, 16):
        # More than one border may cut the box; its texels are these, no farther from the nearest one than off and a texel.
        here = np.flatnonzero((wide >= 0.5) & (wide <= reach))
        if len(here):
            wide[here] = 0.0
            columns, rows = (np.floor(np.clip(c[here], -FARTHEST, FARTHEST)).astype(np.int64) for c in (x, y))
            least, most = (Texture(e, texture.repeat).at(rows, columns) for e in texture.extremes(reach + 1))
            error[here] = np.maximum(most - value[here], value[here] - least)
    if (wide >= 0.5).any():
        error[wide >= 0.5] = np.ptp(texture.texels)
    return error


def _stations(x: Floats, off: Floats) -> tuple[Floats, Floats, Floats]:
    """Both ends of the interval, and the cell border between them if there is one."""
    low, high = x - off, x + off
    return low, np.maximum(np.floor(high), low), high


def texels_near(count: int, u: Bounded, repeat: bool) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The first and last texel index that a nearest fetch may take along an axis of `count` texels, before the wrap mode."""
    x = u * exact(float(count), u.device)
    low, high = (np.floor(np.clip(end, -FARTHEST, FARTHEST)).astype(np.int64) for end in (x.low, x.high))
    if repeat:
        return low, high
    return np.clip(low, 0, count - 1), np.clip(high, 0, count - 1)


def lerp(a: Floats, b: Floats, f: Floats) -> Floats:
    """A (1 - f) + b f."""
    return a * (1.0 - f) + b * f
