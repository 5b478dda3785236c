"""Bugs of the vertex stage: the light."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Image, Vector
from ibr_ref.oracle.programs.splatting.port import Port

LIGHTING = Bugs("vertex")


@LIGHTING.add("light-not-normalized")
class _LightNotNormalized(Port):
    """The vector to the lamp is not normalized."""

    def towards_light(self, world: Vector) -> Vector:
        *place, w = self.do.number(self.scene.light.homogeneous)
        return [self.do.subtract(value, w * x) for value, x in zip(place, world, strict=True)]


@LIGHTING.add("light-from-behind")
class _LightFromBehind(Port):
    """The direction is taken from the light, not towards it."""

    def towards_light(self, world: Vector) -> Vector:
        return [-x for x in super().towards_light(world)]


@LIGHTING.add("lamp-in-view-space")
class _LampInViewSpace(Port):
    """The light's place is transformed into view space, the points are not."""

    def towards_light(self, world: Vector) -> Vector:
        moved = self.scene.camera.view_from_world @ self.scene.light.homogeneous
        return self.towards(moved, world)


@LIGHTING.add("two-sided-light")
class _TwoSidedLight(Port):
    """|n·l| for max(0, n·l)."""

    def lambert(self, facing: Floats) -> Floats:
        return np.abs(facing)


@LIGHTING.add("ambient-one-percent-more", small=True)
class _AmbientOnePercentMore(Port):
    """The ambient light is 1 % too bright."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (1.01 if name == "ambient" else 1.0)


@LIGHTING.add("ambient-of-bytes", small=True)
class _AmbientOfBytes(Port):
    """The ambient light is held as a byte."""

    def coefficient(self, name: str) -> Floats:
        value = super().coefficient(name)
        return np.rint(255.0 * value) / 255.0 if name == "ambient" else value


@LIGHTING.add("diffuse-half-percent-less", small=True)
class _DiffuseHalfPercentLess(Port):
    """The diffuse light is half a percent too dark."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (0.995 if name == "diffuse" else 1.0)


@LIGHTING.add("specular-one-percent-more", small=True)
class _SpecularOnePercentMore(Port):
    """The highlight is 1 % too bright."""

    def coefficient(self, name: str) -> Floats:
        return super().coefficient(name) * (1.01 if name == "specular" else 1.0)


@LIGHTING.add("reflected-the-other-way")
class _ReflectedTheOtherWay(Port):
    """R = l − 2 (n·l) n: the sign of reflect() with l for the incoming ray."""

    def reflected(self, normal: Vector, light: Vector, facing: Floats) -> Vector:
        return [-x for x in super().reflected(normal, light, facing)]


@LIGHTING.add("half-vector")
class _HalfVector(Port):
    """Blinn's (n·h)^e for Phong's (r·v)^e."""

    def mirrored(self, normal: Vector, light: Vector, view: Vector, facing: Floats) -> Floats:
        half = self.do.unit([self.do.add(l, v) for l, v in zip(light, view, strict=True)])
        return self.do.dot(normal, half)


@LIGHTING.add("exponent-one-less", small=True)
class _ExponentOneLess(Port):
    """The highlight's exponent is off by one."""

    def exponent(self) -> int:
        return max(0, super().exponent() - 1)


@LIGHTING.add("highlight-in-the-shade")
class _HighlightInTheShade(Port):
    """The highlight is not bound to n·l > 0."""

    def lights_up(self, facing: Floats) -> Bools:
        return np.ones(np.shape(facing), np.bool_)


@LIGHTING.add("colored-highlight")
class _ColoredHighlight(Port):
    """The highlight has the colour of the surface."""

    def shaded(self, albedo: Vector, received: Floats, shine: Floats) -> Vector:
        return [self.do.multiply(channel, self.do.add(received, shine)) for channel in albedo]


@LIGHTING.add("highlight-for-the-reference")
class _HighlightForTheReference(Port):
    """v points to the reference camera's eye: the highlight does not move with the view."""

    def eye(self, image: Image) -> Any:
        return image.camera.eye


@LIGHTING.add("viewer-at-infinity")
class _ViewerAtInfinity(Port):
    """v is the view axis for all points, as in GL without its local viewer."""

    def eye(self, image: Image) -> Any:
        axis = self.scene.camera.world_from_view[:3, 2]
        return np.append(axis / np.sqrt(axis @ axis), 0.0)


@LIGHTING.add("lamp-of-two-decimals", small=True)
class _LampOfTwoDecimals(Port):
    """The lamp's place is off by half a hundredth on each axis."""

    def towards_light(self, world: Vector) -> Vector:
        *place, w = self.scene.light.homogeneous
        return self.towards([*(x + off * w for x, off in zip(place, (0.005, -0.005, 0.005), strict=True)), w], world)


@LIGHTING.add("attenuation", small=True)
class _Attenuation(Port):
    """The lamp's light weakens by 0.05 % a unit of distance: a default left in."""

    def lit(self, image: Image, world: Vector, codes: Vector, albedo: Vector) -> Vector:
        lamp = self.scene.light and self.scene.light.homogeneous
        if lamp is None or lamp[3] == 0.0:
            return super().lit(image, world, codes, albedo)
        distance = self.length([self.do.subtract(place, x) for place, x in zip(lamp, world, strict=False)])
        weaker = self.do.subtract(1.0, self.do.multiply(0.0005, distance))
        return super().lit(image, world, codes, [self.do.multiply(weaker, channel) for channel in albedo])


def _magic(square: Any) -> Any:
    """About 1 / sqrt(x), falling."""
    bits = np.asarray(square, np.float32).view(np.int32) >> 1
    return (0x5F3759DF - bits).astype(np.int32).view(np.float32).astype(np.float64)


@LIGHTING.add("fast-inverse-square-root", small=True)
class _FastInverseSquareRoot(Port):
    """The vector to the light is normalized with the trick of 0x5F3759DF and one step of Newton's, to 0.18 %."""

    def towards_light(self, world: Vector) -> Vector:
        light = super().towards_light(world)
        square = self.do.dot(light, light)
        guess = -self.do.rising(lambda x: -_magic(x), square)
        root = guess * (1.5 - 0.5 * square * guess * guess)
        return [self.do.multiply(root, x) for x in light]


@LIGHTING.add("negative-light")
class _NegativeLight(Port):
    """max(0, n·l) is n·l: surfaces turned away are darker than the ambient light."""

    def lambert(self, facing: Floats) -> Floats:
        return facing


@LIGHTING.add("ambient-without-albedo")
class _AmbientWithoutAlbedo(Port):
    """The ambient light has not the surface's colour."""

    def shaded(self, albedo: Vector, received: Floats, shine: Floats) -> Vector:
        ambient = self.coefficient("ambient")
        diffuse = self.do.subtract(received, ambient)
        return [self.do.dot([channel, shine, ambient], [diffuse, 1.0, 1.0]) for channel in albedo]


@LIGHTING.add("direction-as-position")
class _DirectionAsPosition(Port):
    """The sun's direction is taken for the place of a lamp: w of the light is not looked at."""

    def towards_light(self, world: Vector) -> Vector:
        return self.towards([*self.scene.light.homogeneous[:3], 1.0], world)


@LIGHTING.add("position-as-direction")
class _PositionAsDirection(Port):
    """The lamp's place is taken for a direction: the points are not subtracted from it."""

    def towards_light(self, world: Vector) -> Vector:
        place = np.asarray(self.scene.light.homogeneous[:3], np.float64)
        return self.towards([*place / np.sqrt(place @ place), 0.0], world)


@LIGHTING.add("eye-in-the-origin")
class _EyeInTheOrigin(Port):
    """v is −p: right in view space, but the points are in the world's."""

    def eye(self, image: Image) -> Any:
        return np.array([0.0, 0.0, 0.0, 1.0])


@LIGHTING.add("view-vector-from-the-eye")
class _ViewVectorFromTheEye(Port):
    """v points from the eye to the point."""

    def towards_eye(self, image: Image, world: Vector) -> Vector:
        return [-x for x in super().towards_eye(image, world)]


@LIGHTING.add("exponent-times-four")
class _ExponentTimesFour(Port):
    """The exponent is Blinn's, four times as large, the cosine Phong's."""

    def exponent(self) -> int:
        return 4 * super().exponent()


@LIGHTING.add("highlight-times-the-cosine")
class _HighlightTimesTheCosine(Port):
    """The highlight is multiplied by n·l, as the diffuse light is."""

    def highlight(self, normal: Vector, light: Vector, image: Image, world: Vector, facing: Floats) -> Floats:
        return self.do.multiply(super().highlight(normal, light, image, world, facing), np.maximum(facing, 0.0))


@LIGHTING.add("specular-of-bytes", small=True)
class _SpecularOfBytes(Port):
    """The specular light is held as a byte."""

    def coefficient(self, name: str) -> Floats:
        value = super().coefficient(name)
        return np.rint(255.0 * value) / 255.0 if name == "specular" else value


@LIGHTING.add("exponent-one-more", small=True)
class _ExponentOneMore(Port):
    """The highlight's exponent is one too large: a loop that runs once too often."""

    def exponent(self) -> int:
        return super().exponent() + 1


@LIGHTING.add("faint-highlights-cut", small=True)
class _FaintHighlightsCut(Port):
    """Highlights below 1/100 are left out, to save a branch its work."""

    def highlight(self, normal: Vector, light: Vector, image: Image, world: Vector, facing: Floats) -> Floats:
        shine = super().highlight(normal, light, image, world, facing)
        return np.where(shine < 0.01, 0.0, shine)
