"""Phong's lighting, in the vertex stage."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.oracle.ports.splatting.stage import Stage, Vector


class Lighting(Stage):
    """Colours of points."""

    def lit(self, image: Any, world: Vector, codes: Floats, albedo: Vector) -> list[Floats]:
        """Channels of the points of one image: world positions, 8-bit normals (P, 3), stored colours."""
        if self.scene.light is None:
            return list(albedo)
        normal = self.normal(codes)
        light = self.towards_light(world)
        facing = self.alu.dot(normal, light)
        view = self.towards_eye(image, world)
        shine = self.highlight(normal, light, view, facing)
        return [self.clamped(channel) for channel in self.shaded(albedo, self.received(facing), shine)]

    def normal(self, codes: Floats) -> list[Floats]:
        """Unit normals of codes (P, 3)."""
        return self.alu.unit([self.decode(codes[:, axis]) for axis in range(3)])

    def decode(self, code: Floats) -> Floats:
        """A coordinate of its code."""
        return self.alu.divide(self.alu.subtract(code, 128.0), 127.0)

    def towards_light(self, world: Vector) -> list[Floats]:
        """Unit vectors l."""
        return self.towards(self.scene.light.homogeneous, world)

    def eye(self, image: Any) -> ArrayLike:
        """(4,) whose highlight it is: the view camera's. The image is the one that the points are of."""
        eye: ArrayLike = self.scene.camera.eye
        return eye

    def towards_eye(self, image: Any, world: Vector) -> list[Floats]:
        """Unit vectors v."""
        return self.towards(self.eye(image), world)

    def coefficient(self, name: str) -> Floats:
        """Ambient, diffuse or specular."""
        return self.alu.number(getattr(self.scene.light, name))

    def exponent(self) -> int:
        """Of the highlight."""
        return int(self.scene.light.exponent)

    def lambert(self, facing: Floats) -> Floats:
        """Cosines that are light."""
        return np.maximum(facing, 0.0)

    def received(self, facing: Floats) -> Floats:
        """ambient + diffuse max(0, n·l)."""
        ambient, diffuse = self.coefficient("ambient"), self.coefficient("diffuse")
        return self.alu.dot([ambient, diffuse], [1.0, self.lambert(facing)])

    def reflected(self, normal: Vector, light: Vector, facing: Floats) -> list[Floats]:
        """R = 2 (n·l) n − l."""
        twice = self.alu.multiply(2.0, facing)
        return [self.alu.dot([twice, -1.0], [n, l]) for n, l in zip(normal, light, strict=True)]

    def mirrored(self, normal: Vector, light: Vector, view: Vector, facing: Floats) -> Floats:
        """The cosine r·v."""
        return self.alu.dot(self.reflected(normal, light, facing), view)

    def lights_up(self, facing: Floats) -> Floats:
        """Where a highlight can be: on the lit side."""
        return np.where(facing > 0.0, 1.0, 0.0)

    def highlight(self, normal: Vector, light: Vector, view: Vector, facing: Floats) -> Floats:
        """specular max(0, r·v)^e where n·l > 0."""
        cosine = np.maximum(self.mirrored(normal, light, view, facing), 0.0)
        shine = self.alu.multiply(self.coefficient("specular"), self.alu.power(cosine, self.exponent()))
        return shine * self.lights_up(facing)

    def shaded(self, albedo: Vector, received: Floats, shine: Floats) -> list[Floats]:
        """albedo · received + shine, a channel at a time."""
        return [self.alu.dot([channel, shine], [received, 1.0]) for channel in albedo]

    def clamped(self, channel: Floats) -> Floats:
        """To [0, 1]."""
        return np.clip(channel, 0.0, 1.0)
