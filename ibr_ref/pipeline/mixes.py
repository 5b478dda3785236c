"""Bilinear mixes of a whole wave, of texels that are read where they lie side by side: two at once, for two lanes at a time.

One load then brings two texels of a row, or two channels of a texel, where a gather brings one; what it brings is mixed in
registers, with the operations of `sampling.mix` in their order. Each of these is a Python function first, as in `waves`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

from ibr_ref.array_types import IndexLanes, Lanes, Texels
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.waves import emitted

__all__ = ["mix_cross", "mix_pairs", "mix_triples"]


# --- What they mean --------------------------------------------------------------------------------------------------


@device
def _mixed(t00: float, t10: float, t01: float, t11: float, fx: float, fy: float) -> float:
    top = t00 * (1.0 - fx) + t10 * fx
    bottom = t01 * (1.0 - fx) + t11 * fx
    return top * (1.0 - fy) + bottom * fy


@device
def _mix_pairs(texels: Texels, upper: IndexLanes, lower: IndexLanes, fx: Lanes, fy: Lanes, out: Lanes) -> None:
    for lane in range(LANES):
        i, j = upper[lane], lower[lane]
        out[lane] = _mixed(texels[i], texels[i + 1], texels[j], texels[j + 1], fx[lane], fy[lane])


@device
def _mix_triples(
    texels: Texels, i00: IndexLanes, i10: IndexLanes, i01: IndexLanes, i11: IndexLanes, fx: Lanes, fy: Lanes,
    first: Lanes, second: Lanes, third: Lanes,
) -> None:  # fmt: skip
    for lane in range(LANES):
        a, b, c, d = 3 * i00[lane], 3 * i10[lane], 3 * i01[lane], 3 * i11[lane]
        f, g = fx[lane], fy[lane]
        first[lane] = _mixed(texels[a], texels[b], texels[c], texels[d], f, g)
        second[lane] = _mixed(texels[a + 1], texels[b + 1], texels[c + 1], texels[d + 1], f, g)
        third[lane] = _mixed(texels[a + 2], texels[b + 2], texels[c + 2], texels[d + 2], f, g)


@device
def _mix_cross(
    texels: Texels, columns: np.int64, corner: IndexLanes, fx: Lanes, fy: Lanes, left_fx: Lanes, right_fx: Lanes,
    above_fy: Lanes, below_fy: Lanes, left: Lanes, right: Lanes, above: Lanes, below: Lanes,
) -> None:  # fmt: skip
    for lane in range(LANES):
        i = corner[lane]
        j, k, m = i + columns, i + 2 * columns, i + 3 * columns
        f, g = fx[lane], fy[lane]
        left[lane] = _mixed(texels[j], texels[j + 1], texels[k], texels[k + 1], left_fx[lane], g)
        right[lane] = _mixed(texels[j + 2], texels[j + 3], texels[k + 2], texels[k + 3], right_fx[lane], g)
        above[lane] = _mixed(texels[i + 1], texels[i + 2], texels[j + 1], texels[j + 2], f, above_fy[lane])
        below[lane] = _mixed(texels[k + 1], texels[k + 2], texels[m + 1], texels[m + 2], f, below_fy[lane])


# --- The same as vector instructions ---------------------------------------------------------------------------------

_WIDE = ir.IntType(64)
_PAIR = ir.VectorType(ir.DoubleType(), 2)
_ONES = ir.Constant(_PAIR, [1.0, 1.0])


class _Emitter:
    """Instructions on two lanes, or two channels, at a time; arrays as pointers to their data."""

    def __init__(self, context: Any, builder: Any, signature: Any, arguments: Any) -> None:
        self.builder = builder
        self.arguments = [
            make_array(kind)(context, builder, argument).data if isinstance(kind, types.Array) else argument
            for kind, argument in zip(signature.args, arguments, strict=True)
        ]

    def index(self, indices: Any, lane: int) -> Any:
        at = self.builder.gep(indices, [ir.Constant(_WIDE, lane)])
        return self.builder.zext(self.builder.load(at), _WIDE)

    def lanes(self, wave: Any, lane: int) -> Any:
        return self._pair(wave, ir.Constant(_WIDE, lane))

    def store(self, value: Any, wave: Any, lane: int) -> None:
        place = self.builder.gep(wave, [ir.Constant(_WIDE, lane)])
        self.builder.store(value, self.builder.bitcast(place, _PAIR.as_pointer()), align=8)

    def beside(self, texels: Any, indices: list[Any], *columns: int) -> list[Any]:
        """Texels of both lanes along a row, from pairs that begin so many columns after the indices."""
        pairs = [
            self._turned(*(self._pair(texels, self._plus(index, column)) for index in indices)) for column in columns
        ]
        return [texel for pair in pairs for texel in pair]

    def mixed(self, texels: Sequence[Any], fx: Any, fy: Any) -> Any:
        """Texels: t00, t10, t01, t11."""
        t00, t10, t01, t11 = texels
        return self._lerp(self._lerp(t00, t10, fx), self._lerp(t01, t11, fx), fy)

    def triple(self, texels: Any, corners: list[Any], lane: int, fx: Any, fy: Any) -> list[Any]:
        """Three channels of both lanes: the first two side by side, of one lane and of the other."""
        builder = self.builder
        at = [
            [builder.mul(self.index(corner, lane + i), ir.Constant(_WIDE, 3)) for i in range(2)] for corner in corners
        ]
        pairs = []
        for i in range(2):
            f, g = (self._picked(fraction, fraction, i, i) for fraction in (fx, fy))
            pairs.append(self.mixed([self._pair(texels, both[i]) for both in at], f, g))
        thirds = [self._both(*(builder.load(builder.gep(texels, [self._plus(j, 2)])) for j in both)) for both in at]
        return [*self._turned(*pairs), self.mixed(thirds, fx, fy)]

    def _pair(self, array: Any, index: Any) -> Any:
        """Two elements that lie side by side."""
        place = self.builder.bitcast(self.builder.gep(array, [index]), _PAIR.as_pointer())
        return self.builder.load(place, align=8)

    def _both(self, first: Any, second: Any) -> Any:
        """A vector of two scalars."""
        pair = self.builder.insert_element(ir.Constant(_PAIR, ir.Undefined), first, ir.Constant(ir.IntType(32), 0))
        return self.builder.insert_element(pair, second, ir.Constant(ir.IntType(32), 1))

    def _picked(self, first: Any, second: Any, *which: int) -> Any:
        """A vector of two elements out of the four of two."""
        return self.builder.shuffle_vector(first, second, ir.Constant(ir.VectorType(ir.IntType(32), 2), list(which)))

    def _turned(self, first: Any, second: Any) -> tuple[Any, Any]:
        """Of one pair for either lane: the first elements of both lanes, and the second ones."""
        return self._picked(first, second, 0, 2), self._picked(first, second, 1, 3)

    def _plus(self, index: Any, more: int) -> Any:
        return self.builder.add(index, ir.Constant(_WIDE, more)) if more else index

    def _lerp(self, a: Any, b: Any, f: Any) -> Any:
        builder = self.builder
        return builder.fadd(builder.fmul(a, builder.fsub(_ONES, f)), builder.fmul(b, f))


@intrinsic
def _emitted_pairs(typing: Any, texels: Any, upper: Any, lower: Any, fx: Any, fy: Any, out: Any) -> Any:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        e = _Emitter(context, builder, signature, arguments)
        texels, upper, lower, fx, fy, out = e.arguments
        for lane in range(0, LANES, 2):
            top, bottom = (e.beside(texels, [e.index(row, lane), e.index(row, lane + 1)], 0) for row in (upper, lower))
            e.store(e.mixed([*top, *bottom], e.lanes(fx, lane), e.lanes(fy, lane)), out, lane)
        return context.get_dummy_value()

    return types.void(texels, upper, lower, fx, fy, out), emit


@intrinsic
def _emitted_triples(
    typing: Any, texels: Any, i00: Any, i10: Any, i01: Any, i11: Any, fx: Any, fy: Any, a: Any, b: Any, c: Any
) -> Any:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        e = _Emitter(context, builder, signature, arguments)
        texels, *corners, fx, fy, first, second, third = e.arguments
        for lane in range(0, LANES, 2):
            mixed = e.triple(texels, corners, lane, e.lanes(fx, lane), e.lanes(fy, lane))
            for value, wave in zip(mixed, (first, second, third), strict=True):
                e.store(value, wave, lane)
        return context.get_dummy_value()

    return types.void(texels, i00, i10, i01, i11, fx, fy, a, b, c), emit


@intrinsic
def _emitted_cross(
    typing: Any, texels: Any, columns: Any, corner: Any, fx: Any, fy: Any, left_fx: Any, right_fx: Any, above_fy: Any,
    below_fy: Any, left: Any, right: Any, above: Any, below: Any,
) -> Any:  # fmt: skip
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        e = _Emitter(context, builder, signature, arguments)
        texels, columns, corner, *fractions, left, right, above, below = e.arguments
        for lane in range(0, LANES, 2):
            rows = [[e.index(corner, lane), e.index(corner, lane + 1)]]
            for _ in range(3):
                rows.append([builder.add(index, columns) for index in rows[-1]])
            t = [e.beside(texels, row, *pairs) for row, pairs in zip(rows, ((1,), (0, 2), (0, 2), (1,)), strict=True)]
            f, g, f_left, f_right, g_above, g_below = (e.lanes(fraction, lane) for fraction in fractions)
            e.store(e.mixed([*t[1][0:2], *t[2][0:2]], f_left, g), left, lane)
            e.store(e.mixed([*t[1][2:4], *t[2][2:4]], f_right, g), right, lane)
            e.store(e.mixed([*t[0], *t[1][1:3]], f, g_above), above, lane)
            e.store(e.mixed([*t[2][1:3], *t[3]], f, g_below), below, lane)
        return context.get_dummy_value()

    names = (texels, columns, corner, fx, fy, left_fx, right_fx, above_fy, below_fy, left, right, above, below)
    return types.void(*names), emit


mix_pairs = emitted(_mix_pairs, _emitted_pairs)
"""mix_pairs(texels, upper, lower, fx, fy, out): of a one-channel texture, where the second texel of either row follows the
first. upper, lower: indices (int32) of the first texels."""

mix_triples = emitted(_mix_triples, _emitted_triples)
"""mix_triples(texels, i00, i10, i01, i11, fx, fy, first, second, third): of a three-channel texture, channel by channel."""

mix_cross = emitted(_mix_cross, _emitted_cross)
"""mix_cross(texels, columns, corner, fx, fy, left_fx, right_fx, above_fy, below_fy, left, right, above, below): of a
one-channel texture a texel to either side, along u and along v: twelve texels, not sixteen.

columns: int64. corner: index of the first of the 4 x 4 texels around, of which those in the corners are not read."""
