"""Bugs of the second pass of ellipses: what is added up, and divided."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Ints
from ibr_ref.oracle.programs.splatting.port import Port

SUMS = Bugs("raster", only=("ellipse",))
AVERAGES = Bugs("resolve", only=("ellipse",))


@SUMS.add("ellipse-all-averaged")
class _AllAveraged(Port):
    """All splats of a pixel are averaged, those of the surfaces behind too: the second pass has no depth test."""

    def blends(self, distance: Floats, nearest: Floats) -> Bools:
        return distance >= 0.0


@SUMS.add("ellipse-nearest-alone")
class _NearestAlone(Port):
    """Only what is as near as the nearest is added: the second pass has the depth test of the first, without a tolerance."""

    def reach(self) -> Floats:
        return self.do.number(1.0)


@SUMS.add("ellipse-tolerance-in-world-units")
class _ToleranceInUnits(Port):
    """The depth tolerance is taken for world units, not for a share of the distance."""

    def blends(self, distance: Floats, nearest: Floats) -> Bools:
        return distance <= self.do.add(nearest, self.do.number(self.params.depth_tolerance))


@SUMS.add("ellipse-weights-saturated")
class _Saturated(Port):
    """The sum of the weights saturates at 1: it is alpha of a target of fixed point, and what is divided by it too large."""

    def summed(self, weight: Floats, of: Ints, count: int) -> Floats:
        return np.minimum(super().summed(weight, of, count), 1.0)

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        color = self.do.totals(self.do.multiply(weight, channel), of, count)
        return np.minimum(self.do.divide(color, self.summed(weight, of, count)), 1.0)


@AVERAGES.add("ellipse-not-divided")
class _NotDivided(Port):
    """The sum of the weighted colours is shown: it is not divided by that of the weights."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        return np.minimum(self.do.totals(self.do.multiply(weight, channel), of, count), 1.0)


@AVERAGES.add("ellipse-divided-by-their-number")
class _DividedByNumber(Port):
    """The sum of the weighted colours is divided by how many splats it is of."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        color = self.do.totals(self.do.multiply(weight, channel), of, count)
        return np.minimum(self.do.divide(color, np.maximum(np.bincount(of, minlength=count), 1.0)), 1.0)


@AVERAGES.add("ellipse-colours-not-weighted")
class _NotWeighted(Port):
    """The plain mean of the colours: all splats of a pixel count alike."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        return super().averaged(0.0 * weight + 1.0, channel, of, count)


@AVERAGES.add("ellipse-colour-sums-saturated")
class _ColourSumsSaturated(Port):
    """Sums of weighted colours saturate at 1: they are held in a target of fixed point."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        color = np.minimum(self.do.totals(self.do.multiply(weight, channel), of, count), 1.0)
        return np.minimum(self.do.divide(color, self.do.totals(weight, of, count)), 1.0)


@AVERAGES.add("ellipse-divided-with-epsilon", small=True)
class _WithEpsilon(Port):
    """0.0005 is added to the sum of the weights against a division by zero."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        color = self.do.totals(self.do.multiply(weight, channel), of, count)
        return np.minimum(self.do.divide(color, self.do.add(self.do.totals(weight, of, count), 0.0005)), 1.0)


@AVERAGES.add("ellipse-colours-in-bytes", small=True)
class _ColoursInBytes(Port):
    """The colours of the splats are bytes before they are averaged."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        rounded = np.floor(self.do.add(self.do.multiply(255.0, channel), 0.5)) / 255.0
        return super().averaged(weight, rounded, of, count)


@AVERAGES.add("ellipse-average-in-half-floats", small=True)
class _AverageInHalfFloats(Port):
    """Averages are kept in half floats."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        return half(super().averaged(weight, channel, of, count))


@AVERAGES.add("ellipse-squared-weights")
class _SquaredWeights(Port):
    """Colours are weighted with w²: they are multiplied by the weight in the shader, and by alpha once more in blending."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        color = self.do.totals(self.do.multiply(self.do.multiply(weight, weight), channel), of, count)
        return np.minimum(self.do.divide(color, self.do.totals(weight, of, count)), 1.0)
