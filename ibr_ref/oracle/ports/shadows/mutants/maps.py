"""Bugs in the nine maps and where they are rendered."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.ports.shadows.mutants.catalogue import Catalogue
from ibr_ref.oracle.ports.shadows.port import Port
from ibr_ref.oracle.ports.shadows.raster import Raster

fault = Catalogue("maps")


@fault("listed-first-is-centre", "the first of the samples that are listed is taken for the light's centre")
class _FirstIsCentre(Port):
    def sample_places(self) -> list[Floats]:
        places = super().sample_places()
        if isinstance(self.params.light_samples, np.ndarray):
            self.centre = places[0]
        return places


GIVEN = "the picture is made of the maps that the case hands over"


@fault("range-not-widened", "the range is not widened for the samples of the light", hidden=GIVEN)
class _RangeNotWidened(Port):
    def widened_range(self) -> Floats:
        return self.ops.number(self.scene.offset_range)


@fault("middle-of-range", "the middle line is the range's middle, not the light's own coordinate", hidden=GIVEN)
class _MiddleOfRange(Port):
    def middle(self, own: float, low: float, high: float) -> float:
        return float(self.ops.multiply(self.ops.add(low, high), 0.5))


@fault("middle-not-clamped", "the light's own coordinate is taken even outside the range", hidden=GIVEN)
class _MiddleNotClamped(Port):
    def middle(self, own: float, low: float, high: float) -> float:
        return own


@fault("axes-exchanged", "positions are stored [i, j], x downwards", hidden=GIVEN)
class _AxesExchanged(Port):
    def positions(self) -> Floats:
        positions: Floats = super().positions()
        return positions.swapaxes(0, 1)


@fault("positions-half-floats", "positions are held in half floats", small=True, hidden=GIVEN)
class _HalfPositions(Port):
    def positions(self) -> Floats:
        return super().positions().astype(np.float16).astype(np.float64)


@fault("rows-flipped", "maps are read back bottom row first", hidden=GIVEN)
class _RowsFlipped(Port):
    def nine_maps(self, positions: Floats) -> Floats:
        return np.asarray(super().nine_maps(positions)[:, :, ::-1])


@fault("last-map-left-out", "the loop over the positions ends one early", small=True, hidden=GIVEN)
class _LastMapLeftOut(Port):
    def nine_maps(self, positions: Floats) -> Floats:
        maps = super().nine_maps(positions)
        maps[2, 2] = 0.0 if self.params.content == "mask" else 1.0
        return maps


@fault("any-sample", "a texel is 1 as soon as one of its samples is covered", small=True, hidden=GIVEN)
class _AnySample(Port):
    def nine_maps(self, positions: Floats) -> Floats:
        return np.ceil(super().nine_maps(positions))


@fault("coverage-over-k2-1", "coverage is a count over k^2 - 1", small=True, hidden=GIVEN)
class _CoverageOverLess(Port):
    def nine_maps(self, positions: Floats) -> Floats:
        samples = self.params.map_samples**2
        return np.asarray(np.minimum(super().nine_maps(positions) * samples / max(1, samples - 1), 1.0))


class _Corners(Raster):
    def centre(self, pixel: Ints) -> Floats:
        return np.asarray(pixel, np.float64)


@fault("pixel-corners", "coverage is tested at the pixels' corners", small=True, hidden=GIVEN)
class _PixelCorners(Port):
    map_raster = _Corners


class _Narrow(Raster):
    def column(self, x: Floats, width: int) -> Floats:
        return super().column(x, width - 1)


@fault("viewport-one-less", "the viewport of the maps is S - 1 wide", small=True, hidden=GIVEN)
class _ViewportOneLess(Port):
    map_raster = _Narrow


class _Farthest(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return np.asarray((held == 1.0) | (depth > held), np.bool_)


@fault("farthest-depth", "the depth test of the maps is GREATER", hidden=GIVEN)
class _FarthestDepth(Port):
    map_raster = _Farthest


@fault("depth-half-floats", "the maps' depths are held in half floats", small=True, hidden=GIVEN)
class _HalfDepths(Port):
    def nine_maps(self, positions: Floats) -> Floats:
        return super().nine_maps(positions).astype(np.float16).astype(np.float64)


@fault("linear-depth", "the maps hold clip z over far, not window depth", hidden=GIVEN)
class _LinearDepth(Port):
    def nine_maps(self, positions: Floats) -> Floats:
        near, far = self.scene.light.near, self.scene.light.far
        depth = super().nine_maps(positions)
        return np.asarray(near * depth / (far - depth * (far - near)))


@fault("samples-on-border", "samples of the light lie on its border: g = 1, not 2/3")
class _SamplesOnBorder(Port):
    def steps(self) -> list[tuple[float, float]]:
        if self.params.method == "direct":  # which has no maps stage: there the same bug is one of the warp
            return super().steps()
        return [(1.5 * x, 1.5 * y) for x, y in super().steps()]


@fault("unit-axes", "vectors are brought onto the axes by dot products, as if those were orthonormal")
class _UnitAxes(Port):
    def on_axes(self, vector: Floats) -> Floats:
        return np.stack([self.ops.dot(list(vector), list(axis)) for axis in self.axes])
