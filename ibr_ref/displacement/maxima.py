"""Coarse maps of maxima of a height map: they prove stretches of the linear search empty.

Level 0 holds, for every cell of 8 x 8 texels, the largest height that a bilinear fetch with its texture coordinate in
the cell can return; each further level halves the resolution. Nothing that the search returns depends on it: a step is
only skipped where no fetch could reach the ray.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import device, kernel, prange, routine

CELL = 8

_INFLATE = 1.0 + 2.0**-48  # a bilinear mix of equal texels may round up by a few units in the last place
_SLACK = 1e-6  # cells: covers the rounding of texture coordinates up to _FAR
_FAR = 1e5


class Maxima(NamedTuple):
    """All levels, one after the other."""

    values: NDArray[np.float64]
    """Flat."""
    offsets: NDArray[np.int64]
    """(L,) start of each level in `values`."""
    columns: NDArray[np.int64]
    """(L,) cells in a row of each level; the last level is one cell."""
    rows: NDArray[np.int64]
    """(L,)."""
    cells: NDArray[np.float64]
    """(2,) cells of level 0 in a unit of u and of v."""
    everywhere: float
    """The largest height of all."""


@kernel
def _cells(texels, rows, columns, values, cell_rows, cell_columns):
    for i in prange(cell_rows):
        for j in range(cell_columns):
            largest = 0.0
            for y in range(max(0, i * CELL - 1), min(rows, (i + 1) * CELL + 1)):
                for x in range(max(0, j * CELL - 1), min(columns, (j + 1) * CELL + 1)):
                    largest = max(largest, texels[y * columns + x])
            values[i * cell_columns + j] = largest * _INFLATE


@device
def _halve(values, source, source_rows, source_columns, target, rows, columns):
    for i in range(rows):
        for j in range(columns):
            largest = 0.0
            for y in range(2 * i, min(source_rows, 2 * i + 2)):
                for x in range(2 * j, min(source_columns, 2 * j + 2)):
                    largest = max(largest, values[source + y * source_columns + x])
            values[target + i * columns + j] = largest


@routine
def _coarser_levels(values, offsets, rows, columns):
    for level in range(1, len(offsets)):
        fine = level - 1
        _halve(values, offsets[fine], rows[fine], columns[fine], offsets[level], rows[level], columns[level])


def build(texels: NDArray[np.float64], rows: int, columns: int) -> Maxima:
    """The maps of a flat height map."""
    sizes = [(-(-rows // CELL), -(-columns // CELL))]
    while sizes[-1] != (1, 1):
        sizes.append((-(-sizes[-1][0] // 2), -(-sizes[-1][1] // 2)))
    counts = np.array([r * c for r, c in sizes])
    offsets = np.cumsum(counts) - counts
    values = np.empty(int(counts.sum()))
    _cells(texels, rows, columns, values, *sizes[0])
    all_rows, all_columns = np.array([r for r, _ in sizes]), np.array([c for _, c in sizes])
    _coarser_levels(values, offsets, all_rows, all_columns)
    return Maxima(
        values,
        offsets,
        all_columns,
        all_rows,
        np.array([columns / CELL, rows / CELL]),
        float(values[-1]),
    )


@device
def _cell_range(low, high, cells, count):
    """Level-0 cells that texture coordinates in [low, high] can fall into, clamped to the map."""
    first = np.floor(low * cells - _SLACK)
    last = np.floor(high * cells + _SLACK)
    first = np.int64(min(max(first, 0.0), count - 1.0))
    return first, np.int64(min(max(last, 0.0), count - 1.0))


@device
def highest(maxima, u_low, u_high, v_low, v_high):
    """An upper bound of every fetch with u in [u_low, u_high] and v in [v_low, v_high] (clamped), from four cells."""
    if not (max(abs(u_low), abs(u_high)) < _FAR and max(abs(v_low), abs(v_high)) < _FAR):
        return maxima.everywhere
    first_x, last_x = _cell_range(u_low, u_high, maxima.cells[0], maxima.columns[0])
    first_y, last_y = _cell_range(v_low, v_high, maxima.cells[1], maxima.rows[0])
    level = 0
    while last_x - first_x > 1 or last_y - first_y > 1:
        first_x, last_x, first_y, last_y = first_x >> 1, last_x >> 1, first_y >> 1, last_y >> 1
        level += 1
    columns, offset = maxima.columns[level], maxima.offsets[level]
    upper = max(maxima.values[offset + first_y * columns + first_x], maxima.values[offset + first_y * columns + last_x])
    lower = max(maxima.values[offset + last_y * columns + first_x], maxima.values[offset + last_y * columns + last_x])
    return max(upper, lower)
