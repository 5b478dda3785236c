"""The stages with the same formulas in another order, as compilers, drivers and authors choose it."""
# An override computes what its parent does; how, its class says.
# ruff: noqa: D102

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.raster import Fragments, Raster, Splats
from ibr_ref.oracle.ports.splatting.stage import Vector
from ibr_ref.oracle.ports.splatting.vertex import Vertex


class ClipFromWorld(Vertex):
    """T_W→C and T_P are multiplied together on the host."""

    def positions(self, image: Any, point: list[Floats]) -> tuple[list[Floats], list[Floats], list[Floats]]:
        world = self.world_point(image.camera, point)
        return world, self.camera_point(world), self.transform(self.scene.camera.clip_from_world, world)


class ClipFromReference(Vertex):
    """All three matrices are multiplied together on the host; world and view space serve the light and the law."""

    def positions(self, image: Any, point: list[Floats]) -> tuple[list[Floats], list[Floats], list[Floats]]:
        world, view, _ = super().positions(image, point)
        product = self.scene.camera.clip_from_world @ image.camera.world_from_view
        return world, view, self.transform(product, point)


class InverseIntrinsics(Vertex):
    """Unprojection by the inverse matrix of the intrinsics."""

    def image_plane(self, camera: Any, u: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        x, y, _ = self.alu.number(np.linalg.inv(camera.intrinsics))
        return self.alu.dot(x, [u, v, 1.0]), self.alu.dot(y, [u, v, 1.0])


class Viewport(Vertex):
    """The window is NDC scaled and moved: x · width/2 + width/2."""

    def window_x(self, x: Floats) -> Floats:
        half = 0.5 * self.scene.camera.width
        return self.alu.dot([x, half], [half, 1.0])

    def window_y(self, y: Floats) -> Floats:
        half = 0.5 * self.scene.camera.height
        return self.alu.dot([y, half], [-half, 1.0])


class HornersLaw(Vertex):
    """The law's denominator is (β d + γ) d + δ."""

    def denominator(self, d: Floats) -> Floats:
        beta, gamma, delta = (self.alu.number(getattr(self.params, name)) for name in ("beta", "gamma", "delta"))
        return self.alu.dot([self.alu.dot([beta, gamma], [d, 1.0]), delta], [d, 1.0])


class CosinesOnly(Vertex):
    """R·v is 2 (n·l)(n·v) − l·v, without r; the light is the sum of three terms."""

    def mirrored(self, normal: Vector, light: Vector, view: Vector, facing: Floats) -> Floats:
        twice = self.alu.multiply(2.0, facing)
        return self.alu.dot([twice, -1.0], [self.alu.dot(normal, view), self.alu.dot(light, view)])

    def shaded(self, albedo: Vector, received: Floats, shine: Floats) -> list[Floats]:
        ambient = self.coefficient("ambient")
        diffuse = self.alu.subtract(received, ambient)
        return [self.alu.dot([x, x, shine], [ambient, diffuse, 1.0]) for x in albedo]


class WholeCodes(Vertex):
    """Normals are normalized from k − 128, without the division by 127."""

    def decode(self, code: Floats) -> Floats:
        return self.alu.subtract(code, 128.0)


class FloatCodes(Vertex):
    """Codes are fetched as k / 255 and multiplied by 255."""

    def decode(self, code: Floats) -> Floats:
        fetched = self.alu.divide(code, 255.0)
        return self.alu.divide(self.alu.subtract(self.alu.multiply(fetched, 255.0), 128.0), 127.0)


class Quads(Raster):
    """Splats are two triangles, whose corners are snapped, not the centre: the way where points have one size."""

    def snapped(self, window: Floats) -> Floats:
        return window

    def borders(self, center: Floats, half: Floats) -> tuple[Floats, Floats]:
        return self.alu.snap(self.alu.subtract(center, half)), self.alu.snap(self.alu.add(center, half))

    def in_disc(self, splats: Splats, fragments: Fragments) -> Bools:
        moved = splats._replace(x=self.alu.snap(splats.x), y=self.alu.snap(splats.y))
        return super().in_disc(moved, fragments)
