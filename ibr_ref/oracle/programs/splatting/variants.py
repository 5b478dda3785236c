"""Ports of splatting that are right, each in its own way, with the tightest device profile that explains it.

Splatting filters nothing and interpolates nothing: 8-bit weights and varyings over unsnapped triangles are no variants here.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.faults.kinds import Variant
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Image, Ints, Vector
from ibr_ref.oracle.programs.splatting.port import Port
from ibr_ref.oracle.programs.splatting.raster import Fragments, Splats


class _ClipFromWorld(Port):
    """T_W→C and T_P are multiplied together on the host."""

    def positions(self, image: Image, point: Vector) -> tuple[Vector, Vector, Vector]:
        world = self.from_view(image.camera, point)
        return world, self.camera_point(world), self.transform(self.scene.camera.clip_from_world, world)


class _ClipFromReference(Port):
    """All three matrices are multiplied together on the host; world and view space serve the light and the law."""

    def positions(self, image: Image, point: Vector) -> tuple[Vector, Vector, Vector]:
        world, view, _ = super().positions(image, point)
        return world, view, self.transform(self.scene.camera.clip_from_world @ image.camera.world_from_view, point)


class _InverseIntrinsics(Port):
    """Unprojection by the inverse matrix of the intrinsics."""

    def image_plane(self, camera: Any, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        return self.by_inverse(camera, u, v)


class _Viewport(Port):
    """The window is NDC scaled and moved: x · width/2 + width/2."""

    def window_x(self, x: Floats) -> Floats:
        return self.viewport(x, 0.5 * self.scene.camera.width, 1.0)

    def window_y(self, y: Floats) -> Floats:
        return self.viewport(y, 0.5 * self.scene.camera.height, -1.0)


class _HornersLaw(Port):
    """The law's denominator is (β d + γ) d + δ."""

    def denominator(self, d: Floats) -> Floats:
        beta, gamma, delta = self.law()
        return self.do.dot([self.do.dot([beta, gamma], [d, 1.0]), delta], [d, 1.0])


class _CosinesOnly(Port):
    """R·v is 2 (n·l)(n·v) − l·v, without r; the light is the sum of three terms."""

    def mirrored(self, normal: Vector, light: Vector, view: Vector, facing: Floats) -> Floats:
        return self.mirrored_cosine(normal, light, view, facing)

    def shaded(self, albedo: Vector, received: Floats, shine: Floats) -> Vector:
        ambient = self.coefficient("ambient")
        diffuse = self.do.subtract(received, ambient)
        return [self.do.dot([x, x, shine], [ambient, diffuse, 1.0]) for x in albedo]


class _WholeCodes(Port):
    """Normals are normalized from k − 128, without the division by 127."""

    def decode(self, code: Floats) -> Floats:
        return self.from_zero(code)


class _FloatCodes(Port):
    """Codes are fetched as k / 255 and multiplied by 255."""

    def decode(self, code: Floats) -> Floats:
        return self.do.divide(self.from_zero(self.fetched(code)), 127.0)


class _Quads(Port):
    """Splats are two triangles, whose corners are snapped, not the centre: the way where points have one size."""

    def snapped(self, window: Floats) -> Floats:
        return window

    def borders(self, center: Floats, half: Floats) -> tuple[Floats, Floats]:
        return self.do.snap(self.do.subtract(center, half)), self.do.snap(self.do.add(center, half))

    def in_disc(self, splats: Splats, fragments: Fragments) -> Bools:
        moved = splats._replace(x=self.do.snap(splats.x), y=self.do.snap(splats.y))
        return super().in_disc(moved, fragments)


class _CutQuads(_Quads):
    """Quads are cut at the picture's borders, and their depth is made of that of the corners, and w of theirs, anew."""

    def splats(self, vertex: Ints, window: Vector, width: Floats, depth: Floats) -> Splats:
        for axis, size in zip(window, (self.scene.camera.width, self.scene.camera.height), strict=True):
            beyond = np.maximum(0.5 * width - axis, axis + 0.5 * width - size)
            t = self.do.divide(beyond, width)
            z, w = (self.do.lerp(x, x, t) for x in (depth, np.ones(len(depth))))
            depth = np.where((t > 0.0) & (t < 1.0), self.do.divide(z, w), depth)
        return super().splats(vertex, window, width, depth)


class _Conics(Port):
    """Ellipses: the inverse of the covariance is made first, as a vertex shader hands it on."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        a, b, c = (self.do.divide(x, self.determinant(xx, xy, yy)) for x in (yy, xy, xx))
        products = [self.do.multiply(dx, dx), self.do.multiply(dx, dy), self.do.multiply(dy, dy)]
        return self.do.dot([a, self.do.multiply(-2.0, b), c], products)


class _Axes(Port):
    """Ellipses: quads along the axes, whose lengths are the roots of the covariance's eigenvalues."""

    def quadratic(self, dx: Floats, dy: Floats, xx: Floats, xy: Floats, yy: Floats) -> Floats:
        do = self.do
        half, apart = do.multiply(0.5, do.add(xx, yy)), do.multiply(0.5, do.subtract(xx, yy))
        far = do.root(do.dot([apart, xy], [apart, xy]))
        long, short = do.add(half, far), do.subtract(half, far)
        flat = xx >= yy
        axis = [np.where(flat, do.subtract(long, yy), xy), np.where(flat, xy, do.subtract(long, xx))]
        x, y = do.unit([np.where(far > 0.0, axis[0], 1.0), np.where(far > 0.0, axis[1], 0.0)])
        u, v = (do.divide(do.dot([dx, dy], way), do.root(size)) for way, size in (([x, y], long), ([-y, x], short)))
        return do.dot([u, v], [u, v])


class _AllAtOnce(_ClipFromWorld, _Viewport, _HornersLaw, _CosinesOnly, _Quads):
    """Other orders in every stage that has one."""


class OwnNormals(Port):
    """Points are lit with the port's own normals, not with those that the case hands over."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """Without the case's inputs."""
        super().__init__(scene, params, policy, {})


_FLOAT32 = Policy()
_ALL = Policy(loose=2, seed=5, backwards=True, subpixel_rounding="down", depth_bits=24, color_bits=8)

VARIANTS: tuple[Variant, ...] = (
    Variant("float64", Policy(float_bits=64), "ieee32"),
    Variant("float32", _FLOAT32, "ieee32"),
    Variant("backwards-sums", Policy(backwards=True), "ieee32"),
    Variant("fused", Policy(fused=True), "ieee32"),
    Variant("fused-backwards", Policy(fused=True, backwards=True), "ieee32"),
    Variant("clip-from-world", _FLOAT32, "ieee32", _ClipFromWorld),
    Variant("clip-from-reference", _FLOAT32, "ieee32", _ClipFromReference),
    Variant("inverse-intrinsics", _FLOAT32, "ieee32", _InverseIntrinsics),
    Variant("viewport", _FLOAT32, "ieee32", _Viewport),
    Variant("horners-law", _FLOAT32, "ieee32", _HornersLaw),
    Variant("cosines-only", _FLOAT32, "ieee32", _CosinesOnly),
    Variant("whole-codes", _FLOAT32, "ieee32", _WholeCodes),
    Variant("conics", _FLOAT32, "ieee32", _Conics),
    Variant("axes", _FLOAT32, "ieee32", _Axes),
    Variant("pow", Policy(intrinsic_power=True), "ieee32"),
    Variant("pow-loose", Policy(intrinsic_power=True, loose=2, seed=3), "vulkan"),
    Variant("own-normals", _FLOAT32, "ieee32", OwnNormals, ("atlas.normal",)),
    Variant("truncating", Policy(truncated=True), "d3d11"),
    # Rounded correctly, 255 (k / 255) is k for every byte, and the port the plain one.
    Variant("normals-as-floats", Policy(truncated=True), "d3d11", _FloatCodes),
    Variant("reciprocals", Policy(reciprocal=True), "vulkan"),
    Variant("loose-quotients-1", Policy(loose=2, seed=1), "vulkan"),
    Variant("loose-quotients-2", Policy(loose=2, seed=2), "vulkan"),
    Variant("4-subpixel-bits", Policy(subpixel_bits=4), "gl,subpixel_bits=4", coarse=True),
    Variant("4-subpixel-bits-truncated", Policy(subpixel_bits=4, subpixel_rounding="down"), "gl,subpixel_bits=4"),
    Variant("subpixels-up", Policy(subpixel_rounding="up"), "vulkan"),
    Variant("subpixels-truncated", Policy(subpixel_rounding="down"), "vulkan"),
    Variant("quads", _FLOAT32, "vulkan", _Quads),
    Variant("quads-cut-at-the-borders", Policy(loose=2, seed=4), "vulkan", _CutQuads),
    Variant("quads-cut-at-the-borders-with-jitter", Policy(jitter=2, seed=4), "gl", _CutQuads, coarse=True),
    Variant("depth-24", Policy(depth_bits=24), "vulkan"),
    # Looser in sums and products than any interface grants: in the profile with the most room.
    Variant("jitter-1", Policy(jitter=1, seed=1), "gl"),
    Variant("jitter-2", Policy(jitter=2, seed=2), "gl"),
    Variant("jitter-3", Policy(jitter=2, seed=3), "gl"),
    Variant("bytes", Policy(color_bits=8), "gl"),
    Variant("all-at-once", _ALL, "gl", _AllAtOnce),
)
