"""Phong's lighting, in the vertex stage."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.programs.splatting.case import Bools, Case, Floats, Image, Vector


class Lighting(Case):
    """Colours of points."""

    def lit(self, image: Image, world: Vector, codes: Vector, albedo: Vector) -> Vector:
        """Channels of the points of one image: world positions, 8-bit normals, stored colours."""
        self.do.told("fetch: stored colour", albedo)
        if self.scene.light is None:
            return list(albedo)
        normal = self.normal(self.do.told("fetch: 8-bit normal", codes))
        light = self.towards_light(world)
        facing = self.do.told("n.l", self.do.dot(normal, light))
        shine = self.highlight(normal, light, image, world, facing)
        return [self.clamped(channel) for channel in self.shaded(albedo, self.received(facing), shine)]

    def normal(self, codes: Vector) -> Vector:
        """Unit normals of codes."""
        return self.do.unit([self.decode(code) for code in codes])

    def decode(self, code: Floats) -> Floats:
        """A coordinate of its code; one that is fetched as k/255 is multiplied by 255."""
        return self.do.divide(self.do.either(self.from_zero(code), lambda: self.from_zero(self.fetched(code))), 127.0)

    def from_zero(self, code: Floats) -> Floats:
        """k − 128."""
        return self.do.subtract(code, 128.0)

    def fetched(self, code: Floats) -> Floats:
        """255 (k/255)."""
        return self.do.multiply(self.do.divide(code, 255.0), 255.0)

    def towards_light(self, world: Vector) -> Vector:
        """Unit vectors l."""
        return self.towards(self.scene.light.homogeneous, world)

    def eye(self, image: Image) -> Any:
        """(4,) whose highlight it is: the view camera's. The image is the one that the points are of."""
        return self.scene.camera.eye

    def towards_eye(self, image: Image, world: Vector) -> Vector:
        """Unit vectors v."""
        return self.towards(self.eye(image), world)

    def coefficient(self, name: str) -> Floats:
        """Ambient, diffuse or specular."""
        return self.do.number(getattr(self.scene.light, name))

    def exponent(self) -> int:
        """Of the highlight."""
        return int(self.scene.light.exponent)

    def lambert(self, facing: Floats) -> Floats:
        """Cosines that are light."""
        return np.maximum(facing, 0.0)

    def received(self, facing: Floats) -> Floats:
        """ambient + diffuse max(0, n·l)."""
        ambient, diffuse = self.coefficient("ambient"), self.coefficient("diffuse")
        return self.do.dot([ambient, diffuse], [1.0, self.lambert(facing)])

    def reflected(self, normal: Vector, light: Vector, facing: Floats) -> Vector:
        """R = 2 (n·l) n − l."""
        twice = self.do.multiply(2.0, facing)
        return [self.do.dot([twice, -1.0], [n, l]) for n, l in zip(normal, light, strict=True)]

    def mirrored(self, normal: Vector, light: Vector, view: Vector, facing: Floats) -> Floats:
        """The cosine r·v, by the vector r or without it."""
        cosine = self.do.dot(self.reflected(normal, light, facing), view)
        if not self.right("reflected"):
            return cosine
        return self.do.either(cosine, lambda: self.mirrored_cosine(normal, light, view, facing))

    def mirrored_cosine(self, normal: Vector, light: Vector, view: Vector, facing: Floats) -> Floats:
        """2 (n·l)(n·v) − l·v."""
        twice = self.do.multiply(2.0, facing)
        return self.do.dot([twice, -1.0], [self.do.dot(normal, view), self.do.dot(light, view)])

    def lights_up(self, facing: Floats) -> Bools:
        """Where a highlight can be: on the lit side."""
        return facing > 0.0

    def highlight(self, normal: Vector, light: Vector, image: Image, world: Vector, facing: Floats) -> Floats:
        """specular max(0, r·v)^e where n·l > 0."""
        if not self.scene.light.specular:
            return np.zeros(np.shape(facing))
        view = self.towards_eye(image, world)
        cosine = self.do.told("r.v", self.mirrored(normal, light, view, facing))
        power = self.do.power(np.maximum(cosine, 0.0), self.exponent())
        shine = self.do.told("highlight, where n.l > 0", self.do.multiply(self.coefficient("specular"), power))
        return np.where(self.do.told("n.l > 0", self.lights_up(facing)), shine, 0.0)

    def shaded(self, albedo: Vector, received: Floats, shine: Floats) -> Vector:
        """albedo · received + shine, a channel at a time."""
        return [self.do.dot([channel, shine], [received, 1.0]) for channel in albedo]

    def clamped(self, channel: Floats) -> Floats:
        """To [0, 1]."""
        return np.clip(channel, 0.0, 1.0)
