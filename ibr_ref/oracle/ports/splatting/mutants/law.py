"""Bugs in stage 3: the width of splats."""
# An override does what its parent says, but for the fault in the class's docstring.
# ruff: noqa: D102

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.ports.splatting.mutants.seeded import mutant
from ibr_ref.oracle.ports.splatting.stage import Vector
from ibr_ref.oracle.ports.splatting.vertex import Vertex


class DistanceNotSquared(Vertex):
    """β d for β d²."""

    def square(self, d: Floats) -> Floats:
        return d


class NoSquareRoot(Vertex):
    """d² for d, everywhere in the law."""

    def length(self, vector: Vector) -> Floats:
        return self.alu.dot(vector, vector)


class DeltaTimesDistance(Vertex):
    """δ is multiplied by d, as γ is."""

    def denominator(self, d: Floats) -> Floats:
        beta, gamma, delta = (self.alu.number(getattr(self.params, name)) for name in ("beta", "gamma", "delta"))
        return self.alu.dot([beta, gamma, delta], [self.square(d), d, d])


class BetaForGamma(Vertex):
    """The law's β and γ are exchanged."""

    def denominator(self, d: Floats) -> Floats:
        beta, gamma, delta = (self.alu.number(getattr(self.params, name)) for name in ("beta", "gamma", "delta"))
        return self.alu.dot([gamma, beta, delta], [self.square(d), d, 1.0])


class DistanceAlongTheAxis(Vertex):
    """d is the depth before the view camera, not the distance from its eye."""

    def distance(self, image: Any, world: Vector, view: Vector) -> Floats:
        return -view[2]


class DistanceFromTheReference(Vertex):
    """d is the distance from the reference camera's eye."""

    def distance(self, image: Any, world: Vector, view: Vector) -> Floats:
        eye = np.asarray(image.camera.eye)
        place = eye[:3] if eye[3] == 1.0 else image.camera.world_from_view[:3, 3]
        return self.length([self.alu.subtract(x, e) for x, e in zip(world, self.alu.number(place), strict=True)])


class DistanceFromTheOrigin(Vertex):
    """d is the length of the world position: the eye is not subtracted."""

    def distance(self, image: Any, world: Vector, view: Vector) -> Floats:
        return self.length(world)


class LengthInViewSpace(Vertex):
    """d is the length of the view position: not quite it where the rotation is measured, nor under an orthographic view."""

    def distance(self, image: Any, world: Vector, view: Vector) -> Floats:
        return self.length(view)


class NoUpperClamp(Vertex):
    """max_width is left out."""

    def clamp_width(self, width: Floats) -> Floats:
        return np.maximum(width, self.alu.number(self.params.min_width))


class NoLowerClamp(Vertex):
    """min_width is left out."""

    def clamp_width(self, width: Floats) -> Floats:
        return np.minimum(width, self.alu.number(self.params.max_width))


class AlphaTooLarge(Vertex):
    """α is 0.2 % too large."""

    def width(self, d: Floats) -> Floats:
        return self.alu.multiply(1.002, super().width(d))


class BetaTooLarge(Vertex):
    """β is 1 % too large."""

    def denominator(self, d: Floats) -> Floats:
        return self.alu.dot([super().denominator(d), 0.01 * self.params.beta], [1.0, self.square(d)])


class GammaTooLarge(Vertex):
    """γ is 1 % too large."""

    def denominator(self, d: Floats) -> Floats:
        return self.alu.dot([super().denominator(d), 0.01 * self.params.gamma], [1.0, d])


class DeltaTooSmall(Vertex):
    """δ is 0.5 % too small."""

    def denominator(self, d: Floats) -> Floats:
        return self.alu.subtract(super().denominator(d), 0.005 * self.params.delta)


class DistanceOfHalfPrecision(Vertex):
    """d is kept as a half float: mediump."""

    def distance(self, image: Any, world: Vector, view: Vector) -> Floats:
        return super().distance(image, world, view).astype(np.float16).astype(np.float64)


MUTANTS = (
    mutant(DistanceNotSquared),
    mutant(NoSquareRoot),
    mutant(DeltaTimesDistance),
    mutant(BetaForGamma),
    mutant(DistanceAlongTheAxis),
    mutant(DistanceFromTheReference),
    mutant(DistanceFromTheOrigin),
    mutant(LengthInViewSpace),
    mutant(NoUpperClamp),
    mutant(NoLowerClamp),
    mutant(AlphaTooLarge, small=True),
    mutant(BetaTooLarge, small=True),
    mutant(GammaTooLarge, small=True),
    mutant(DeltaTooSmall, small=True),
    mutant(DistanceOfHalfPrecision, small=True),
)
