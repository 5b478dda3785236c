"""Bugs in how the four maps around the object's place become one: cells, fractions, grids between them, mixes."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.faults.shadows.hidden import BELOW_A_BYTE
from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.warp import Cell

DISSOLVE = Bugs("warp", only=("warp",))


@DISSOLVE.add("warp-s-for-t")
class _RowsMixedByS(Port):
    """The rows are mixed by s."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return self.between(rows, grids, grid, shares[0])


@DISSOLVE.add("warp-even-cells")
class _EvenCells(Port):
    """Fractions are of half the range, though the middle line is not in its middle."""

    def fraction_in(self, at: Floats, line: Floats, cell: int) -> Floats:
        return self.do.divide(self.do.subtract(at, line[cell]), (line[2] - line[0]) / 2.0)


@DISSOLVE.add("warp-fraction-8-bits", small=True, hidden=BELOW_A_BYTE)
class _Fraction8(Port):
    """Fractions are rounded to 1/256."""

    def fraction_in(self, at: Floats, line: Floats, cell: int) -> Floats:
        return np.rint(super().fraction_in(at, line, cell) * 256.0) / 256.0


@DISSOLVE.add("warp-pace-even")
class _EvenPace(Port):
    """The fractions themselves are taken for the projective ones."""

    def paced(self, fraction: Floats, w0: Floats, w1: Floats) -> Floats:
        return fraction


@DISSOLVE.add("warp-pace-reversed")
class _PaceReversed(Port):
    """The projective fraction has the two depths exchanged."""

    def paced(self, fraction: Floats, w0: Floats, w1: Floats) -> Floats:
        return super().paced(fraction, w1, w0)


@DISSOLVE.add("warp-pace-of-the-upper-row")
class _PaceOfUpper(Port):
    """The projective fraction of the upper row serves the lower one too."""

    def shares(self, cell: Cell, fraction: Floats, depths: Floats) -> Vector:
        upper, _, between = super().shares(cell, fraction, depths)
        return [upper, upper, between]


@DISSOLVE.add("warp-cell-exchanged")
class _CellExchanged(Port):
    """Maps and grids of the cell are indexed [i, j]."""

    def corners(self, array: Floats, cell: Cell) -> Vector:
        return super().corners(array, cell[::-1])


@DISSOLVE.add("warp-always-first-cell")
class _FirstCell(Port):
    """The cell is found by truncation towards the first one."""

    def upper(self, at: Floats, middle: Floats) -> Bools:
        return np.zeros((), np.bool_)


@DISSOLVE.add("warp-grids-half-floats", small=True, hidden=BELOW_A_BYTE)
class _HalfGrids(Port):
    """The grids of the rows are held in half floats."""

    def row_grid(self, first: Floats, second: Floats, share: Floats) -> Floats:
        return half(super().row_grid(first, second, share))


@DISSOLVE.add("warp-mix-reversed")
class _MixReversed(Port):
    """The dissolve mixes (s, 1 - s)."""

    def mix(self, first: Floats, second: Floats, fraction: Floats) -> Floats:
        return super().mix(second, first, fraction)


@DISSOLVE.add("warp-farther-image")
class _Farther(Port):
    """The farther image is warped by policy "nearest"."""

    def second_is_nearer(self, fraction: Floats) -> Bools:
        return fraction < 0.5


@DISSOLVE.add("warp-rows-not-warped")
class _RowsNotWarped(Port):
    """The rows are mixed without a second warp."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return self.between(rows, [grid, grid], grid, shares[2])


@DISSOLVE.add("warp-rows-truncated", small=True, hidden=BELOW_A_BYTE)
class _RowsTruncated(Port):
    """Rows are truncated to bytes between the passes."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return super().finished([np.floor(row * 255.0) / 255.0 for row in rows], grids, grid, shares)


@DISSOLVE.add("warp-t-upwards")
class _Upwards(Port):
    """The fractions of the rows are counted from below: 1 - t."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return super().finished(rows, grids, grid, [*shares[:2], self.do.subtract(1.0, shares[2])])


@DISSOLVE.add("warp-rows-exchanged")
class _RowsExchanged(Port):
    """The upper row is taken for the lower one in the last step."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return super().finished(rows[::-1], grids, grid, shares)


@DISSOLVE.add("warp-images-not-warped")
class _NotWarped(Port):
    """Images are mixed where they are: a cross dissolve."""

    def warp(self, image: Floats, source: Floats, target: Floats) -> Floats:
        return super().warp(image, source, source)


@DISSOLVE.add("warp-first-map-twice")
class _FirstTwice(Port):
    """The next map along x is the same one: i + 1 is left out."""

    def rows(self, maps: Vector, grids: Vector, between: Vector, shares: Vector) -> Vector:
        return super().rows([maps[0], maps[0], maps[2], maps[2]], grids, between, shares)


@DISSOLVE.add("warp-eased")
class _Eased(Port):
    """Fractions go through smoothstep()."""

    def fraction_in(self, at: Floats, line: Floats, cell: int) -> Floats:
        f = super().fraction_in(at, line, cell)
        return self.do.multiply(self.do.multiply(f, f), self.do.subtract(3.0, self.do.multiply(2.0, f)))


@DISSOLVE.add("warp-grid-of-the-upper-row")
class _UpperGrid(Port):
    """The result is drawn in the upper row's grid."""

    def final_grid(self, top: Floats, bottom: Floats, share: Floats) -> Floats:
        return 1.0 * top
