"""Stages 2 and 3: the nine grids, and the map that is warped from four of the nine maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.shadows.lights import Lights

Cell = NDArray[np.int32]
Lines = list[Floats]
"""The three x and the three y of the maps."""


@dataclass(frozen=True)
class Warped:
    """The stage arrays of one sample of the light."""

    cell: Cell
    fraction: Floats
    shares: Floats
    row_grids: Floats
    rows: Floats
    grid: Floats
    image: Floats


class Warp(Lights):
    """From the maps that the case hands over to the one for a place of the object."""

    def controls(self) -> Floats:
        """(3, 3, R, C, 2) as the case gives them."""
        return self.do.matrix(self.inputs["maps"].controls)

    def images(self) -> Floats:
        """(3, 3, S, S) as the case gives them."""
        return self.do.matrix(self.inputs["maps"].image)

    def lines(self) -> Lines:
        """Of the maps that the case gives."""
        positions = self.do.matrix(self.inputs["maps"].positions)
        return [positions[0, :, 0], positions[:, 0, 1]]

    def upper(self, at: Floats, middle: Floats) -> Bools:
        """Whether an offset lies in the upper one of two cells."""
        return at >= middle

    def fraction_in(self, at: Floats, line: Floats, cell: int) -> Floats:
        """Of an offset in its cell."""
        return self.do.divide(self.do.subtract(at, line[cell]), self.do.subtract(line[cell + 1], line[cell]))

    def find(self, lines: Lines, at: Floats) -> tuple[Cell, Floats]:
        """Cell and fraction, (2,) each, x first, of an offset."""
        cell = [int(bool(self.upper(at[k], lines[k][1]))) for k in range(2)]
        return np.array(cell, np.int32), np.stack([self.fraction_in(at[k], lines[k], cell[k]) for k in range(2)])

    def corners(self, array: Floats, cell: Cell) -> Vector:
        """Of nine images or grids those of a cell: 00, 10 (the next along x), 01, 11."""
        i, j = cell.tolist()
        return [array[j, i], array[j, i + 1], array[j + 1, i], array[j + 1, i + 1]]

    @property
    def projective(self) -> bool:
        """Whether maps are passed through at the pace of perspective."""
        return bool(self.params.interpolation == "projective")

    def caster_middle(self) -> Vector:
        """Of its box, about its own origin."""
        vertices = np.asarray(self.scene.caster.vertices)
        low, high = (self.do.number(end) for end in (vertices.min(axis=0), vertices.max(axis=0)))
        return list(self.do.multiply(self.do.add(low, high), 0.5))

    def caster_depths(self, lines: Lines) -> Floats:
        """(3, 3) of the middle of the caster's box along the light's view axis, at the lines of the maps."""
        return np.stack([np.stack([self.depth_at(x, y) for x in lines[0]]) for y in lines[1]])

    def depth_at(self, x: Floats, y: Floats) -> Floats:
        """Of the middle of the caster's box where the object stands at an offset."""
        middle, (a, b) = self.caster_middle(), [list(axis) for axis in self.axes]
        at = [self.do.sum([middle[k], self.do.multiply(x, a[k]), self.do.multiply(y, b[k])]) for k in range(3)]
        return -self.do.dot([*at, 1.0], list(self.light_view(self.centre)[2]))

    def paced(self, fraction: Floats, w0: Floats, w1: Floats) -> Floats:
        """Of the way in the map, after a fraction of the way between two depths."""
        gone = self.do.multiply(fraction, w1)
        return self.do.divide(gone, self.do.add(self.do.multiply(self.do.subtract(1.0, fraction), w0), gone))

    def shares(self, cell: Cell, fraction: Floats, depths: Floats) -> Vector:
        """Of the upper row, of the lower row, and between the two."""
        s, t = fraction
        if not self.projective:
            return [s, s, t]
        w = self.corners(depths, cell)
        between = [self.do.lerp(w[0], w[1], s), self.do.lerp(w[2], w[3], s)]
        return [self.paced(s, w[0], w[1]), self.paced(s, w[2], w[3]), self.paced(t, *between)]

    def row_grid(self, first: Floats, second: Floats, share: Floats) -> Floats:
        """(R, C, 2) between the two grids of a row of the cell."""
        return self.do.lerp(first, second, share)

    def final_grid(self, top: Floats, bottom: Floats, share: Floats) -> Floats:
        """(R, C, 2) between the two grids of the rows."""
        return self.do.lerp(top, bottom, share)

    def row_grids(self, grids: Sequence[Floats], shares: Vector) -> list[Floats]:
        """Two (R, C, 2), of the grids of a cell."""
        return [self.row_grid(grids[k], grids[k + 1], share) for k, share in ((0, shares[0]), (2, shares[1]))]

    def rows(
        self, maps: Sequence[Floats], grids: Sequence[Floats], between: Sequence[Floats], shares: Vector
    ) -> Vector:
        """Two (S, S): each row's maps, warped from their grids to the one between them."""
        return [
            self.between(maps[k : k + 2], grids[k : k + 2], grid, share)
            for k, grid, share in zip((0, 2), between, shares[:2], strict=True)
        ]

    def warped(self, place: Floats, controls: Floats, images: Floats, lines: Lines) -> Warped:
        """The map for a sample of the light, six warps, or three."""
        cell, fraction = self.find(lines, self.place_of_object(place))
        grids, maps = self.corners(controls, cell), self.corners(images, cell)
        shares = self.shares(cell, fraction, self.caster_depths(lines) if self.projective else None)
        between = self.row_grids(grids, shares)
        rows = self.rows(maps, grids, between, shares)
        grid = self.final_grid(between[0], between[1], shares[2])
        image = self.finished(rows, between, grid, shares)
        return Warped(cell, fraction, np.stack(shares), np.stack(between), np.stack(rows), grid, image)

    def finished(self, rows: Sequence[Floats], grids: Sequence[Floats], grid: Floats, shares: Vector) -> Floats:
        """(S, S) the result, between the two rows."""
        return self.between(rows, grids, grid, shares[2])

    def between(self, images: Sequence[Floats], grids: Sequence[Floats], grid: Floats, fraction: Floats) -> Floats:
        """(S, S) of two images, warped from their grids to one that lies between them."""

        def one(k: int) -> Any:
            return self.warp(images[k], grids[k], grid)

        if self.params.policy == "nearest":
            return self.do.pick(self.second_is_nearer(fraction), lambda: one(1), lambda: one(0))
        return self.mix(one(0), one(1), fraction)

    def second_is_nearer(self, fraction: Floats) -> Bools:
        """Which of two images."""
        return fraction >= 0.5

    def mix(self, first: Floats, second: Floats, fraction: Floats) -> Floats:
        """The dissolve of two warped images."""
        return self.do.lerp(first, second, fraction)

    def mesh(self, rows: int, columns: int) -> Ints:
        """(T, 3) indices of control points: cells row by row, two triangles in each."""
        first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1, 1)
        return np.stack([first + corners for corners in self.halves(columns)], axis=1).reshape(-1, 3)

    def halves(self, columns: int) -> list[Ints]:
        """The two triangles of the cell at (0, 0)."""
        return [np.array([0, 1, columns + 1]), np.array([0, columns + 1, columns])]

    def texels(self, points: Floats, size: int) -> Floats:
        """Positions in the map, in texels: from [0, 1] at once, or by way of a window's [-1, 1]."""
        at = self.do.multiply(points, float(size))
        return self.do.either(at, lambda: self.by_window(points, size))

    def by_window(self, points: Floats, size: int) -> Floats:
        """From [0, 1] to [-1, 1], and from there to the window."""
        ndc = self.do.subtract(self.do.multiply(points, 2.0), 1.0)
        return self.do.multiply(self.do.add(ndc, 1.0), 0.5 * size)

    def empty(self) -> float:
        """A texel beside the mesh."""
        return 0.0 if self.params.content == "mask" else 1.0

    def warp(self, image: Floats, source: Floats, target: Floats) -> Floats:
        """(S, S) an image redrawn: triangles at `target`, texture coordinates `source`, both (R, C, 2)."""
        if self.do.bounded:
            return self.do.warped(self, image, source, target)
        raster, size = self.warp_raster(self.do), len(image)
        mesh = self.mesh(*source.shape[:2])
        at = self.texels(target, size).reshape(-1, 2)[mesh]
        fragments = raster.cover(at[..., 0], at[..., 1], size, size)
        last = np.full(size * size, -1)
        last[fragments.pixel] = np.arange(len(fragments.pixel))  # the last one of equal indices stays
        fragments = fragments.take(last[last >= 0])
        u, v = (raster.linear(fragments, source[..., k].reshape(-1)[mesh]) for k in range(2))
        result = np.full(size * size, self.empty())
        result[fragments.pixel] = self.warp_sampler(self.do).bilinear(image, u, v)
        return result.reshape(size, size)
