"""Bugs of the Gaussians of ellipses: what they are filtered with, and how much they weigh."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.splatting.case import Floats, Image, Vector
from ibr_ref.oracle.programs.splatting.port import Port

GAUSSIANS = Bugs("vertex", only=("ellipse",))


@GAUSSIANS.add("ellipse-no-low-pass")
class _NoLowPass(Port):
    """The filter of the picture's pixels is not added to the covariance: small splats fall between pixels."""

    def filtered(self, covariance: Vector) -> Vector:
        return covariance


@GAUSSIANS.add("ellipse-low-pass-0.3")
class _LowPassConstant(Port):
    """0.3 is added to the covariance, as 3D Gaussian splatting has it, in place of low_pass²."""

    def filtered(self, covariance: Vector) -> Vector:
        xx, xy, yy = covariance
        return [self.do.add(xx, 0.3), xy, self.do.add(yy, 0.3)]


@GAUSSIANS.add("ellipse-low-pass-not-squared")
class _LowPassNotSquared(Port):
    """low_pass, a deviation, is added to variances as it is."""

    def filtered(self, covariance: Vector) -> Vector:
        (xx, xy, yy), low_pass = covariance, self.do.number(self.params.low_pass)
        return [self.do.add(xx, low_pass), xy, self.do.add(yy, low_pass)]


@GAUSSIANS.add("ellipse-low-pass-in-every-entry")
class _LowPassEverywhere(Port):
    """low_pass² is added to all entries of the covariance, xy too, not to the diagonal alone."""

    def filtered(self, covariance: Vector) -> Vector:
        return [self.do.add(x, self.variances()[1]) for x in covariance]


@GAUSSIANS.add("ellipse-footprint-not-squared")
class _FootprintNotSquared(Port):
    """The covariance is footprint J Jᵀ: a deviation is taken for a variance."""

    def variances(self) -> tuple[Floats, Floats]:
        return self.do.number(self.params.footprint), super().variances()[1]


@GAUSSIANS.add("ellipse-amplitude-one", small=True)
class _AmplitudeOne(Port):
    """The weight at the centre is 1: what the filter widens is not made weaker."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        return np.ones(np.shape(area))


@GAUSSIANS.add("ellipse-amplitude-not-rooted", small=True)
class _AmplitudeNotRooted(Port):
    """The weight at the centre is the ratio of the determinants, without the square root."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        found = super().amplitude(area, squares)
        return self.do.multiply(found, found)


@GAUSSIANS.add("ellipse-amplitude-of-the-density")
class _AmplitudeOfDensity(Port):
    """The weight at the centre is 1/(2 π sqrt(det C)): a density, of which large splats have little."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        whole = self.do.divide(area, np.maximum(super().amplitude(area, squares), 1e-6))
        return self.do.divide(0.15915494, whole)


@GAUSSIANS.add("ellipse-size-not-bounded")
class _SizeNotBounded(Port):
    """Ellipses are not shrunk to max_width."""

    def shrink(self, covariance: Vector) -> Floats:
        return np.ones(np.shape(covariance[0]))


@GAUSSIANS.add("ellipse-variances-shrunk-like-sides")
class _ShrunkLikeSides(Port):
    """Where an ellipse is too large, its variances are multiplied by the ratio of the sides, not by its square."""

    def shrink(self, covariance: Vector) -> Floats:
        return self.do.root(super().shrink(covariance))


@GAUSSIANS.add("ellipse-covariance-half-floats", small=True)
class _CovarianceHalfFloats(Port):
    """The covariance is handed on in half floats, as packed Gaussians are."""

    def filtered(self, covariance: Vector) -> Vector:
        return [half(x) for x in super().filtered(covariance)]


@GAUSSIANS.add("ellipse-footprint-a-little-larger", small=True)
class _FootprintLarger(Port):
    """The footprint's variance is 0.3 % too large."""

    def variances(self) -> tuple[Floats, Floats]:
        footprint, low_pass = super().variances()
        return self.do.multiply(1.003, footprint), low_pass


@GAUSSIANS.add("ellipse-low-pass-a-percent-larger", small=True)
class _LowPassLarger(Port):
    """The filter's variance is 1 % too large."""

    def variances(self) -> tuple[Floats, Floats]:
        footprint, low_pass = super().variances()
        return footprint, self.do.multiply(1.01, low_pass)


@GAUSSIANS.add("ellipse-normal-of-a-colour", small=True)
class _NormalOfColour(Port):
    """The footprint's normal is decoded as 2 k/255 - 1, not (k - 128)/127."""

    def tangent_normal(self, codes: Vector) -> Vector:
        return self.do.unit([self.do.subtract(self.do.multiply(2.0, self.do.divide(k, 255.0)), 1.0) for k in codes])


@GAUSSIANS.add("ellipse-amplitude-half-floats", small=True)
class _AmplitudeHalfFloats(Port):
    """The weight at the centre is handed on as a half float."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        return half(super().amplitude(area, squares))


@GAUSSIANS.add("ellipse-amplitude-in-bytes", small=True)
class _AmplitudeInBytes(Port):
    """The weight at the centre is handed on as a byte: alpha of a colour of 8 bits."""

    def amplitude(self, area: Floats, squares: Vector) -> Floats:
        return np.floor(self.do.add(self.do.multiply(255.0, super().amplitude(area, squares)), 0.5)) / 255.0


@GAUSSIANS.add("ellipse-side-of-whole-pixels", small=True, hidden="the box is larger than what is drawn of it")
class _SideOfWholePixels(Port):
    """The box's side is rounded up to whole pixels, as radii are in 3D Gaussian splatting."""

    def larger_side(self, covariance: Vector) -> Floats:
        return np.ceil(super().larger_side(covariance))


@GAUSSIANS.add("ellipse-distance-of-half-precision", small=True)
class _DistanceOfHalfPrecision(Port):
    """The distance along the view axis is kept as a half float."""

    def axis_distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return half(super().axis_distance(image, world, view))


@GAUSSIANS.add("ellipse-distance-from-the-eye")
class _DistanceFromEye(Port):
    """The distance of the depth tolerance is that from the eye, not along the view axis."""

    def axis_distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return self.length(view)
