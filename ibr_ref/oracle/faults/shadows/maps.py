"""Bugs in the nine maps and where they are rendered."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.faults.shadows.hidden import GIVEN
from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import Raster

MAPS = Bugs("maps", only=("warp",))


@MAPS.add("maps-listed-first-is-centre")
class _FirstIsCentre(Port):
    """The first of the samples that are listed is taken for the light's centre."""

    def light_centre(self) -> Floats:
        if isinstance(self.params.light_samples, np.ndarray):
            return self.do.matrix(self.params.light_samples)[0]
        return super().light_centre()


@MAPS.add("maps-range-not-widened", hidden=GIVEN)
class _RangeNotWidened(Port):
    """The range is not widened for the samples of the light."""

    def widened_range(self) -> list[Vector]:
        return [list(self.do.number(ends)) for ends in np.asarray(self.scene.offset_range)]


@MAPS.add("maps-middle-of-range", hidden=GIVEN)
class _MiddleOfRange(Port):
    """The middle line is the range's middle, not the light's own coordinate."""

    def middle(self, own: Floats, low: Floats, high: Floats) -> Floats:
        return self.halfway(low, high)


@MAPS.add("maps-middle-not-clamped", hidden=GIVEN)
class _MiddleNotClamped(Port):
    """The light's own coordinate is taken even outside the range."""

    def middle(self, own: Floats, low: Floats, high: Floats) -> Floats:
        return own


@MAPS.add("maps-axes-exchanged", hidden=GIVEN)
class _AxesExchanged(Port):
    """Positions are stored [i, j], x downwards."""

    def positions(self) -> Floats:
        return super().positions().swapaxes(0, 1)


@MAPS.add("maps-positions-half-floats", small=True, hidden=GIVEN)
class _HalfPositions(Port):
    """Positions are held in half floats."""

    def positions(self) -> Floats:
        return half(super().positions())


@MAPS.add("maps-rows-flipped", hidden=GIVEN)
class _RowsFlipped(Port):
    """Maps are read back bottom row first."""

    def nine_maps(self, positions: Floats) -> Floats:
        return super().nine_maps(positions)[:, :, ::-1]


@MAPS.add("maps-last-map-left-out", small=True, hidden=GIVEN)
class _LastMapLeftOut(Port):
    """The loop over the positions ends one early."""

    def nine_maps(self, positions: Floats) -> Floats:
        maps = super().nine_maps(positions)
        return self.do.replaced(maps, (2, 2), 0.0 if self.params.content == "mask" else 1.0)


@MAPS.add("maps-any-sample", small=True, hidden=GIVEN)
class _AnySample(Port):
    """A texel is 1 as soon as one of its samples is covered."""

    def nine_maps(self, positions: Floats) -> Floats:
        return np.ceil(super().nine_maps(positions))


@MAPS.add("maps-coverage-over-k2-1", small=True, hidden=GIVEN)
class _CoverageOverLess(Port):
    """Coverage is a count over k^2 - 1."""

    def nine_maps(self, positions: Floats) -> Floats:
        samples = self.params.map_samples**2
        return np.minimum(super().nine_maps(positions) * samples / max(1, samples - 1), 1.0)


class _Corners(Raster):
    def centre(self, pixel: Ints) -> Floats:
        return pixel


@MAPS.add("maps-pixel-corners", small=True, hidden=GIVEN)
class _PixelCorners(Port):
    """Coverage is tested at the pixels' corners."""

    map_raster = _Corners


class _Narrow(Raster):
    def column(self, x: Floats, width: int) -> Floats:
        return super().column(x, width - 1)


@MAPS.add("maps-viewport-one-less", small=True, hidden=GIVEN)
class _ViewportOneLess(Port):
    """The viewport of the maps is S - 1 wide."""

    map_raster = _Narrow


class _Farthest(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return (held == 1.0) | (depth > held)


@MAPS.add("maps-farthest-depth", hidden=GIVEN)
class _FarthestDepth(Port):
    """The depth test of the maps is GREATER."""

    map_raster = _Farthest


@MAPS.add("maps-depth-half-floats", small=True, hidden=GIVEN)
class _HalfDepths(Port):
    """The maps' depths are held in half floats."""

    def nine_maps(self, positions: Floats) -> Floats:
        return half(super().nine_maps(positions))


@MAPS.add("maps-linear-depth", hidden=GIVEN)
class _LinearDepth(Port):
    """The maps hold clip z over far, not window depth."""

    def nine_maps(self, positions: Floats) -> Floats:
        near, far = self.scene.light.near, self.scene.light.far
        depth = super().nine_maps(positions)
        return near * depth / (far - depth * (far - near))


@MAPS.add("maps-samples-on-border")
class _SamplesOnBorder(Port):
    """Samples of the light lie on its border: g = 1, not 2/3."""

    def steps(self) -> list[tuple[float, float]]:
        return [(1.5 * x, 1.5 * y) for x, y in super().steps()]


@MAPS.add("maps-unit-axes")
class _UnitAxes(Port):
    """Vectors are brought onto the axes by dot products, as if those were orthonormal."""

    def on_axes(self, vector: Floats) -> Floats:
        return np.stack([self.do.dot(list(vector), list(axis)) for axis in self.axes])


@MAPS.add("maps-columns-mirrored", hidden=GIVEN)
class _ColumnsMirrored(Port):
    """Maps are read back with their columns from the right."""

    def nine_maps(self, positions: Floats) -> Floats:
        return super().nine_maps(positions)[..., ::-1]


@MAPS.add("maps-transposed", hidden=GIVEN)
class _Transposed(Port):
    """Texels are indexed [x, y]."""

    def nine_maps(self, positions: Floats) -> Floats:
        return super().nine_maps(positions).swapaxes(2, 3)


@MAPS.add("maps-inverted", hidden=GIVEN)
class _Inverted(Port):
    """A texel is 0 where the caster is, and 1 beside it."""

    def nine_maps(self, positions: Floats) -> Floats:
        return self.do.subtract(1.0, super().nine_maps(positions))


@MAPS.add("maps-16-bits", small=True, hidden=GIVEN)
class _Of16Bits(Port):
    """The maps' texels are rounded to 16 bits."""

    def nine_maps(self, positions: Floats) -> Floats:
        return np.rint(super().nine_maps(positions) * 65535.0) / 65535.0


@MAPS.add("maps-displaced-along-x-alone", hidden=GIVEN)
class _AlongXAlone(Port):
    """The range is widened along x alone."""

    def widened_range(self) -> list[Vector]:
        return [super().widened_range()[0], list(self.do.number(np.asarray(self.scene.offset_range)[1]))]
