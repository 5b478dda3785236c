"""Coarse maps of maxima of a height map: they prove stretches of the linear search empty.

Level 0 holds, for every cell of 8 x 8 texels, the largest height that a bilinear fetch with its texture coordinate in
the cell can return; each further level halves the resolution. Nothing that the search returns depends on it: a step is
only skipped where no fetch could reach the ray.

Arrays: values, offsets, columns and rows as in `Maxima`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Ints, Texels
from ibr_ref.jit import device, kernel, prange, routine
from ibr_ref.pipeline.sampling import clamped

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


Grid = tuple[float, float, float, float, float, float, float]
"""Of a level: its offset in the values, cells in a row, cells in a unit of u and of v, the largest column and row of a
cell, and the slack in cells."""
Cells = tuple[np.int32, np.int32, np.int32, np.int32]
"""Indices of cells in the values."""


@kernel
def _cells(texels: Texels, rows: int, columns: int, values: Floats, cell_rows: int, cell_columns: int) -> None:
    """Level 0, cell_rows x cell_columns, of a height map of rows x columns texels."""
    for i in prange(cell_rows):
        for j in range(cell_columns):
            largest = 0.0
            for y in range(max(0, i * CELL - 1), min(rows, (i + 1) * CELL + 1)):
                for x in range(max(0, j * CELL - 1), min(columns, (j + 1) * CELL + 1)):
                    largest = max(largest, texels[y * columns + x])
            values[i * cell_columns + j] = largest * _INFLATE


@device
def _halve(
    values: Floats, source: int, source_rows: int, source_columns: int, target: int, rows: int, columns: int
) -> None:
    """A level, from `target` on, of the finer one that begins at `source`."""
    for i in range(rows):
        for j in range(columns):
            largest = 0.0
            for y in range(2 * i, min(source_rows, 2 * i + 2)):
                for x in range(2 * j, min(source_columns, 2 * j + 2)):
                    largest = max(largest, values[source + y * source_columns + x])
            values[target + i * columns + j] = largest


@routine
def _coarser_levels(values: Floats, offsets: Ints, rows: Ints, columns: Ints) -> None:
    """All levels but the first."""
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
def level_for(maxima: Maxima, width: float, height: float) -> Grid:
    """The finest level at which a range of (u, v) so wide and high falls into two cells each way.

    As a grid: offset in the values, cells in a row, cells in a unit of u and v, the largest indices of cells.
    """
    cells = max(width * maxima.cells[0], height * maxima.cells[1]) + 4.0 * _SLACK
    level, scale = 0, 1.0
    while not cells * scale <= 1.0 and level < len(maxima.offsets) - 1:
        level += 1
        scale *= 0.5
    columns, rows = np.float64(maxima.columns[level]), np.float64(maxima.rows[level])
    offset = np.float64(maxima.offsets[level])
    return offset, columns, maxima.cells[0] * scale, maxima.cells[1] * scale, columns - 1.0, rows - 1.0, _SLACK * scale


@device
def cells_in(grid: Grid, u_low: float, u_high: float, v_low: float, v_high: float) -> Cells:
    """Indices of the four cells that u in [u_low, u_high] and v in [v_low, v_high] (clamped) reach at most."""
    offset, columns, across, along, last_column, last_row, slack = grid
    left = clamped(np.floor(u_low * across - slack), 0.0, last_column)
    right = clamped(np.floor(u_high * across + slack), 0.0, last_column)
    top = clamped(np.floor(v_low * along - slack), 0.0, last_row) * columns + offset
    bottom = clamped(np.floor(v_high * along + slack), 0.0, last_row) * columns + offset
    return np.int32(top + left), np.int32(top + right), np.int32(bottom + left), np.int32(bottom + right)


@device
def within_reach(u_low: float, u_high: float, v_low: float, v_high: float) -> bool:
    """Whether coordinates round by so little that `cells_in` holds."""
    return (abs(u_low) < _FAR) & (abs(u_high) < _FAR) & (abs(v_low) < _FAR) & (abs(v_high) < _FAR)


@device
def highest(maxima: Maxima, u_low: float, u_high: float, v_low: float, v_high: float) -> float:
    """An upper bound of every fetch with u in [u_low, u_high] and v in [v_low, v_high] (clamped)."""
    grid = level_for(maxima, u_high - u_low, v_high - v_low)
    first, second, third, fourth = cells_in(grid, u_low, u_high, v_low, v_high)
    values = maxima.values
    here = max(max(values[first], values[second]), max(values[third], values[fourth]))
    return here if within_reach(u_low, u_high, v_low, v_high) else maxima.everywhere
