"""Haar wavelets for the maps of a grid: blocks that are decoded one by one, in any order (section 2.3.2).

A block of 16 x 16 texels is transformed over four levels: of two neighbours the mean (a + b)/2 stays and (a - b)/2 is
the detail, along rows, then along columns, then again on the quarter of means. Details below the threshold are dropped.
What is kept is rounded: the mean of the block to 1/255, details, which lie in [-1/2, 1/2], to 1/254. A block is its mean,
and, unless it is flat, a bit for each coefficient and a byte for each that is not zero.

What kernels take: image and out (S, S); mean and start (B,) and data as in `Blocks`; of one block its texels (16, 16),
codes (256,), row by row, and spare (16,), room for a row or column.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes, Floats, Indices, Ints
from ibr_ref.jit import device, kernel, prange, routine

BLOCK = 16
_BITS = BLOCK * BLOCK // 8
_FLAT = -1


class Blocks(NamedTuple):
    """A compressed map of S x S, row by row of blocks, B of them."""

    mean: NDArray[np.uint8]
    """(B,) of every block, times 255."""
    start: NDArray[np.int32]
    """(B,) where the block's bytes begin in `data`; -1: it is flat and has none."""
    data: NDArray[np.uint8]
    """A block's bytes: 32 of flags, least bit first, row by row; then the coefficients, plus 128, of the flags set."""

    @property
    def nbytes(self) -> int:
        """Bytes of all three."""
        return self.mean.nbytes + self.start.nbytes + self.data.nbytes


@device
def _forward(block: Floats, spare: Floats) -> None:
    """The transform in place: the block's mean at [0, 0], details around it."""
    size = BLOCK
    while size > 1:
        half = size // 2
        for axis in range(2):
            for i in range(size):
                for j in range(half):
                    a = block[i, 2 * j] if axis == 0 else block[2 * j, i]
                    b = block[i, 2 * j + 1] if axis == 0 else block[2 * j + 1, i]
                    spare[j], spare[half + j] = (a + b) / 2.0, (a - b) / 2.0
                for j in range(size):
                    if axis == 0:
                        block[i, j] = spare[j]
                    else:
                        block[j, i] = spare[j]
        size = half


@device
def _backward(block: Floats, spare: Floats) -> None:
    """The inverse of `_forward`: columns, then rows, from the smallest quarter outwards."""
    size = 2
    while size <= BLOCK:
        half = size // 2
        for axis in range(2):
            for i in range(size):
                for j in range(half):
                    mean = block[j, i] if axis == 0 else block[i, j]
                    detail = block[half + j, i] if axis == 0 else block[i, half + j]
                    spare[2 * j], spare[2 * j + 1] = mean + detail, mean - detail
                for j in range(size):
                    if axis == 0:
                        block[j, i] = spare[j]
                    else:
                        block[i, j] = spare[j]
        size *= 2


@device
def _load(image: Floats, row: int, column: int, block: Floats) -> None:
    """A block of the image; beyond its border the last texels go on."""
    last = len(image) - 1
    for i in range(BLOCK):
        for j in range(BLOCK):
            block[i, j] = image[min(row + i, last), min(column + j, last)]


@device
def _quantize(block: Floats, threshold: float, codes: Ints) -> int:
    """Details as whole numbers from -127 to 127, 0 for those below the threshold; the number of others."""
    count = 0
    for i in range(BLOCK):
        for j in range(BLOCK):
            code = np.rint(254.0 * block[i, j])
            if abs(block[i, j]) < threshold or (i == 0 and j == 0):
                code = 0.0
            codes[i * BLOCK + j] = np.int64(code)
            count += 1 if code != 0.0 else 0
    return count


@device
def _write(codes: Ints, start: int, data: Bytes) -> int:
    """Flags and coefficients of a block; where its bytes end."""
    end = start + _BITS
    data[start:end] = 0
    for k in range(BLOCK * BLOCK):
        if codes[k] != 0:
            data[start + k // 8] |= np.uint8(1 << (k % 8))
            data[end] = np.uint8(codes[k] + 128)
            end += 1
    return end


@routine
def _encode(image: Floats, threshold: float, mean: Bytes, start: Indices, data: Bytes) -> int:
    """All blocks, in order; the number of bytes of `data` in use."""
    across = (len(image) + BLOCK - 1) // BLOCK
    block, spare, codes = np.empty((BLOCK, BLOCK)), np.empty(BLOCK), np.empty(BLOCK * BLOCK, np.int64)
    end = 0
    for b in range(len(mean)):
        _load(image, b // across * BLOCK, b % across * BLOCK, block)
        _forward(block, spare)
        mean[b] = np.uint8(np.floor(255.0 * block[0, 0] + 0.5))
        start[b] = _FLAT
        if _quantize(block, threshold, codes) > 0:
            start[b] = end
            end = _write(codes, end, data)
    return end


@device
def _decode_block(mean: int, start: int, data: Bytes, spare: Floats, block: Floats) -> None:
    """A block that is not flat, from its mean and where its bytes begin."""
    block[:] = 0.0
    if start != _FLAT:
        at = start + _BITS
        for k in range(BLOCK * BLOCK):
            if data[start + k // 8] >> (k % 8) & 1:
                block[k // BLOCK, k % BLOCK] = (np.float64(data[at]) - 128.0) / 254.0
                at += 1
    block[0, 0] = np.float64(mean) / 255.0
    _backward(block, spare)


@device
def _decode_blocks(mean: Bytes, start: Indices, data: Bytes, blocks_row: int, out: Floats) -> None:
    """A row of blocks, into the map."""
    size = len(out)
    across = (size + BLOCK - 1) // BLOCK
    block, spare = np.empty((BLOCK, BLOCK)), np.empty(BLOCK)
    first_row = blocks_row * BLOCK
    for column in range(across):
        b = blocks_row * across + column
        flat = start[b] == _FLAT
        if not flat:
            _decode_block(mean[b], start[b], data, spare, block)
        for i in range(first_row, min(size, first_row + BLOCK)):
            for j in range(column * BLOCK, min(size, column * BLOCK + BLOCK)):
                value = np.float64(mean[b]) / 255.0 if flat else block[i - first_row, j - column * BLOCK]
                value = value if value > 0.0 else 0.0
                out[i, j] = value if value < 1.0 else 1.0


@kernel
def _decode(mean: Bytes, start: Indices, data: Bytes, out: Floats) -> None:
    """All blocks, into the map."""
    for blocks_row in prange((len(out) + BLOCK - 1) // BLOCK):
        _decode_blocks(mean, start, data, blocks_row, out)


def encode(image: Floats, threshold: float) -> Blocks:
    """Compress a map (S, S) of numbers in [0, 1]."""
    count = (-(-len(image) // BLOCK)) ** 2
    mean, start = np.empty(count, np.uint8), np.empty(count, np.int32)
    data = np.empty(count * (_BITS + BLOCK * BLOCK), np.uint8)
    used = _encode(image, threshold, mean, start, data)
    return Blocks(mean, start, data[:used].copy())


def decode(blocks: Blocks, size: int) -> Floats:
    """The map (S, S), in [0, 1]."""
    out = np.empty((size, size))
    _decode(*blocks, out)
    return out
