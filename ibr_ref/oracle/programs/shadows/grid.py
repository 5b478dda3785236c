"""The map for a place of the object from n x n maps made beforehand, without a warp."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Self

import numpy as np

from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.maps import Maps


class Grid(Maps):
    """Method "grid"."""

    def on(self, do: Any) -> Self:
        """On another arithmetic: a device's, or bounds of what devices make of it."""
        self.grid_images: dict[tuple[int, int], Floats] = {}
        return super().on(do)

    def grid_map(self, place: Floats) -> Floats:
        """(S, S) for a sample of the light: the mix of the four maps around the object, or the nearest."""
        seen = self.place_of_object(place)
        x, y = (self.lines_from_first(seen[k], *end) for k, end in enumerate(self.grid_ends()))
        return self.in_cell(y, lambda j, t: self.in_cell(x, lambda i, s: self.in_grid(i, j, s, t)))

    def grid_ends(self) -> list[Vector]:
        """Offsets of the first and of the last map, on x and on y."""
        return self.widened_range()

    def intervals(self) -> int:
        """From the first map to the last along either axis."""
        return int(self.params.grid_size) - 1

    def lines_from_first(self, at: Floats, low: Floats, high: Floats) -> Floats:
        """Where an offset lies, the first map at 0, the last one at n - 1."""
        share = self.do.divide(self.do.subtract(at, low), self.do.subtract(high, low))
        return self.do.multiply(share, float(self.intervals()))

    def in_cell(self, at: Floats, made: Callable[[int, Floats], Floats]) -> Floats:
        """What is made of the cell that holds a place, and of the fraction in it; of either cell where it is on a line."""
        line = int(np.rint(float(at)))

        def of(cell: int) -> Floats:
            cell = min(max(cell, 0), self.intervals() - 1)
            return made(cell, self.fraction_in_grid(at, cell))

        return self.do.pick(self.reaches(at, line), lambda: of(line), lambda: of(line - 1))

    def reaches(self, at: Floats, line: int) -> Bools:
        """Whether a place is on the upper side of a line, or on it."""
        return at >= float(line)

    def fraction_in_grid(self, at: Floats, cell: int) -> Floats:
        """From the cell's map to the next."""
        return self.do.subtract(at, float(cell))

    def in_grid(self, i: int, j: int, s: Floats, t: Floats) -> Floats:
        """(S, S) at the fractions s along x and t along y of the cell of column i and row j."""
        if not self.params.grid_mix:
            return self.nearer_of(t, lambda k: self.nearer_of(s, lambda m: self.grid_image(i + m, j + k)))
        top, bottom = (self.of_row(i, row, s) for row in (j, j + 1))
        return self.do.lerp(top, bottom, t)

    def of_row(self, i: int, j: int, s: Floats) -> Floats:
        """(S, S) between two maps of a row."""
        return self.do.lerp(self.grid_image(i, j), self.grid_image(i + 1, j), s)

    def nearer_of(self, fraction: Floats, made: Callable[[int], Floats]) -> Floats:
        """Of the cell's map (0) or of the next (1), which is taken from the middle on."""
        return self.do.pick(fraction >= 0.5, lambda: made(1), lambda: made(0))

    def grid_image(self, i: int, j: int) -> Floats:
        """(S, S) the map of column i and row j, drawn once."""
        if (i, j) not in self.grid_images:
            self.grid_images[i, j] = self.centre_map(self.grid_position(i, j))
        return self.grid_images[i, j]

    def grid_position(self, i: int, j: int) -> Floats:
        """(2,) of the object in that map."""
        return np.stack(
            [
                self.do.lerp(low, high, self.do.divide(float(line), float(self.intervals())))
                for (low, high), line in zip(self.grid_ends(), (i, j), strict=True)
            ]
        )
