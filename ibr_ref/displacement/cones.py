"""Cone maps: how wide a cone over each texel is empty (Dummer 2006), or met once at most (Policarpo & Oliveira 2007).

A ratio is radius in (u, v) per height in h, at most 1, of an upright cone with its apex on the texel's surface.

- *Cone*: the widest that holds no higher texel: min over H_j > H_i of |ij| / (H_j - H_i).
- *Relaxed cone*: the widest of which no ray from above the texel leaves the solid inside. For each higher texel j the ray
  from texel i at depth 0 through the surface at j goes on in 128 steps, to depth 1, until it is outside the solid again, at
  x: min of |ix| / (x_h - H_i) where x is higher than the surface at i. (A top at depth 0 counts as 1/255 deep.)

A relaxed ratio is never below that of the plain cone, which rules out most texels unseen; blocks of texels likewise, by
their largest height. Without that the cost of a map of n x n texels would be n^4.

Arrays: maxima (block_rows * block_columns,); ratios as texels.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Texels, Whole, Wrap
from ibr_ref.displacement.below import in_domain
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import fetch

BLOCK = 8
STEPS = 128
"""Of the search for the way out, as in the authors' shader."""

_SHALLOWEST = 1.0 / 255.0


def block_maxima(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """The largest height of each block of 8 x 8 texels."""
    rows, columns = heights.shape
    padded = np.pad(heights, [(0, -rows % BLOCK), (0, -columns % BLOCK)], constant_values=-1.0)
    blocks = padded.reshape(padded.shape[0] // BLOCK, BLOCK, padded.shape[1] // BLOCK, BLOCK)
    maxima: NDArray[np.float64] = blocks.max(axis=(1, 3))
    return maxima


@device
def _way_out(
    repeat: Wrap, texels: Texels, columns: float, rows: float, u: float, v: float, height: float, to_u: float,
    to_v: float, top: float, best: float,
) -> float:  # fmt: skip
    """Ratio of the cone that a ray through the surface at (to_u, to_v) leaves room for; `best` if that is narrower."""
    depth = max(1.0 - top, _SHALLOWEST)
    step = (1.0 - depth) / STEPS
    along_u, along_v = (to_u - u) / depth, (to_v - v) / depth
    d = depth
    ratio = best
    for _ in range(1, STEPS):
        d += step
        p_u, p_v = u + along_u * d, v + along_v * d
        rise = 1.0 - d - height
        if not rise > 0.0:
            return best
        ratio = np.sqrt((p_u - u) * (p_u - u) + (p_v - v) * (p_v - v)) / rise
        if not ratio < best:  # it only grows from here
            return best
        if not in_domain(p_u, p_v, repeat is None) or fetch(texels, columns, rows, repeat, p_u, p_v) < 1.0 - d:
            return ratio
    return ratio


@device
def _in_block(
    repeat: Wrap, relaxed: bool | None, texels: Texels, columns: float, rows: float, i: int, j: int, first_row: Whole,
    first_column: Whole, shift_u: float, shift_v: float, best: float,
) -> float:  # fmt: skip
    """The narrowest cone of texel (i, j) by the texels of a block, of the copy of the map that is shifted so."""
    u, v, height = (j + 0.5) / columns, (i + 0.5) / rows, texels[i * np.int64(columns) + j]
    for row in range(first_row, min(first_row + BLOCK, np.int64(rows))):
        for column in range(first_column, min(first_column + BLOCK, np.int64(columns))):
            top = texels[row * np.int64(columns) + column]
            to_u, to_v = (column + 0.5) / columns + shift_u, (row + 0.5) / rows + shift_v
            away = np.sqrt((to_u - u) * (to_u - u) + (to_v - v) * (to_v - v))
            if not top > height or not away < best * (top - height):
                continue
            if relaxed is None:
                best = away / (top - height)
            else:
                best = _way_out(repeat, texels, columns, rows, u, v, height, to_u, to_v, top, best)
    return best


@device
def _beside(x: float, low: float, high: float) -> float:
    """How far x is from the interval."""
    return max(max(low - x, x - high), 0.0)


@device
def _cone(
    repeat: Wrap, relaxed: bool | None, texels: Texels, columns: float, rows: float, maxima: Floats, block_rows: int,
    block_columns: int, i: int, j: int, near: bool, best: float,
) -> float:  # fmt: skip
    """The narrowest cone of texel (i, j) by all blocks, or with `near` by its own neighbours, which rule out most others."""
    u, v, height = (j + 0.5) / columns, (i + 0.5) / rows, texels[i * np.int64(columns) + j]
    copies = 0 if repeat is None or near else 1
    first_row, stop_row, first_column, stop_column = 0, block_rows, 0, block_columns
    if near:
        first_row, stop_row = max(0, i // BLOCK - 1), min(block_rows, i // BLOCK + 2)
        first_column, stop_column = max(0, j // BLOCK - 1), min(block_columns, j // BLOCK + 2)
    for shift_v in range(-copies, copies + 1):
        for row in range(first_row, stop_row):
            top, bottom = (row * BLOCK + 0.5) / rows + shift_v, (row * BLOCK + BLOCK - 0.5) / rows + shift_v
            across = _beside(v, top, bottom)
            if not across < best * (1.0 - height):
                continue
            for shift_u in range(-copies, copies + 1):
                for column in range(first_column, stop_column):
                    left = (column * BLOCK + 0.5) / columns + shift_u
                    along = _beside(u, left, left + (BLOCK - 1.0) / columns)
                    reach = best * (maxima[row * block_columns + column] - height)
                    if reach > 0.0 and along * along + across * across <= reach * reach:
                        best = _in_block(
                            repeat, relaxed, texels, columns, rows, i, j, row * BLOCK, column * BLOCK,
                            1.0 * shift_u, 1.0 * shift_v, best,
                        )  # fmt: skip
    return best


@device
def _cones_of_row(
    repeat: Wrap, relaxed: bool | None, texels: Texels, columns: float, rows: float, maxima: Floats, block_rows: int,
    block_columns: int, i: int, ratios: Texels,
) -> None:  # fmt: skip
    """Ratios of the texels of row i."""
    for j in range(np.int64(columns)):
        best = 1.0
        for near in (True, False):
            best = _cone(
                repeat, relaxed, texels, columns, rows, maxima, block_rows, block_columns, i, j, near, best
            )  # fmt: skip
        ratios[i * np.int64(columns) + j] = best


@kernel
def cones(
    repeat: Wrap, relaxed: bool | None, texels: Texels, columns: float, rows: float, maxima: Floats, block_rows: int,
    block_columns: int, ratios: Texels,
) -> None:  # fmt: skip
    """Ratios of all texels. relaxed: None or True."""
    for i in prange(np.int64(rows)):
        _cones_of_row(repeat, relaxed, texels, columns, rows, maxima, block_rows, block_columns, i, ratios)


def cone_map(heights: NDArray[np.float64], repeat: bool, relaxed: bool) -> NDArray[np.float64]:
    """Ratios (H, W) in (0, 1] of a read-only height map (H, W)."""
    rows, columns = heights.shape
    maxima = block_maxima(heights)
    ratios = np.empty(heights.shape)
    cones(
        True if repeat else None, True if relaxed else None, heights.reshape(-1), float(columns), float(rows),
        maxima.reshape(-1), maxima.shape[0], maxima.shape[1], ratios.reshape(-1),
    )  # fmt: skip
    return ratios


def cone_ratios(s: Sought, relaxed: bool) -> NDArray[np.float64]:
    """The cone map of a polygon, flat."""
    ratios: NDArray[np.float64] = s.prepared(
        ("cones", relaxed), lambda: cone_map(s.heights, s.repeat is not None, relaxed)
    )
    return ratios.reshape(-1)
