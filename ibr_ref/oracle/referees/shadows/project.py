"""Stage project: where a fragment is on the map, and what the map may say of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded, converted, exact, uploaded
from ibr_ref.oracle.accept.fetch import FILTER_ROUNDINGS, Texture, fetch, texels_near
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.referees.shadows.footprint import reads
from ibr_ref.oracle.referees.shadows.maps import Map
from ibr_ref.oracle.referees.shadows.transform import Lens, centered

TRUNCATED = 2.0
"""A device whose operations are rounded, or truncated, leaves x - 0 as it is."""


@dataclass(frozen=True, eq=False)
class Coordinate:
    """(n,) s, t and r (clamped), and q_w."""

    s: Bounded
    t: Bounded
    r: Bounded
    w: Bounded
    spoiled: Bools
    """(n,) the port's own is no number."""

    @property
    def axes(self) -> tuple[Bounded, Bounded, Bounded]:
        """s, t, r."""
        return self.s, self.t, self.r


@dataclass(frozen=True, eq=False)
class Shadow:
    """(n,) what one light sample's map may say: a range, and perhaps another."""

    first: Bounded
    """With every decision as exact arithmetic makes it."""
    other: Bounded
    """With one of them the other way; a range that holds all such results where there are many."""
    open: Bools
    """Whether that is legal."""
    spoiled: Bools
    """What it is made of is no number: anything is legal, the fault lies before."""
    whole: bool = False
    """The outcome of one comparison: 0 or 1, and nothing between them where either is legal."""

    def allows(self, found: Floats) -> Bools:
        """Whether a port's number is legal."""
        legal = self.first.allows(found) | (self.open & self.other.allows(found))
        if self.whole:
            legal &= (found == 0.0) | (found == 1.0)
        return np.asarray(legal | self.spoiled)


def coordinate(lens: Lens, world: Sequence[Bounded]) -> Coordinate:
    """The bias matrix is s = (x + w) / 2, t = (w - y) / 2."""
    x, y, z, w = lens.clip_of(world)
    half = exact(0.5, w.device)
    s, t, r = ((half * x + half * w) / w, (half * w - half * y) / w, (z / w).between(0.0, 1.0))
    return Coordinate(s, t, r, w, np.zeros(len(w.value), np.bool_))


def handed(found: Floats, legal: Coordinate) -> Coordinate:
    """The port's own coordinates (n, 3), besides those that are legal; a projective fetch divides by q_w once more."""
    usable = np.isfinite(found)
    s, t, r = (
        converted(np.where(usable[:, k], found[:, k], 0.0), legal.w.device, own) for k, own in enumerate(legal.axes)
    )
    return Coordinate(s, t, r, legal.w, np.asarray(~usable.all(axis=1)))


def shadow(case: Any, texels: Map, at: Coordinate, caster: Bools) -> Shadow:
    """What the map says of fragments; caster (n,): they are the caster's own."""
    device = at.s.device
    none = exact(np.zeros(len(caster)), device)
    hidden = caster if case.params.content == "mask" else np.zeros_like(caster)
    on, off = _on_map(at)
    read, other, open_ = _masks(texels, at) if case.params.content == "mask" else _compared(case, texels, at)
    possible, certain = ~off & ~hidden, on & ~hidden
    inside = _reference_on_map(at) & ~hidden
    first = read.where(inside, none)
    # Off the map by the reference, but perhaps on it: whatever is read there; on it, but perhaps off: lit.
    border = possible & ~certain
    alternative = _either(read, other, open_).where(~inside, other.where(open_, none))
    both = _either(alternative, none, inside)
    spoiled = at.spoiled | (reads(texels.spoiled, at.s, at.t) if texels.spoiled.any() else False)
    whole = case.params.content == "depth" and not case.params.pcf
    return Shadow(first, both.where(border, other), (border | open_) & possible, spoiled, whole)


def _either(a: Bounded, b: Bounded, also: Bools) -> Bounded:
    """A range that holds a, and b where it is legal."""
    low, high = np.where(also, np.minimum(a.low, b.low), a.low), np.where(also, np.maximum(a.high, b.high), a.high)
    return centered(low, high, a.device)


def _reference_on_map(at: Coordinate) -> Bools:
    s, t = at.s.value, at.t.value
    return np.asarray((at.w.value > 0.0) & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0))


def _on_map(at: Coordinate) -> tuple[Bools, Bools]:
    """Certainly on the map and in front of the light, and certainly not."""
    on, off = at.w.low > 0.0, at.w.high <= 0.0
    for axis in (at.s, at.t):
        on &= (axis.low >= 0.0) & (axis.high <= 1.0)
        off |= (axis.high < 0.0) | (axis.low > 1.0)
    return on, off


# --- Masks -----------------------------------------------------------------------------------------------------------


def _masks(texels: Map, at: Coordinate) -> tuple[Bounded, Bounded, Bools]:
    """The bilinear fetch; and with the texels that are open at their least and largest."""
    device = at.s.device
    first = _fetched(texels.firm, at)
    open_texels = (texels.low < texels.firm.low) | (texels.high > texels.firm.high)
    if not open_texels.any():
        return first, first, np.zeros(len(first.value), np.bool_)
    near = reads(open_texels, at.s, at.t)
    low, high = first.low.copy(), first.high.copy()
    low[near] = fetch(Texture(texels.low), at.s[near], at.t[near]).low
    high[near] = fetch(Texture(texels.high), at.s[near], at.t[near]).high
    return first, centered(low, high, device), near


def _fetched(image: Bounded, at: Coordinate) -> Bounded:
    value = fetch(Texture(image.value), at.s, at.t)
    if not np.any(image.error > 0.0):
        return value
    error = np.broadcast_to(image.error, image.value.shape)
    return value.widened(fetch(Texture(error), at.s, at.t).high)


# --- Depths ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Sides:
    """Both sides of a comparison: texels and depths as numbers, or as bytes."""

    texel: Floats
    texel_low: Floats
    texel_high: Floats
    depth: Floats
    depth_low: Floats
    depth_high: Floats

    def compare(self, index: Ints, pick: Any = slice(None)) -> tuple[Bools, Bools, Bools]:
        """Whether depth > texel: as exact arithmetic has it, certainly, and possibly."""
        depth, low, high = (d[pick] for d in (self.depth, self.depth_low, self.depth_high))
        return depth > self.texel[index], low > self.texel_high[index], high > self.texel_low[index]


def _sides(case: Any, texels: Map, at: Coordinate) -> _Sides:
    device = at.r.device
    bias = uploaded(float(case.params.bias), device)
    if float(case.params.bias) == 0.0 and device.operation <= TRUNCATED:
        depth = at.r
    else:
        # Either r - bias > texel or r > texel + bias.
        depth = at.r - bias
        depth = depth.widened(device.operation * UNIT * (at.r.size + bias.size))
    firm, low, high = (a.reshape(-1) for a in (texels.firm.value, texels.low, texels.high))
    if case.params.quantize is None:
        return _Sides(firm, low, high, depth.value, depth.low, depth.high)
    bytes_of = [_byte(a, 0.0, device) for a in (firm, depth.value)]
    ends = [_byte(a, s, device) for a, s in ((low, -1.0), (high, 1.0), (depth.low, -1.0), (depth.high, 1.0))]
    return _Sides(bytes_of[0], ends[0], ends[1], bytes_of[1], ends[2], ends[3])


def _byte(x: Floats, side: float, device: Device) -> Floats:
    """floor(255 x + 0.5), a product and a sum in float32, rounded down (-1) or up (1)."""
    y = 255.0 * x + 0.5
    return np.asarray(np.floor(y + side * 2.0 * device.operation * UNIT * (np.abs(y) + 1.0)))


def _compared(case: Any, texels: Map, at: Coordinate) -> tuple[Bounded, Bounded, Bools]:
    sides = _sides(case, texels, at)
    return _four(texels, sides, at) if case.params.pcf else _nearest(texels, sides, at)


def _nearest(texels: Map, sides: _Sides, at: Coordinate) -> tuple[Bounded, Bounded, Bools]:
    """The nearest texel, or one of up to four where the coordinate is near their edge."""
    size, device = len(texels.firm.value), at.s.device
    (first, last), (first_row, last_row) = (texels_near(size, axis, False) for axis in (at.s, at.t))
    column, row = (np.clip(np.floor(np.nan_to_num(a.value) * size), 0, size - 1).astype(np.int64) for a in (at.s, at.t))
    behind, certain, possible = sides.compare(row * size + column)
    for i in (first_row, last_row):
        for j in (first, last):
            _, sure, may = sides.compare(i * size + j)
            certain, possible = certain & sure, possible | may
    wide = (last - first > 1) | (last_row - first_row > 1)
    open_ = (certain != possible) | wide
    decided, other = exact(behind.astype(np.float64), device), exact((~behind).astype(np.float64), device)
    return decided, other, np.asarray(open_)


def _four(texels: Map, sides: _Sides, at: Coordinate) -> tuple[Bounded, Bounded, Bools]:
    """The mix of four comparisons: ranges over the box of possible coordinates, as in `accept.fetch`."""
    size, device = len(texels.firm.value), at.s.device
    count = len(at.s.value)
    first = np.stack([np.full(count, np.inf), np.full(count, -np.inf)])
    other, open_ = first.copy(), np.zeros(count, np.bool_)
    value = _mixed(size, sides, *(_place(size, axis) for axis in (at.s, at.t)))[0]
    first[:] = other[:] = value
    at_rest = _even(size, texels, sides, at)
    pick = np.flatnonzero(~at_rest)
    stations = [_stations(size, axis[pick]) for axis in (at.s, at.t)]
    for x in stations[0]:
        for y in stations[1]:
            exact_mix, low, high, doubtful = _mixed(size, sides, x, y, pick)
            first[0, pick], first[1, pick] = (
                np.minimum(first[0, pick], exact_mix),
                np.maximum(first[1, pick], exact_mix),
            )
            other[0, pick], other[1, pick] = np.minimum(other[0, pick], low), np.maximum(other[1, pick], high)
            open_[pick] |= doubtful
    wide = np.zeros(count, np.bool_)
    for axis in (at.s, at.t):
        wide |= axis.error * size + device.weight_step >= 0.5  # more than one border may cut the box
    other[0, wide], other[1, wide], open_[wide] = 0.0, 1.0, True
    rounding = FILTER_ROUNDINGS * device.operation * UNIT + device.filter_step  # comparisons are 0 or 1: bytes
    mixed = Bounded(value, np.maximum(first[1] - value, value - first[0]), device)
    return mixed.widened(rounding), centered(other[0], other[1], device).widened(rounding), open_


def _place(size: int, axis: Bounded) -> Floats:
    return np.clip(np.nan_to_num(axis.value * size - 0.5), -1.0, float(size))


def _stations(size: int, axis: Bounded) -> tuple[Floats, Floats, Floats]:
    """Both ends of what x may be, and the border of a cell between them."""
    x = _place(size, axis)
    off = (
        np.minimum(axis.error * size + axis.device.weight_step, float(size)) + 2.0 * axis.device.operation * UNIT * size
    )
    low, high = x - off, x + off
    return low, np.maximum(np.floor(high), low), high


def _mixed(
    size: int, sides: _Sides, x: Floats, y: Floats, pick: Any = slice(None)
) -> tuple[Floats, Floats, Floats, Bools]:
    """The mix at x, y, with the least and the most that comparisons may be, and whether any is open."""
    left, top = np.floor(x), np.floor(y)
    fx, fy = x - left, y - top
    result = [np.zeros(len(x)) for _ in range(3)]
    doubtful = np.zeros(len(x), np.bool_)
    for i, share_y in ((0, 1.0 - fy), (1, fy)):
        for j, share_x in ((0, 1.0 - fx), (1, fx)):
            row, column = (np.clip(a + n, 0, size - 1).astype(np.int64) for a, n in ((top, i), (left, j)))
            outcomes = sides.compare(row * size + column, pick)
            for total, outcome in zip(result, outcomes, strict=True):
                total += share_y * share_x * outcome
            doubtful |= outcomes[1] != outcomes[2]
    return result[0], result[1], result[2], doubtful


def _even(size: int, texels: Map, sides: _Sides, at: Coordinate) -> Bools:
    """(n,) whether every comparison around, whichever is read, has one certain outcome: the mix is then 0 or 1."""
    shape = texels.firm.value.shape
    least, most = sides.texel_low.reshape(shape), sides.texel_high.reshape(shape)
    for k in (0, 1):
        least, most = (_spread(a, k, f) for a, f in ((least, np.minimum), (most, np.maximum)))
    row, column = (np.clip(np.nan_to_num(np.rint(_place(size, a))), 0, size - 1).astype(np.int64) for a in (at.t, at.s))
    near = np.ones(len(row), np.bool_)
    for axis in (at.s, at.t):
        near &= axis.error * size + axis.device.weight_step < 0.25
    return np.asarray(near & ((sides.depth_low > most[row, column]) | (sides.depth_high <= least[row, column])))


def _spread(a: Floats, axis: int, function: Any) -> Floats:
    """Of each texel and both its neighbours along an axis."""
    padded = np.pad(a, [(1, 1) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
    parts = [np.take(padded, np.arange(a.shape[axis]) + k, axis=axis) for k in range(3)]
    return np.asarray(function(function(parts[0], parts[1]), parts[2]))
