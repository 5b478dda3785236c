"""Bugs in taking a map from n x n that were made beforehand."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.shadows.hidden import BELOW_A_BYTE
from ibr_ref.oracle.programs.program import Bools, Floats, Path, Vector
from ibr_ref.oracle.programs.shadows.port import Port

GRID = Bugs("warp", only=("grid",))


@GRID.add("grid-n-intervals")
class _NIntervals(Port):
    """The range is divided by n, not by n - 1: the last map is not on its end."""

    def intervals(self) -> int:
        return super().intervals() + 1


@GRID.add("grid-range-not-widened")
class _NotWidened(Port):
    """The maps reach from end to end of the range, which is not widened for the samples of the light."""

    def grid_ends(self) -> list[Vector]:
        return [list(self.do.number(ends)) for ends in np.asarray(self.scene.offset_range)]


@GRID.add("grid-axes-exchanged")
class _AxesExchanged(Port):
    """Maps are indexed [i, j]."""

    def grid_image(self, i: int, j: int) -> Floats:
        return super().grid_image(j, i)


@GRID.add("grid-rows-from-below")
class _RowsFromBelow(Port):
    """Rows of maps are counted from the other end of y."""

    def grid_image(self, i: int, j: int) -> Floats:
        return super().grid_image(i, self.intervals() - j)


@GRID.add("grid-nearest-alone")
class _NearestAlone(Port):
    """The nearest map is taken where the four are to be mixed."""

    taken: ClassVar[dict[Path, Any]] = {("params", "grid_mix"): False}


@GRID.add("grid-mix-reversed")
class _MixReversed(Port):
    """The mix weighs a map by how far away it is."""

    def fraction_in_grid(self, at: Floats, cell: int) -> Floats:
        return self.do.subtract(1.0, super().fraction_in_grid(at, cell))


@GRID.add("grid-first-of-the-cell")
class _FirstOfCell(Port):
    """The four maps are not mixed: the place is truncated to the first one."""

    def fraction_in_grid(self, at: Floats, cell: int) -> Floats:
        return self.do.multiply(super().fraction_in_grid(at, cell), 0.0)


@GRID.add("grid-mixed-along-x-alone")
class _AlongX(Port):
    """The two maps along x are mixed, the nearest along y is taken."""

    def in_grid(self, i: int, j: int, s: Floats, t: Floats) -> Floats:
        return self.nearer_of(t, lambda k: self.of_row(i, j + k, s))


@GRID.add("grid-cell-rounded")
class _Rounded(Port):
    """The cell is found by rounding: beyond its middle it is left by the mix."""

    def reaches(self, at: Floats, line: int) -> Bools:
        return np.ones((), np.bool_)


@GRID.add("grid-mix-of-three")
class _OfThree(Port):
    """The mix is linear in a triangle of maps: the fourth is left out."""

    def in_grid(self, i: int, j: int, s: Floats, t: Floats) -> Floats:
        first = self.grid_image(i, j)
        along = [self.do.subtract(self.grid_image(*at), first) for at in ((i + 1, j), (i, j + 1))]
        return self.do.dot([first, *along], [1.0, s, t])


@GRID.add("grid-eased")
class _Eased(Port):
    """Fractions go through smoothstep()."""

    def fraction_in_grid(self, at: Floats, cell: int) -> Floats:
        f = super().fraction_in_grid(at, cell)
        return self.do.multiply(self.do.multiply(f, f), self.do.subtract(3.0, self.do.multiply(2.0, f)))


@GRID.add("grid-fractions-of-16")
class _Of16(Port):
    """Fractions are truncated to sixteenths."""

    def fraction_in_grid(self, at: Floats, cell: int) -> Floats:
        return np.floor(super().fraction_in_grid(at, cell) * 16.0) / 16.0


@GRID.add("grid-maps-in-bytes", small=True, hidden=BELOW_A_BYTE)
class _Bytes(Port):
    """Maps are held in bytes, and a count over k^2 is none."""

    def grid_image(self, i: int, j: int) -> Floats:
        return np.rint(super().grid_image(i, j) * 255.0) / 255.0


@GRID.add("grid-pixel-centres")
class _PixelCentres(Port):
    """Maps are taken for texels: the first lies half an interval inside of the range's end."""

    def lines_from_first(self, at: Floats, low: Floats, high: Floats) -> Floats:
        share = self.do.divide(self.do.subtract(at, low), self.do.subtract(high, low))
        return self.do.subtract(self.do.multiply(share, float(self.intervals() + 1)), 0.5)
