"""Bugs in stage 3: the light."""
# An override does what its parent says, but for the fault in the class's docstring.
# ruff: noqa: D102

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Floats
from ibr_ref.oracle.ports.splatting.atlas import Integers
from ibr_ref.oracle.ports.splatting.mutants.seeded import mutant
from ibr_ref.oracle.ports.splatting.stage import Vector
from ibr_ref.oracle.ports.splatting.vertex import Vertex


class SignedNormalizedFetch(Vertex):
    """Normals are decoded as 2 k/255 − 1."""

    def decode(self, code: Floats) -> Floats:
        return self.alu.subtract(self.alu.multiply(2.0, self.alu.divide(code, 255.0)), 1.0)


class NormalsNotRenormalized(Vertex):
    """Decoded normals are used as they are, not at unit length."""

    def normal(self, codes: Floats) -> list[Floats]:
        return [self.decode(codes[:, axis]) for axis in range(3)]


class NormalOfTheNextPixel(Vertex):
    """Normals are fetched one column to the right."""

    def fetch_normals(self, codes: NDArray[np.uint8], rows: Integers, columns: Integers) -> NDArray[np.uint8]:
        return super().fetch_normals(codes, rows, np.minimum(columns + 1, codes.shape[1] - 1))


class LightNotNormalized(Vertex):
    """The vector to the lamp is not normalized."""

    def towards_light(self, world: Vector) -> list[Floats]:
        *place, w = self.alu.number(self.scene.light.homogeneous)
        return [self.alu.subtract(value, w * x) for value, x in zip(place, world, strict=True)]


class LightFromBehind(Vertex):
    """The direction is taken from the light, not towards it."""

    def towards_light(self, world: Vector) -> list[Floats]:
        return [-x for x in super().towards_light(world)]


class LampInViewSpace(Vertex):
    """The light's place is transformed into view space, the points are not."""

    def towards_light(self, world: Vector) -> list[Floats]:
        moved = self.scene.camera.view_from_world @ self.scene.light.homogeneous
        return self.towards(moved, world)


class TwoSidedLight(Vertex):
    """|n·l| for max(0, n·l)."""

    def lambert(self, facing: Floats) -> Floats:
        return np.abs(facing)


class AmbientOnePercentMore(Vertex):
    """The ambient light is 1 % too bright."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (1.01 if name == "ambient" else 1.0)


class AmbientOfBytes(Vertex):
    """The ambient light is held as a byte."""

    def coefficient(self, name: str) -> Floats:
        value = super().coefficient(name)
        return np.rint(255.0 * value) / 255.0 if name == "ambient" else value


class DiffuseHalfPercentLess(Vertex):
    """The diffuse light is half a percent too dark."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (0.995 if name == "diffuse" else 1.0)


class SpecularOnePercentMore(Vertex):
    """The highlight is 1 % too bright."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (1.01 if name == "specular" else 1.0)


class ReflectedTheOtherWay(Vertex):
    """R = l − 2 (n·l) n: the sign of reflect() with l for the incoming ray."""

    def reflected(self, normal: Vector, light: Vector, facing: Floats) -> list[Floats]:
        return [-x for x in super().reflected(normal, light, facing)]


class HalfVector(Vertex):
    """Blinn's (n·h)^e for Phong's (r·v)^e."""

    def mirrored(self, normal: Vector, light: Vector, view: Vector, facing: Floats) -> Floats:
        half = self.alu.unit([self.alu.add(l, v) for l, v in zip(light, view, strict=True)])
        return self.alu.dot(normal, half)


class ExponentOneLess(Vertex):
    """The highlight's exponent is off by one."""

    def exponent(self) -> int:
        return max(0, super().exponent() - 1)


class HighlightInTheShade(Vertex):
    """The highlight is not bound to n·l > 0."""

    def lights_up(self, facing: Floats) -> Floats:
        return np.ones_like(facing)


class ColoredHighlight(Vertex):
    """The highlight has the colour of the surface."""

    def shaded(self, albedo: Vector, received: Floats, shine: Floats) -> list[Floats]:
        return [self.alu.multiply(channel, self.alu.add(received, shine)) for channel in albedo]


class HighlightForTheReference(Vertex):
    """v points to the reference camera's eye: the highlight does not move with the view."""

    def eye(self, image: Any) -> ArrayLike:
        eye: ArrayLike = image.camera.eye
        return eye


class ViewerAtInfinity(Vertex):
    """v is the view axis for all points, as in GL without its local viewer."""

    def eye(self, image: Any) -> ArrayLike:
        axis = self.scene.camera.world_from_view[:3, 2]
        return np.append(axis / np.sqrt(axis @ axis), 0.0)


class NoClamp(Vertex):
    """Colours above 1 are not clamped."""

    def clamped(self, channel: Floats) -> Floats:
        return channel


class LampOfTwoDecimals(Vertex):
    """The lamp's place is off by half a hundredth on each axis."""

    def towards_light(self, world: Vector) -> list[Floats]:
        *place, w = self.scene.light.homogeneous
        return self.towards([*(x + off * w for x, off in zip(place, (0.005, -0.005, 0.005), strict=True)), w], world)


class Attenuation(Vertex):
    """The lamp's light weakens by 0.05 % a unit of distance: a default left in."""

    def lit(self, image: Any, world: Vector, codes: Floats, albedo: Vector) -> list[Floats]:
        lamp = self.scene.light and self.scene.light.homogeneous
        if lamp is None or lamp[3] == 0.0:
            return super().lit(image, world, codes, albedo)
        distance = self.length([self.alu.subtract(place, x) for place, x in zip(lamp, world, strict=False)])
        weaker = self.alu.subtract(1.0, self.alu.multiply(0.0005, distance))
        return super().lit(image, world, codes, [self.alu.multiply(weaker, channel) for channel in albedo])


class FastInverseSquareRoot(Vertex):
    """The vector to the light is normalized with the trick of 0x5F3759DF and one step of Newton's, to 0.18 %."""

    def towards_light(self, world: Vector) -> list[Floats]:
        light = super().towards_light(world)
        square = np.asarray(self.alu.dot(light, light), np.float32)
        guess = (0x5F3759DF - (square.view(np.int32) >> 1)).astype(np.int32).view(np.float32).astype(np.float64)
        root = guess * (1.5 - 0.5 * square * guess * guess)
        return [self.alu.multiply(root, x) for x in light]


class NormalsOfHalfPrecision(Vertex):
    """Normals are kept as half floats: mediump."""

    def normal(self, codes: Floats) -> list[Floats]:
        return [x.astype(np.float16).astype(np.float64) for x in super().normal(codes)]


class VaryingsOfHalfPrecision(Vertex):
    """Colours leave the vertex stage as half floats."""

    def lit(self, image: Any, world: Vector, codes: Floats, albedo: Vector) -> list[Floats]:
        return [x.astype(np.float16).astype(np.float64) for x in super().lit(image, world, codes, albedo)]


class ClampedBelowOne(Vertex):
    """Colours are clamped to 0.998, against an overflow of bytes."""

    def clamped(self, channel: Floats) -> Floats:
        return np.clip(channel, 0.0, 0.998)


MUTANTS = (
    mutant(SignedNormalizedFetch),
    mutant(NormalsNotRenormalized),
    mutant(NormalOfTheNextPixel),
    mutant(LightNotNormalized),
    mutant(LightFromBehind),
    mutant(LampInViewSpace),
    mutant(TwoSidedLight),
    mutant(AmbientOnePercentMore, small=True),
    mutant(AmbientOfBytes, small=True),
    mutant(DiffuseHalfPercentLess, small=True),
    mutant(SpecularOnePercentMore, small=True),
    mutant(ReflectedTheOtherWay),
    mutant(HalfVector),
    mutant(ExponentOneLess, small=True),
    mutant(HighlightInTheShade),
    mutant(ColoredHighlight),
    mutant(HighlightForTheReference),
    mutant(ViewerAtInfinity),
    mutant(NoClamp, small=True),
    mutant(LampOfTwoDecimals, small=True),
    mutant(Attenuation, small=True),
    mutant(FastInverseSquareRoot, small=True),
    mutant(NormalsOfHalfPrecision, small=True),
    mutant(
        VaryingsOfHalfPrecision, small=True, hidden="far below the steps of bytes, and as often too bright as too dark"
    ),
    mutant(ClampedBelowOne, small=True),
)
