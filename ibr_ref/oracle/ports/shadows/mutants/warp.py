"""Bugs between the nine maps and the one for a place of the object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.ports.shadows.mutants.catalogue import BELOW_A_BYTE, Catalogue
from ibr_ref.oracle.ports.shadows.port import Port
from ibr_ref.oracle.ports.shadows.raster import Raster
from ibr_ref.oracle.ports.shadows.sampler import Sampler

fault = Catalogue("warp")

ANY_ORDER = "the sum of all samples is the same in any order"


@fault("listed-by-distance", "samples that are listed are taken from the light's centre outwards", hidden=ANY_ORDER)
class _ByDistance(Port):
    def sample_places(self) -> list[Floats]:
        places = super().sample_places()
        if not isinstance(self.params.light_samples, np.ndarray):
            return places
        return sorted(places, key=lambda place: float(np.sum((place - self.centre) ** 2)))


@fault("s-for-t", "the rows are mixed by s")
class _RowsMixedByS(Port):
    def finished(self, rows: list[Floats], grids: list[Floats], grid: Floats, shares: Floats) -> Floats:
        return self.between(rows, grids, grid, shares[0])


@fault("even-cells", "fractions are of half the range, though the middle line is not in its middle")
class _EvenCells(Port):
    def fraction_in(self, at: float, ends: Floats) -> Floats:
        line = next(line for line in self.lines() if set(ends) <= set(line))
        return self.ops.divide(self.ops.subtract(at, ends[0]), (line[2] - line[0]) / 2.0)


@fault("fraction-8-bits", "fractions are rounded to 1/256", small=True, hidden=BELOW_A_BYTE)
class _Fraction8(Port):
    def fraction_in(self, at: float, ends: Floats) -> Floats:
        return np.asarray(np.rint(super().fraction_in(at, ends) * 256.0) / 256.0, np.float64)


@fault("pace-even", "the fractions themselves are taken for the projective ones")
class _EvenPace(Port):
    def paced(self, fraction: Floats, w0: Floats, w1: Floats) -> Floats:
        return fraction


@fault("pace-reversed", "the projective fraction has the two depths exchanged")
class _PaceReversed(Port):
    def paced(self, fraction: Floats, w0: Floats, w1: Floats) -> Floats:
        return super().paced(fraction, w1, w0)


@fault("pace-of-the-upper-row", "the projective fraction of the upper row serves the lower one too")
class _PaceOfUpper(Port):
    def shares(self, cell: NDArray[np.int32], fraction: Floats) -> Floats:
        upper, _, between = super().shares(cell, fraction)
        return np.array([upper, upper, between])


@fault("cell-exchanged", "maps and grids of the cell are indexed [i, j]")
class _CellExchanged(Port):
    def corners(self, array: Floats, cell: NDArray[np.int32]) -> list[Floats]:
        return super().corners(array, cell[::-1])


@fault("always-first-cell", "the cell is found by truncation towards the first one")
class _FirstCell(Port):
    def upper(self, at: float, middle: float) -> int:
        return 0


@fault("grids-half-floats", "the grids of the rows are held in half floats", small=True, hidden=BELOW_A_BYTE)
class _HalfGrids(Port):
    def row_grid(self, first: Floats, second: Floats, share: Floats) -> Floats:
        return super().row_grid(first, second, share).astype(np.float16).astype(np.float64)


@fault("grids-exchanged", "source and target of the warp are exchanged")
class _GridsExchanged(Port):
    def warp(self, image: Floats, source: Floats, target: Floats) -> Floats:
        return super().warp(image, target, source)


@fault("mix-reversed", "the dissolve mixes (s, 1 - s)")
class _MixReversed(Port):
    def mix(self, first: Floats, second: Floats, fraction: Floats) -> Floats:
        return super().mix(second, first, fraction)


@fault("farther-image", 'the farther image is warped by policy "nearest"')
class _Farther(Port):
    def nearer(self, fraction: float) -> int:
        return 1 - super().nearer(fraction)


@fault("rows-not-warped", "the rows are mixed without a second warp")
class _RowsNotWarped(Port):
    def finished(self, rows: list[Floats], grids: list[Floats], grid: Floats, shares: Floats) -> Floats:
        return self.between(rows, [grid, grid], grid, shares[2])


@fault("rows-truncated", "rows are truncated to bytes between the passes", small=True, hidden=BELOW_A_BYTE)
class _RowsTruncated(Port):
    def finished(self, rows: list[Floats], grids: list[Floats], grid: Floats, shares: Floats) -> Floats:
        return super().finished([np.floor(row * 255.0) / 255.0 for row in rows], grids, grid, shares)


@fault("other-diagonal", "cells are cut along the other diagonal")
class _OtherDiagonal(Port):
    def halves(self, columns: int) -> list[Ints]:
        return [np.array([0, 1, columns]), np.array([1, columns + 1, columns])]


@fault("last-column-left-out", "the loop over the cells of a row ends one early")
class _LastColumn(Port):
    def mesh(self, rows: int, columns: int) -> Ints:
        mesh = super().mesh(rows, columns).reshape(rows - 1, columns - 1, 2, 3)
        return mesh[:, :-1].reshape(-1, 3)


@fault("corners-aligned", "positions are scaled by S - 1")
class _CornersAligned(Port):
    def texels(self, points: Floats, size: int) -> Floats:
        return super().texels(points, size - 1)


class _Strict(Raster):
    def inside(self, edge: Ints, owned: Bools) -> Bools:
        return np.asarray(edge > 0, np.bool_)


@fault("no-fill-rule", "pixel centres on an edge belong to no triangle: holes along diagonals", small=True)
class _Holes(Port):
    warp_raster = _Strict


class _NoHalf(Sampler):
    def position(self, u: Floats, size: int) -> Floats:
        return self.ops.multiply(u, size)


@fault("half-a-texel", "fetches from texel u S, not u S - 0.5")
class _HalfTexel(Port):
    warp_sampler = _NoHalf


class _Nearest(Sampler):
    def bilinear(self, image: Floats, u: Floats, v: Floats) -> Floats:
        return self.nearest(image, u, v)


@fault("nearest-fetch", "the nearest texel is fetched")
class _NearestFetch(Port):
    warp_sampler = _Nearest


class _Repeat(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.mod(index, size)


@fault("repeat", "fetches wrap around the map's border", small=True)
class _Repeated(Port):
    warp_sampler = _Repeat


class _OneLess(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.clip(index, 0, size - 2)


@fault("clamp-one-early", "fetches are clamped to S - 2", small=True)
class _ClampEarly(Port):
    warp_sampler = _OneLess


@fault("sample-sign", "the object moves with the sample of the light, not against it")
class _SampleSign(Port):
    def place_of_object(self, place: Floats) -> Floats:
        return self.ops.add(self.offset, self.displacement(place))


@fault("world-xy", "the sample's world x and y are taken for those on the axes")
class _WorldXY(Port):
    def place_of_object(self, place: Floats) -> Floats:
        return self.ops.subtract(self.offset, self.ops.subtract(place, self.centre)[:2])


@fault(
    "samples-transposed",
    "samples of the light are taken with i outer and j inner",
    hidden="the sum of the samples is the same",
)
class _SamplesTransposed(Port):
    def steps(self) -> list[tuple[float, float]]:
        return [(y, x) for x, y in super().steps()]


@fault("direct-from-centre", "\"direct\" renders every sample's map from the light's centre")
class _DirectFromCentre(Port):
    def direct_map(self, place: Floats) -> Floats:
        return super().direct_map(self.centre)


class _Back(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return np.asarray((held == 1.0) | (depth > held), np.bool_)


@fault("direct-back-faces", '"direct" keeps the caster\'s farthest depths')
class _DirectBack(Port):
    direct_raster = _Back


@fault("direct-depth-truncated", '"direct" holds depths truncated to bytes', small=True)
class _DirectTruncated(Port):
    def direct_map(self, place: Floats) -> Floats:
        return np.floor(super().direct_map(place) * 255.0) / 255.0
