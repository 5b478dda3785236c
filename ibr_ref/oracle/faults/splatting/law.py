"""Bugs of the vertex stage: the width of splats."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.splatting.case import Floats, Image, Vector
from ibr_ref.oracle.programs.splatting.port import Port

LAW = Bugs("vertex", only=("square", "disc"))


@LAW.add("distance-not-squared")
class _DistanceNotSquared(Port):
    """β d for β d²."""

    def square(self, d: Floats) -> Floats:
        return d


@LAW.add("no-square-root")
class _NoSquareRoot(Port):
    """d² for d, everywhere in the law."""

    def length(self, vector: Vector) -> Floats:
        return self.do.dot(vector, vector)


@LAW.add("delta-times-distance")
class _DeltaTimesDistance(Port):
    """δ is multiplied by d, as γ is."""

    def denominator(self, d: Floats) -> Floats:
        beta, gamma, delta = self.law()
        return self.do.dot([beta, gamma, delta], [self.square(d), d, d])


@LAW.add("beta-for-gamma")
class _BetaForGamma(Port):
    """The law's β and γ are exchanged."""

    def denominator(self, d: Floats) -> Floats:
        beta, gamma, delta = self.law()
        return self.do.dot([gamma, beta, delta], [self.square(d), d, 1.0])


@LAW.add("distance-along-the-axis")
class _DistanceAlongTheAxis(Port):
    """d is the depth before the view camera, not the distance from its eye."""

    def distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return np.negative(view[2])


@LAW.add("distance-from-the-reference")
class _DistanceFromTheReference(Port):
    """d is the distance from the reference camera's eye."""

    def distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        eye = np.asarray(image.camera.eye)
        place = eye[:3] if eye[3] == 1.0 else image.camera.world_from_view[:3, 3]
        return self.length([self.do.subtract(x, e) for x, e in zip(world, self.do.number(place), strict=True)])


@LAW.add("distance-from-the-origin")
class _DistanceFromTheOrigin(Port):
    """d is the length of the world position: the eye is not subtracted."""

    def distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return self.length(world)


@LAW.add("length-in-view-space")
class _LengthInViewSpace(Port):
    """d is the length of the view position: not quite it where the rotation is measured, nor under an orthographic view."""

    def distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return self.length(view)


@LAW.add("no-upper-clamp")
class _NoUpperClamp(Port):
    """max_width is left out."""

    def clamp_width(self, width: Floats) -> Floats:
        return np.maximum(width, self.do.number(self.params.min_width))


@LAW.add("no-lower-clamp")
class _NoLowerClamp(Port):
    """min_width is left out."""

    def clamp_width(self, width: Floats) -> Floats:
        return np.minimum(width, self.do.number(self.params.max_width))


@LAW.add("alpha-too-large", small=True)
class _AlphaTooLarge(Port):
    """α is 0.2 % too large."""

    def width(self, d: Floats) -> Floats:
        return self.do.multiply(1.002, super().width(d))


@LAW.add("width-of-fixed-point", small=True)
class _WidthOfFixedPoint(Port):
    """The width is cut to a 64th of a pixel, as a fixed-point point size is."""

    def width(self, d: Floats) -> Floats:
        return np.floor(64.0 * super().width(d)) / 64.0


@LAW.add("beta-too-large", small=True)
class _BetaTooLarge(Port):
    """β is 1 % too large."""

    def denominator(self, d: Floats) -> Floats:
        return self.do.dot([super().denominator(d), 0.01 * self.params.beta], [1.0, self.square(d)])


@LAW.add("gamma-too-large", small=True)
class _GammaTooLarge(Port):
    """γ is 1 % too large."""

    def denominator(self, d: Floats) -> Floats:
        return self.do.dot([super().denominator(d), 0.01 * self.params.gamma], [1.0, d])


@LAW.add("delta-too-small", small=True)
class _DeltaTooSmall(Port):
    """δ is 0.5 % too small."""

    def denominator(self, d: Floats) -> Floats:
        return self.do.subtract(super().denominator(d), 0.005 * self.params.delta)


@LAW.add("distance-of-half-precision", small=True)
class _DistanceOfHalfPrecision(Port):
    """d is kept as a half float: mediump."""

    def distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return half(super().distance(image, world, view))


@LAW.add("fixed-function-attenuation")
class _FixedFunctionAttenuation(Port):
    """α times the root of 1/(β d² + γ d + δ), as GL_POINT_DISTANCE_ATTENUATION has it."""

    def width(self, d: Floats) -> Floats:
        root = self.do.root(self.do.divide(1.0, self.denominator(d)))
        return self.do.multiply(self.do.number(self.params.alpha), root)


@LAW.add("coefficients-backwards")
class _CoefficientsBackwards(Port):
    """β and δ are exchanged: constant, linear, quadratic, the order of GL's attenuation."""

    def law(self) -> list[Floats]:
        return super().law()[::-1]


@LAW.add("divided-by-distance")
class _DividedByDistance(Port):
    """The width is divided by d once more: gl_PointSize / gl_Position.w on top of the law."""

    def width(self, d: Floats) -> Floats:
        return self.do.divide(super().width(d), d)


@LAW.add("width-as-integer")
class _WidthAsInteger(Port):
    """The width is cast to an integer."""

    def clamp_width(self, width: Floats) -> Floats:
        return np.floor(super().clamp_width(width))


@LAW.add("width-for-the-other-resolution")
class _WidthForTheOtherResolution(Port):
    """The width is multiplied by a device pixel ratio of 2, the picture is not."""

    def clamp_width(self, width: Floats) -> Floats:
        return self.do.multiply(2.0, super().clamp_width(width))


@LAW.add("distance-from-the-near-plane")
class _DistanceFromTheNearPlane(Port):
    """d begins at the near plane."""

    def distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        return self.do.subtract(super().distance(image, world, view), self.do.number(self.scene.camera.near))


@LAW.add("law-of-eight-bits", small=True)
class _LawOfEightBits(Port):
    """β, γ and δ are fixed-point numbers of 8 fractional bits."""

    def law(self) -> list[Floats]:
        return [np.rint(256.0 * coefficient) / 256.0 for coefficient in super().law()]
