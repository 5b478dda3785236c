"""Bugs of what ellipses cover, and of their weights there."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.splatting.case import Bools, Floats
from ibr_ref.oracle.programs.splatting.port import Port
from ibr_ref.oracle.programs.splatting.raster import Fragments, Splats

BLENDS = Bugs("raster", only=("ellipse",))


@BLENDS.add("ellipse-not-inverted")
class _NotInverted(Port):
    """q is dᵀ C d: the covariance is not inverted."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        do = self.do
        return do.dot([xx, do.multiply(2.0, xy), yy], [do.multiply(dx, dx), do.multiply(dx, dy), do.multiply(dy, dy)])


@BLENDS.add("ellipse-xy-not-negated")
class _XyNotNegated(Port):
    """The inverse's off-diagonal entry is +xy/det: the sign is lost, or the quad's y points the other way."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        return super().quadratic(dx, dy, xx, -xy, yy)


@BLENDS.add("ellipse-diagonal-not-exchanged")
class _NotExchanged(Port):
    """The inverse's diagonal is xx/det, yy/det: the entries are not exchanged."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        return super().quadratic(dx, dy, yy, xy, xx)


@BLENDS.add("ellipse-xy-once")
class _XyOnce(Port):
    """The off-diagonal entry counts once in q, not twice."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        do, determinant = self.do, self.determinant(xx, xy, yy)
        squares = [do.multiply(dx, dx), do.multiply(-1.0, do.multiply(dx, dy)), do.multiply(dy, dy)]
        return do.divide(do.dot([yy, xy, xx], squares), determinant)


@BLENDS.add("ellipse-without-xy")
class _WithoutXy(Port):
    """Ellipses lie along the window's axes: xy is left out of q."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        return super().quadratic(dx, dy, xx, 0.0 * xy, yy)


@BLENDS.add("ellipse-circumscribed-circle")
class _Circle(Port):
    """Splats are circles around the ellipses' boxes: one radius, of the larger deviation."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        most = np.maximum(xx, yy)
        return super().quadratic(dx, dy, most, 0.0 * xy, most)


@BLENDS.add("ellipse-determinant-plus-epsilon", small=True)
class _DeterminantPlusEpsilon(Port):
    """0.01 is added to the determinant against a division by zero."""

    def determinant(self, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        return self.do.add(super().determinant(xx, xy, yy), 0.01)


@BLENDS.add("ellipse-conic-half-floats", small=True)
class _ConicHalfFloats(Port):
    """The inverse of the covariance is handed on in half floats."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        do, determinant = self.do, self.determinant(xx, xy, yy)
        squares = [do.multiply(dx, dx), do.multiply(do.multiply(dx, dy), -2.0), do.multiply(dy, dy)]
        return do.dot([half(do.divide(x, determinant)) for x in (yy, xy, xx)], squares)


@BLENDS.add("ellipse-cutoff-a-little-larger", small=True)
class _CutoffLarger(Port):
    """Ellipses end 0.1 % too late."""

    def covers(self, q: Floats) -> Bools:
        return super().covers(self.do.multiply(0.998003, q))


@BLENDS.add("ellipse-cutoff-one")
class _CutoffOne(Port):
    """Ellipses end at one standard deviation: q ≤ 1 for q ≤ cutoff²."""

    def covers(self, q: Floats) -> Bools:
        return q <= 1.0


@BLENDS.add("ellipse-cutoff-not-squared")
class _CutoffNotSquared(Port):
    """q is compared with cutoff, not with its square."""

    def covers(self, q: Floats) -> Bools:
        return q <= self.do.number(self.params.cutoff)


@BLENDS.add("ellipse-box-not-cut")
class _BoxNotCut(Port):
    """The whole box is drawn: what lies outside of the ellipse is not discarded."""

    def covers(self, q: Floats) -> Bools:
        return q < np.inf


@BLENDS.add("ellipse-point-coordinate-not-doubled")
class _CoordinateNotDoubled(Port):
    """gl_PointCoord - 1/2 is taken for -1 to 1: distances are half of what they are, q a quarter."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        return self.do.multiply(0.25, super().quadratic(dx, dy, xx, xy, yy))


@BLENDS.add("ellipse-point-coordinate-doubled-again")
class _CoordinateDoubled(Port):
    """Distances are twice what they are, q four times: 2 gl_PointCoord - 1 is taken for one half of the box."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        return self.do.multiply(4.0, super().quadratic(dx, dy, xx, xy, yy))


@BLENDS.add("ellipse-from-the-corner")
class _FromTheCorner(Port):
    """d is measured from the pixels' upper left corners, not from their centres."""

    def squared_distance(self, splats: Splats, fragments: Fragments) -> Floats:
        return super().squared_distance(splats._replace(x=splats.x + 0.5, y=splats.y + 0.5), fragments)


@BLENDS.add("ellipse-exponent-without-half")
class _WithoutHalf(Port):
    """The weight is exp(-q) for exp(-q/2)."""

    def falloff(self, q: Floats) -> Floats:
        return self.do.exponential(self.do.multiply(q, -1.0))


@BLENDS.add("ellipse-exponent-of-the-radius")
class _OfTheRadius(Port):
    """The weight is exp(-r/2), r = sqrt(q): the radius is not squared."""

    def falloff(self, q: Floats) -> Floats:
        return super().falloff(self.do.root(q))


@BLENDS.add("ellipse-exponent-of-base-two", small=True)
class _BaseTwo(Port):
    """The weight is exp2(-0.72 q): log2 e / 2 is 0.72135."""

    def falloff(self, q: Floats) -> Floats:
        return self.do.exponential(self.do.multiply(q, -0.72 * float(np.log(2.0))))


@BLENDS.add("ellipse-exponential-by-squares", small=True)
class _BySquares(Port):
    """exp(-q/2) is (1 - q/512)^256, by eight squarings."""

    def falloff(self, q: Floats) -> Floats:
        return self.do.power(self.do.subtract(1.0, self.do.divide(q, 512.0)), 256)


@BLENDS.add("ellipse-exponential-of-half-precision", small=True)
class _ExponentialOfHalf(Port):
    """exp(-q/2) is computed in half floats: mediump."""

    def falloff(self, q: Floats) -> Floats:
        return half(self.do.exponential(half(self.do.multiply(q, -0.5))))


@BLENDS.add("ellipse-weights-flat")
class _Flat(Port):
    """No Gaussian: every pixel of an ellipse has the weight of its centre."""

    def falloff(self, q: Floats) -> Floats:
        return 0.0 * q + 1.0


@BLENDS.add("ellipse-falls-off-linearly")
class _Linear(Port):
    """The weight falls off linearly, to 0 at the cutoff."""

    def falloff(self, q: Floats) -> Floats:
        return self.do.subtract(1.0, self.do.divide(self.do.root(q), self.do.number(self.params.cutoff)))


@BLENDS.add("ellipse-amplitude-left-out", small=True)
class _AmplitudeLeftOut(Port):
    """The weight is exp(-q/2) alone: the weight at the centre is left out."""

    def contribution(self, amplitude: Floats, q: Floats) -> Floats:
        return self.falloff(q)


@BLENDS.add("ellipse-weights-in-bytes", small=True)
class _WeightsInBytes(Port):
    """Weights are written in bytes: alpha of a target of 8 bits."""

    def contribution(self, amplitude: Floats, q: Floats) -> Floats:
        return np.floor(self.do.add(self.do.multiply(255.0, super().contribution(amplitude, q)), 0.5)) / 255.0


@BLENDS.add("ellipse-weights-in-half-floats", small=True)
class _WeightsInHalfFloats(Port):
    """Weights are half floats before they are added."""

    def contribution(self, amplitude: Floats, q: Floats) -> Floats:
        return half(super().contribution(amplitude, q))


@BLENDS.add("ellipse-faint-ones-left-out")
class _FaintLeftOut(Port):
    """Contributions below 1/8 are left out of the sums, as below 1/255 in 3D Gaussian splatting."""

    def contribution(self, amplitude: Floats, q: Floats) -> Floats:
        found = super().contribution(amplitude, q)
        return np.where(found < 0.125, 0.0, found)
