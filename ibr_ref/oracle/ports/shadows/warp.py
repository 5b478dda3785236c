"""Stages 2 and 3: the nine grids, and the map that is warped from four of the nine maps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Ints
from ibr_ref.oracle.ports.shadows.lights import Lights


@dataclass(frozen=True)
class Warped:
    """The stage arrays of one sample of the light."""

    cell: NDArray[np.int32]
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
        return self.ops.number(self.inputs["maps"].controls)

    def images(self) -> Floats:
        """(3, 3, S, S) as the case gives them."""
        return self.ops.number(self.inputs["maps"].image)

    def lines(self) -> list[Floats]:
        """The three x and the three y of the maps that the case gives."""
        positions = self.ops.number(self.inputs["maps"].positions)
        return [positions[0, :, 0], positions[:, 0, 1]]

    def place_of_object(self, place: Floats) -> Floats:
        """(2,) where the object stands relative to a sample of the light: moved the opposite way."""
        return self.ops.subtract(self.offset, self.displacement(place))

    def upper(self, at: float, middle: float) -> int:
        """Whether an offset lies in the upper one of two cells."""
        return int(at >= middle)

    def fraction_in(self, at: float, ends: Floats) -> Floats:
        """Of an offset in its cell."""
        return self.ops.divide(self.ops.subtract(at, ends[0]), self.ops.subtract(ends[1], ends[0]))

    def find(self, at: Floats) -> tuple[NDArray[np.int32], Floats]:
        """Cell and fraction, (2,) each, x first, of an offset."""
        lines = self.lines()
        cell = [self.upper(float(at[k]), float(lines[k][1])) for k in range(2)]
        fraction = [self.fraction_in(float(at[k]), lines[k][cell[k] : cell[k] + 2]) for k in range(2)]
        return np.array(cell, np.int32), np.array(fraction)

    def corners(self, array: Floats, cell: NDArray[np.int32]) -> list[Floats]:
        """Of nine images or grids those of a cell: 00, 10 (the next along x), 01, 11."""
        i, j = cell.tolist()
        return [array[j, i], array[j, i + 1], array[j + 1, i], array[j + 1, i + 1]]

    @property
    def projective(self) -> bool:
        """Whether maps are passed through at the pace of perspective."""
        return bool(self.params.interpolation == "projective")

    def caster_depths(self) -> Floats:
        """(3, 3) of the middle of the caster's box along the light's view axis, at the lines of the maps."""
        vertices = self.ops.number(self.scene.caster.vertices)
        middle = self.ops.multiply(self.ops.add(vertices.min(axis=0), vertices.max(axis=0)), 0.5)
        backwards, depths = self.light_view(self.centre)[2], np.empty((3, 3))
        xs, ys = self.lines()
        for j, i in np.ndindex(3, 3):
            offset = xs[i], ys[j]
            at = self.ops.sum([middle, *(self.ops.multiply(offset[k], self.axes[k]) for k in range(2))])
            depths[j, i] = -self.ops.dot([*at, 1.0], list(backwards))
        return depths

    def paced(self, fraction: Floats, w0: Floats, w1: Floats) -> Floats:
        """Of the way in the map, after a fraction of the way between two depths."""
        gone = self.ops.multiply(fraction, w1)
        return self.ops.divide(gone, self.ops.add(self.ops.multiply(self.ops.subtract(1.0, fraction), w0), gone))

    def shares(self, cell: NDArray[np.int32], fraction: Floats) -> Floats:
        """(3,) of the upper row, of the lower row, and between the two."""
        s, t = fraction
        if not self.projective:
            return np.array([s, s, t])
        w = self.corners(self.caster_depths(), cell)
        between = [self.ops.lerp(w[0], w[1], s), self.ops.lerp(w[2], w[3], s)]
        return np.array([self.paced(s, w[0], w[1]), self.paced(s, w[2], w[3]), self.paced(t, *between)])

    def row_grid(self, first: Floats, second: Floats, share: Floats) -> Floats:
        """(R, C, 2) between the two grids of a row of the cell."""
        return self.ops.lerp(first, second, share)

    def final_grid(self, top: Floats, bottom: Floats, share: Floats) -> Floats:
        """(R, C, 2) between the two grids of the rows."""
        return self.ops.lerp(top, bottom, share)

    def warped(self, place: Floats, controls: Floats, images: Floats) -> Warped:
        """The map for a sample of the light, six warps, or three."""
        cell, fraction = self.find(self.place_of_object(place))
        grids, maps = self.corners(controls, cell), self.corners(images, cell)
        shares = self.shares(cell, fraction)
        between, rows = [], []
        for k, share in ((0, shares[0]), (2, shares[1])):
            between.append(self.row_grid(grids[k], grids[k + 1], share))
            rows.append(self.between(maps[k : k + 2], grids[k : k + 2], between[-1], share))
        grid = self.final_grid(between[0], between[1], shares[2])
        image = self.finished(rows, between, grid, shares)
        return Warped(cell, fraction, shares, np.stack(between), np.stack(rows), grid, image)

    def finished(self, rows: list[Floats], grids: list[Floats], grid: Floats, shares: Floats) -> Floats:
        """(S, S) the result, between the two rows."""
        return self.between(rows, grids, grid, shares[2])

    def between(self, images: list[Floats], grids: list[Floats], grid: Floats, fraction: Floats) -> Floats:
        """(S, S) of two images, warped from their grids to one that lies between them."""
        if self.params.policy == "nearest":
            nearer = self.nearer(float(fraction))
            return self.warp(images[nearer], grids[nearer], grid)
        first, second = (self.warp(image, source, grid) for image, source in zip(images, grids, strict=True))
        return self.mix(first, second, fraction)

    def nearer(self, fraction: float) -> int:
        """Which of two images."""
        return int(fraction >= 0.5)

    def mix(self, first: Floats, second: Floats, fraction: Floats) -> Floats:
        """The dissolve of two warped images."""
        return self.ops.lerp(first, second, fraction)

    def mesh(self, rows: int, columns: int) -> Ints:
        """(T, 3) indices of control points: cells row by row, two triangles in each."""
        first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1, 1)
        return np.stack([first + corners for corners in self.halves(columns)], axis=1).reshape(-1, 3)

    def halves(self, columns: int) -> list[Ints]:
        """The two triangles of the cell at (0, 0)."""
        return [np.array([0, 1, columns + 1]), np.array([0, columns + 1, columns])]

    def texels(self, points: Floats, size: int) -> Floats:
        """Positions in the map, in texels."""
        return self.ops.multiply(points, size)

    def warp(self, image: Floats, source: Floats, target: Floats) -> Floats:
        """(S, S) an image redrawn: triangles at `target`, texture coordinates `source`, both (R, C, 2)."""
        raster, size = self.warp_raster(self.ops), len(image)
        mesh = self.mesh(*source.shape[:2])
        at = self.texels(target, size).reshape(-1, 2)[mesh]
        fragments = raster.cover(at[..., 0], at[..., 1], size, size)
        last = np.full(size * size, -1)
        last[fragments.pixel] = np.arange(len(fragments.pixel))  # the last one of equal indices stays
        fragments = fragments.take(last[last >= 0])
        u, v = (raster.linear(fragments, source[..., k].reshape(-1)[mesh]) for k in range(2))
        result = np.full(size * size, 0.0 if self.params.content == "mask" else 1.0)
        result[fragments.pixel] = self.warp_sampler(self.ops).bilinear(image, u, v)
        return result.reshape(size, size)
