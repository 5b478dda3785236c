"""Bugs of elliptical weighted averages, as people make them in shaders of Gaussian splats."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Image, Ints, Vector
from ibr_ref.oracle.programs.splatting.port import Port
from ibr_ref.oracle.programs.splatting.raster import Fragments, Splats

ONLY = ("ellipse",)
FOOTPRINTS = Bugs("vertex", only=ONLY)
BLENDS = Bugs("raster", only=ONLY)
AVERAGES = Bugs("resolve", only=ONLY)


def _half(x: Floats) -> Floats:
    return x.astype(np.float16).astype(np.float64)


# --- The Jacobian ----------------------------------------------------------------------------------------------------


@FOOTPRINTS.add("ellipse-without-the-divide's-terms")
class _WithoutDivide(Port):
    """The Jacobian lacks the terms of the perspective divide, -x/w² and -y/w²: only 1/w is left of it."""

    def projected_step(self, x: Floats, ndc: Floats, along: Floats) -> Floats:
        return x


@FOOTPRINTS.add("ellipse-y-upwards")
class _YUpwards(Port):
    """The Jacobian's y points upwards, as in clip space, while the window's points down: ellipses are mirrored."""

    def window_step(self, step: Vector, ndc: Vector, w: Floats) -> Vector:
        x, y = super().window_step(step, ndc, w)
        return [x, np.negative(y)]


@FOOTPRINTS.add("ellipse-jacobian-transposed")
class _Transposed(Port):
    """The covariance is Jᵀ J for J Jᵀ: rows are taken for columns."""

    def squares(self, x_u: Floats, y_u: Floats, x_v: Floats, y_v: Floats) -> Vector:
        return super().squares(x_u, x_v, y_u, y_v)


@FOOTPRINTS.add("ellipse-whole-viewport")
class _WholeViewport(Port):
    """The Jacobian is multiplied by the viewport's size, not by its half: NDC runs from -1 to 1."""

    def window_step(self, step: Vector, ndc: Vector, w: Floats) -> Vector:
        return [self.do.multiply(2.0, x) for x in super().window_step(step, ndc, w)]


@FOOTPRINTS.add("ellipse-width-for-height")
class _WidthForHeight(Port):
    """The Jacobian's y is multiplied by half the viewport's width: the aspect ratio is forgotten."""

    def window_step(self, step: Vector, ndc: Vector, w: Floats) -> Vector:
        x, y = super().window_step(step, ndc, w)
        return [x, self.do.multiply(self.scene.camera.width / self.scene.camera.height, y)]


@FOOTPRINTS.add("ellipse-normal-away")
class _NormalAway(Port):
    """The footprint's normal has the wrong sign: it points away from the reference camera."""

    def tangent_normal(self, codes: Vector) -> Vector:
        return [np.negative(x) for x in super().tangent_normal(codes)]


@FOOTPRINTS.add("ellipse-faces-the-reference")
class _FacesReference(Port):
    """The normal is left out: splats face the reference camera, J is that of steps at a constant depth."""

    def along_plane(self, step: Vector, sight: Vector, normal: Vector, facing: Floats) -> Vector:
        return step


@FOOTPRINTS.add("ellipse-cosine-not-bounded")
class _CosineNotBounded(Port):
    """The cosine of normal and line of sight is not kept from 0: splats that are seen from their edge become spikes."""

    def facing(self, normal: Vector, sight: Vector) -> Floats:
        return self.do.dot(normal, sight)


@FOOTPRINTS.add("ellipse-bound-without-the-length", small=True)
class _BoundWithoutLength(Port):
    """n·d is kept below -1/2, not below -|d|/2: d, at depth 1, is longer than 1 beside the middle."""

    def facing(self, normal: Vector, sight: Vector) -> Floats:
        return np.minimum(self.do.dot(normal, sight), -self.least_cosine())


@FOOTPRINTS.add("ellipse-sight-along-the-axis")
class _SightAlongAxis(Port):
    """The line of sight is the reference camera's axis for every pixel."""

    def sight(self, camera: Any, x_n: Floats, y_n: Floats, one: Floats) -> Vector:
        return [0.0 * one, 0.0 * one, -one]


@FOOTPRINTS.add("ellipse-steps-not-scaled")
class _StepsNotScaled(Port):
    """A reference pixel is as wide at every depth: the step 1/f is not multiplied by the depth."""

    def step_scale(self, camera: Any, depth: Floats) -> Floats:
        return np.ones(np.shape(depth))


@FOOTPRINTS.add("ellipse-steps-not-turned")
class _StepsNotTurned(Port):
    """Steps and line of sight stay in the reference camera's space, while the normal is in world space."""

    def turned(self, camera: Any, step: Vector) -> Vector:
        return step


@FOOTPRINTS.add("ellipse-skew-left-out")
class _SkewLeftOut(Port):
    """The step to the pixel below does not follow the intrinsics' skew."""

    def pixel_steps(self, camera: Any, depth: Floats) -> list[Vector]:
        across, (_, down, flat) = super().pixel_steps(camera, depth)
        return [across, [0.0, down, flat]]


@FOOTPRINTS.add("ellipse-jacobian-half-floats", small=True)
class _JacobianHalfFloats(Port):
    """The Jacobian is kept in half floats: mediump."""

    def jacobian(self, image: Image, texels: Any, view: Vector, clip: Vector) -> Vector:
        return [_half(x) for x in super().jacobian(image, texels, view, clip)]


# --- The Gaussian ----------------------------------------------------------------------------------------------------


@FOOTPRINTS.add("ellipse-no-low-pass")
class _NoLowPass(Port):
    """The filter of the picture's pixels is not added to the covariance: small splats fall between pixels."""

    def filtered(self, covariance: Vector) -> Vector:
        return covariance


@FOOTPRINTS.add("ellipse-low-pass-0.3")
class _LowPassConstant(Port):
    """0.3 is added to the covariance, as 3D Gaussian splatting has it, in place of low_pass²."""

    def filtered(self, covariance: Vector) -> Vector:
        xx, xy, yy = covariance
        return [self.do.add(xx, 0.3), xy, self.do.add(yy, 0.3)]


@FOOTPRINTS.add("ellipse-low-pass-not-squared")
class _LowPassNotSquared(Port):
    """low_pass, a deviation, is added to variances as it is."""

    def filtered(self, covariance: Vector) -> Vector:
        (xx, xy, yy), low_pass = covariance, self.do.number(self.params.low_pass)
        return [self.do.add(xx, low_pass), xy, self.do.add(yy, low_pass)]


@FOOTPRINTS.add("ellipse-low-pass-in-every-entry")
class _LowPassEverywhere(Port):
    """low_pass² is added to all entries of the covariance, xy too, not to the diagonal alone."""

    def filtered(self, covariance: Vector) -> Vector:
        return [self.do.add(x, self.variances()[1]) for x in covariance]


@FOOTPRINTS.add("ellipse-footprint-not-squared")
class _FootprintNotSquared(Port):
    """The covariance is footprint J Jᵀ: a deviation is taken for a variance."""

    def variances(self) -> tuple[Floats, Floats]:
        return self.do.number(self.params.footprint), super().variances()[1]


@FOOTPRINTS.add("ellipse-amplitude-one", small=True)
class _AmplitudeOne(Port):
    """The weight at the centre is 1: what the filter widens is not made weaker."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        return np.ones(np.shape(area))


@FOOTPRINTS.add("ellipse-amplitude-not-rooted", small=True)
class _AmplitudeNotRooted(Port):
    """The weight at the centre is the ratio of the determinants, without the square root."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        found = super().amplitude(area, squares)
        return self.do.multiply(found, found)


@FOOTPRINTS.add("ellipse-amplitude-of-the-density")
class _AmplitudeOfDensity(Port):
    """The weight at the centre is 1/(2 π sqrt(det C)): a density, of which large splats have little."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        whole = self.do.divide(area, np.maximum(super().amplitude(area, squares), 1e-6))
        return self.do.divide(0.15915494, whole)


@FOOTPRINTS.add("ellipse-size-not-bounded")
class _SizeNotBounded(Port):
    """Ellipses are not shrunk to max_width."""

    def shrink(self, covariance: Vector) -> Floats:
        return np.ones(np.shape(covariance[0]))


@FOOTPRINTS.add("ellipse-variances-shrunk-like-sides")
class _ShrunkLikeSides(Port):
    """Where an ellipse is too large, its variances are multiplied by the ratio of the sides, not by its square."""

    def shrink(self, covariance: Vector) -> Floats:
        return self.do.root(super().shrink(covariance))


@FOOTPRINTS.add("ellipse-covariance-half-floats", small=True)
class _CovarianceHalfFloats(Port):
    """The covariance is handed on in half floats, as packed Gaussians are."""

    def filtered(self, covariance: Vector) -> Vector:
        return [_half(x) for x in super().filtered(covariance)]


@FOOTPRINTS.add("ellipse-footprint-a-little-larger", small=True)
class _FootprintLarger(Port):
    """The footprint's variance is 0.3 % too large."""

    def variances(self) -> tuple[Floats, Floats]:
        footprint, low_pass = super().variances()
        return self.do.multiply(1.003, footprint), low_pass


@FOOTPRINTS.add("ellipse-low-pass-a-percent-larger", small=True)
class _LowPassLarger(Port):
    """The filter's variance is 1 % too large."""

    def variances(self) -> tuple[Floats, Floats]:
        footprint, low_pass = super().variances()
        return footprint, self.do.multiply(1.01, low_pass)


@FOOTPRINTS.add("ellipse-normal-of-a-colour", small=True)
class _NormalOfColour(Port):
    """The footprint's normal is decoded as 2 k/255 - 1, not (k - 128)/127."""

    def tangent_normal(self, codes: Vector) -> Vector:
        return self.do.unit([self.do.subtract(self.do.multiply(2.0, self.do.divide(k, 255.0)), 1.0) for k in codes])


@FOOTPRINTS.add("ellipse-amplitude-half-floats", small=True)
class _AmplitudeHalfFloats(Port):
    """The weight at the centre is handed on as a half float."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        return _half(super().amplitude(area, squares))


@FOOTPRINTS.add("ellipse-amplitude-in-bytes", small=True)
class _AmplitudeInBytes(Port):
    """The weight at the centre is handed on as a byte: alpha of a colour of 8 bits."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        return np.floor(self.do.add(self.do.multiply(255.0, super().amplitude(area, squares)), 0.5)) / 255.0


@FOOTPRINTS.add("ellipse-side-of-whole-pixels", small=True, hidden="the box is larger than what is drawn of it")
class _SideOfWholePixels(Port):
    """The box's side is rounded up to whole pixels, as radii are in 3D Gaussian splatting."""

    def larger_side(self, covariance: Vector) -> Floats:
        return np.ceil(super().larger_side(covariance))


@FOOTPRINTS.add("ellipse-distance-of-half-precision", small=True)
class _DistanceOfHalfPrecision(Port):
    """The distance along the view axis is kept as a half float."""

    def axis_distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return _half(super().axis_distance(image, world, view))


@FOOTPRINTS.add("ellipse-distance-from-the-eye")
class _DistanceFromEye(Port):
    """The distance of the depth tolerance is that from the eye, not along the view axis."""

    def axis_distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return self.length(view)


# --- Coverage and weights --------------------------------------------------------------------------------------------


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
        return do.dot([_half(do.divide(x, determinant)) for x in (yy, xy, xx)], squares)


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
        return _half(self.do.exponential(_half(self.do.multiply(q, -0.5))))


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
        return _half(super().contribution(amplitude, q))


@BLENDS.add("ellipse-faint-ones-left-out")
class _FaintLeftOut(Port):
    """Contributions below 1/8 are left out of the sums, as below 1/255 in 3D Gaussian splatting."""

    def contribution(self, amplitude: Floats, q: Floats) -> Floats:
        found = super().contribution(amplitude, q)
        return np.where(found < 0.125, 0.0, found)


# --- The second pass -------------------------------------------------------------------------------------------------


@BLENDS.add("ellipse-all-averaged")
class _AllAveraged(Port):
    """All splats of a pixel are averaged, those of the surfaces behind too: the second pass has no depth test."""

    def blends(self, distance: Floats, nearest: Floats) -> Bools:
        return distance >= 0.0


@BLENDS.add("ellipse-nearest-alone")
class _NearestAlone(Port):
    """Only what is as near as the nearest is added: the second pass has the depth test of the first, without a tolerance."""

    def reach(self) -> Floats:
        return self.do.number(1.0)


@BLENDS.add("ellipse-tolerance-in-world-units")
class _ToleranceInUnits(Port):
    """The depth tolerance is taken for world units, not for a share of the distance."""

    def blends(self, distance: Floats, nearest: Floats) -> Bools:
        return distance <= self.do.add(nearest, self.do.number(self.params.depth_tolerance))


@BLENDS.add("ellipse-weights-saturated")
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
        return _half(super().averaged(weight, channel, of, count))


@AVERAGES.add("ellipse-squared-weights")
class _SquaredWeights(Port):
    """Colours are weighted with w²: they are multiplied by the weight in the shader, and by alpha once more in blending."""

    def averaged(self, weight: Floats, channel: Floats, of: Ints, count: int) -> Floats:
        color = self.do.totals(self.do.multiply(self.do.multiply(weight, weight), channel), of, count)
        return np.minimum(self.do.divide(color, self.do.totals(weight, of, count)), 1.0)
