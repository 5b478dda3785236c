"""Bugs in stage 3: the light."""
# An override does what its parent says, but for the fault in the class's docstring.
# ruff: noqa: D102

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.oracle.ports.arithmetic import Floats
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


class NormalsOfBytesSwapped(Vertex):
    """Normals are fetched as BGR."""

    def normal(self, codes: Floats) -> list[Floats]:
        return super().normal(codes[:, ::-1])


class LightNotNormalized(Vertex):
    """The vector to the lamp is not normalized."""

    def towards_light(self, world: Vector) -> list[Floats]:
        *place, w = self.alu.number(self.scene.light.homogeneous)
        return [self.alu.subtract(value, w * x) for value, x in zip(place, world, strict=True)]


class SunForLamp(Vertex):
    """The lamp lights all points from the direction in which the origin sees it."""

    def towards_light(self, world: Vector) -> list[Floats]:
        return super().towards_light([0.0 * x for x in world])


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


class WrappedLight(Vertex):
    """(n·l + 1)/2 for max(0, n·l): half-Lambert."""

    def lambert(self, facing: Floats) -> Floats:
        return self.alu.multiply(0.5, self.alu.add(facing, 1.0))


class AmbientOnePercentMore(Vertex):
    """The ambient light is 1 % too bright."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (1.01 if name == "ambient" else 1.0)


class DiffuseHalfPercentLess(Vertex):
    """The diffuse light is half a percent too dark."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (0.995 if name == "diffuse" else 1.0)


class SpecularOnePercentMore(Vertex):
    """The highlight is 1 % too bright."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (1.01 if name == "specular" else 1.0)


class AmbientForLitOnly(Vertex):
    """The ambient light falls on the lit side only."""

    def received(self, facing: Floats) -> Floats:
        return np.where(facing > 0.0, super().received(facing), 0.0)


class ReflectedTheOtherWay(Vertex):
    """R = l − 2 (n·l) n: the sign of reflect() with l for the incoming ray."""

    def reflected(self, normal: Vector, light: Vector, facing: Floats) -> list[Floats]:
        return [-x for x in super().reflected(normal, light, facing)]


class OneForTwo(Vertex):
    """R = (n·l) n − l: the 2 is forgotten."""

    def reflected(self, normal: Vector, light: Vector, facing: Floats) -> list[Floats]:
        return [self.alu.dot([facing, -1.0], [n, l]) for n, l in zip(normal, light, strict=True)]


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


MUTANTS = (
    mutant(SignedNormalizedFetch, small=True),
    mutant(NormalsNotRenormalized, small=True),
    mutant(NormalOfTheNextPixel),
    mutant(NormalsOfBytesSwapped),
    mutant(LightNotNormalized),
    mutant(SunForLamp),
    mutant(LightFromBehind),
    mutant(LampInViewSpace),
    mutant(TwoSidedLight),
    mutant(WrappedLight),
    mutant(AmbientOnePercentMore, small=True),
    mutant(DiffuseHalfPercentLess, small=True),
    mutant(SpecularOnePercentMore, small=True),
    mutant(AmbientForLitOnly),
    mutant(ReflectedTheOtherWay),
    mutant(OneForTwo),
    mutant(HalfVector),
    mutant(ExponentOneLess, small=True),
    mutant(HighlightInTheShade, small=True),
    mutant(ColoredHighlight),
    mutant(HighlightForTheReference),
    mutant(ViewerAtInfinity),
    mutant(NoClamp, hidden=""),
)
