"""Bugs between the nine maps and the one for a place of the object."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.shadows.hidden import BELOW_A_BYTE
from ibr_ref.oracle.faults.shadows.systems import MAPPED
from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import Raster
from ibr_ref.oracle.programs.shadows.sampler import Sampler
from ibr_ref.oracle.programs.shadows.warp import Cell

WARP = Bugs("warp", only=("warp",))

PLACED = ("warp", "grid")
"""Where the object's place as a sample sees it matters."""

ANY_ORDER = "the sum of all samples is the same in any order"


@WARP.add("warp-listed-by-distance", only=MAPPED, hidden=ANY_ORDER)
class _ByDistance(Port):
    """Samples that are listed are taken from the light's centre outwards."""

    def sample_places(self) -> Vector:
        places = super().sample_places()
        if not isinstance(self.params.light_samples, np.ndarray):
            return places
        return sorted(places, key=self._away)

    def _away(self, place: Floats) -> float:
        way = list(place - self.centre)
        return float(self.do.dot(way, way))


@WARP.add("warp-s-for-t")
class _RowsMixedByS(Port):
    """The rows are mixed by s."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return self.between(rows, grids, grid, shares[0])


@WARP.add("warp-even-cells")
class _EvenCells(Port):
    """Fractions are of half the range, though the middle line is not in its middle."""

    def fraction_in(self, at: Floats, line: Floats, cell: int) -> Floats:
        return self.do.divide(self.do.subtract(at, line[cell]), (line[2] - line[0]) / 2.0)


@WARP.add("warp-fraction-8-bits", small=True, hidden=BELOW_A_BYTE)
class _Fraction8(Port):
    """Fractions are rounded to 1/256."""

    def fraction_in(self, at: Floats, line: Floats, cell: int) -> Floats:
        return np.rint(super().fraction_in(at, line, cell) * 256.0) / 256.0


@WARP.add("warp-pace-even")
class _EvenPace(Port):
    """The fractions themselves are taken for the projective ones."""

    def paced(self, fraction: Floats, w0: Floats, w1: Floats) -> Floats:
        return fraction


@WARP.add("warp-pace-reversed")
class _PaceReversed(Port):
    """The projective fraction has the two depths exchanged."""

    def paced(self, fraction: Floats, w0: Floats, w1: Floats) -> Floats:
        return super().paced(fraction, w1, w0)


@WARP.add("warp-pace-of-the-upper-row")
class _PaceOfUpper(Port):
    """The projective fraction of the upper row serves the lower one too."""

    def shares(self, cell: Cell, fraction: Floats, depths: Floats) -> Vector:
        upper, _, between = super().shares(cell, fraction, depths)
        return [upper, upper, between]


@WARP.add("warp-cell-exchanged")
class _CellExchanged(Port):
    """Maps and grids of the cell are indexed [i, j]."""

    def corners(self, array: Floats, cell: Cell) -> Vector:
        return super().corners(array, cell[::-1])


@WARP.add("warp-always-first-cell")
class _FirstCell(Port):
    """The cell is found by truncation towards the first one."""

    def upper(self, at: Floats, middle: Floats) -> Bools:
        return np.zeros((), np.bool_)


@WARP.add("warp-grids-half-floats", small=True, hidden=BELOW_A_BYTE)
class _HalfGrids(Port):
    """The grids of the rows are held in half floats."""

    def row_grid(self, first: Floats, second: Floats, share: Floats) -> Floats:
        return super().row_grid(first, second, share).astype(np.float16).astype(np.float64)


@WARP.add("warp-grids-exchanged")
class _GridsExchanged(Port):
    """Source and target of the warp are exchanged."""

    def warp(self, image: Floats, source: Floats, target: Floats) -> Floats:
        return super().warp(image, target, source)


@WARP.add("warp-mix-reversed")
class _MixReversed(Port):
    """The dissolve mixes (s, 1 - s)."""

    def mix(self, first: Floats, second: Floats, fraction: Floats) -> Floats:
        return super().mix(second, first, fraction)


@WARP.add("warp-farther-image")
class _Farther(Port):
    """The farther image is warped by policy "nearest"."""

    def second_is_nearer(self, fraction: Floats) -> Bools:
        return fraction < 0.5


@WARP.add("warp-rows-not-warped")
class _RowsNotWarped(Port):
    """The rows are mixed without a second warp."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return self.between(rows, [grid, grid], grid, shares[2])


@WARP.add("warp-rows-truncated", small=True, hidden=BELOW_A_BYTE)
class _RowsTruncated(Port):
    """Rows are truncated to bytes between the passes."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return super().finished([np.floor(row * 255.0) / 255.0 for row in rows], grids, grid, shares)


@WARP.add("warp-other-diagonal")
class _OtherDiagonal(Port):
    """Cells are cut along the other diagonal."""

    def halves(self, columns: int) -> list[Ints]:
        return [np.array([0, 1, columns]), np.array([1, columns + 1, columns])]


@WARP.add("warp-last-column-left-out")
class _LastColumn(Port):
    """The loop over the cells of a row ends one early."""

    def mesh(self, rows: int, columns: int) -> Ints:
        mesh = super().mesh(rows, columns).reshape(rows - 1, columns - 1, 2, 3)
        return mesh[:, :-1].reshape(-1, 3)


@WARP.add("warp-corners-aligned")
class _CornersAligned(Port):
    """Positions are scaled by S - 1."""

    def texels(self, points: Floats, size: int) -> Floats:
        return super().texels(points, size - 1)


class _Strict(Raster):
    def inside(self, edge: Ints, owned: Bools) -> Bools:
        return edge > 0


@WARP.add("warp-no-fill-rule", small=True)
class _Holes(Port):
    """Pixel centres on an edge belong to no triangle: holes along diagonals."""

    warp_raster = _Strict


class _NoHalf(Sampler):
    def position(self, u: Floats, size: int) -> Floats:
        return self.do.multiply(u, size)


@WARP.add("warp-half-a-texel")
class _HalfTexel(Port):
    """Fetches from texel u S, not u S - 0.5."""

    warp_sampler = _NoHalf


class _Nearest(Sampler):
    def bilinear(self, image: Floats, u: Floats, v: Floats) -> Floats:
        return self.nearest(image, u, v)


@WARP.add("warp-nearest-fetch")
class _NearestFetch(Port):
    """The nearest texel is fetched."""

    warp_sampler = _Nearest


class _Repeat(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.mod(index, size)


@WARP.add("warp-repeat", small=True)
class _Repeated(Port):
    """Fetches wrap around the map's border."""

    warp_sampler = _Repeat


class _OneLess(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.clip(index, 0, size - 2)


@WARP.add("warp-clamp-one-early", small=True)
class _ClampEarly(Port):
    """Fetches are clamped to S - 2."""

    warp_sampler = _OneLess


@WARP.add("warp-sample-sign", only=PLACED)
class _SampleSign(Port):
    """The object moves with the sample of the light, not against it."""

    def place_of_object(self, place: Floats) -> Floats:
        return self.do.add(self.offset, self.displacement(place))


@WARP.add("warp-world-xy", only=PLACED)
class _WorldXY(Port):
    """The sample's world x and y are taken for those on the axes."""

    def place_of_object(self, place: Floats) -> Floats:
        return self.do.subtract(self.offset, self.do.subtract(place, self.centre)[:2])


@WARP.add("warp-samples-transposed", only=MAPPED, hidden="the sum of the samples is the same")
class _SamplesTransposed(Port):
    """Samples of the light are taken with i outer and j inner."""

    def steps(self) -> list[tuple[float, float]]:
        return [(y, x) for x, y in super().steps()]


@WARP.add("warp-direct-from-centre", only=("direct",))
class _DirectFromCentre(Port):
    """Every sample's map is rendered from the light's centre."""

    def direct_map(self, place: Floats) -> Floats:
        return super().direct_map(self.centre)


class _Back(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return (held == 1.0) | (depth > held)


@WARP.add("warp-direct-back-faces", only=("direct",))
class _DirectBack(Port):
    """Maps that are rendered for each sample keep the caster's farthest depths."""

    direct_raster = _Back


@WARP.add("warp-direct-depth-truncated", only=("direct",), small=True)
class _DirectTruncated(Port):
    """Maps that are rendered for each sample hold depths truncated to bytes."""

    def direct_map(self, place: Floats) -> Floats:
        return np.floor(super().direct_map(place) * 255.0) / 255.0


@WARP.add("warp-t-upwards")
class _Upwards(Port):
    """The fractions of the rows are counted from below: 1 - t."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return super().finished(rows, grids, grid, [*shares[:2], self.do.subtract(1.0, shares[2])])


@WARP.add("warp-rows-exchanged")
class _RowsExchanged(Port):
    """The upper row is taken for the lower one in the last step."""

    def finished(self, rows: Vector, grids: Vector, grid: Floats, shares: Vector) -> Floats:
        return super().finished(rows[::-1], grids, grid, shares)


@WARP.add("warp-images-not-warped")
class _NotWarped(Port):
    """Images are mixed where they are: a cross dissolve."""

    def warp(self, image: Floats, source: Floats, target: Floats) -> Floats:
        return super().warp(image, source, source)


@WARP.add("warp-first-map-twice")
class _FirstTwice(Port):
    """The next map along x is the same one: i + 1 is left out."""

    def rows(self, maps: Vector, grids: Vector, between: Vector, shares: Vector) -> Vector:
        return super().rows([maps[0], maps[0], maps[2], maps[2]], grids, between, shares)


@WARP.add("warp-eased")
class _Eased(Port):
    """Fractions go through smoothstep()."""

    def fraction_in(self, at: Floats, line: Floats, cell: int) -> Floats:
        f = super().fraction_in(at, line, cell)
        return self.do.multiply(self.do.multiply(f, f), self.do.subtract(3.0, self.do.multiply(2.0, f)))


@WARP.add("warp-samples-not-moved", only=PLACED)
class _NotMoved(Port):
    """The map of the light's centre serves all samples."""

    def place_of_object(self, place: Floats) -> Floats:
        return 1.0 * self.offset


@WARP.add("warp-whole-texels")
class _WholeTexels(Port):
    """The meshes' corners are rounded to whole texels."""

    def texels(self, points: Floats, size: int) -> Floats:
        return np.rint(super().texels(points, size))


@WARP.add("warp-grid-of-the-upper-row")
class _UpperGrid(Port):
    """The result is drawn in the upper row's grid."""

    def final_grid(self, top: Floats, bottom: Floats, share: Floats) -> Floats:
        return 1.0 * top
