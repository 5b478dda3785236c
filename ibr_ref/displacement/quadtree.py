"""A maximum mipmap (Tevs et al. 2008): how high the surface is at most, over cells of every size.

Level 0 holds, for each cell between four texel centres, the largest of the four heights; each further level halves the
resolution, up to one cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Floats, Ints


class Quadtree(NamedTuple):
    """All levels, one after the other, the finest first."""

    values: Floats
    """Flat."""
    offsets: Ints
    """(L,) start of each level in `values`."""
    columns: Ints
    """(L,) cells in a row of each level; the last level is one cell."""
    rows: Ints
    """(L,)."""


def build(heights: Floats, repeat: bool) -> Quadtree:
    """The quadtree of a height map (H, W): H + 1 by W + 1 cells, the outer ones in half texels; of a repeated one H by W."""
    widths = [(0, 1), (0, 1)] if repeat else [(1, 1), (1, 1)]
    texels = np.pad(heights, widths, mode="wrap" if repeat else "edge")
    corners = texels[:-1, :-1], texels[:-1, 1:], texels[1:, :-1], texels[1:, 1:]
    levels = [np.maximum.reduce(corners)]
    while levels[-1].size > 1:
        fine = levels[-1]
        fine = np.pad(fine, [(0, fine.shape[0] % 2), (0, fine.shape[1] % 2)], constant_values=0.0)
        levels.append(fine.reshape(fine.shape[0] // 2, 2, fine.shape[1] // 2, 2).max(axis=(1, 3)))
    sizes = np.array([level.size for level in levels])
    return Quadtree(
        np.concatenate([level.reshape(-1) for level in levels]),
        np.cumsum(sizes) - sizes,
        np.array([level.shape[1] for level in levels]),
        np.array([level.shape[0] for level in levels]),
    )
