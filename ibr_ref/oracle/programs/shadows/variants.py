"""Legal ports of shadows: each is right in its own way, and none may be accused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ibr_ref.oracle.accept.borders import SIDES
from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.faults.kinds import Variant
from ibr_ref.oracle.programs.program import Floats, Vector
from ibr_ref.oracle.programs.shadows.lights import Matrix
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import Fragments, Raster


class _LerpByDifference(Arithmetic):
    """A + f (b - a)."""

    def lerp(self, a: Any, b: Any, f: Any) -> Any:
        return self.dot([a, f], [1.0, self.subtract(b, a)])


class LerpByDifference(Port):
    """Mixes are a + f (b - a)."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """By an arithmetic of its own."""
        super().__init__(scene, params, policy, inputs)
        self.on(_LerpByDifference(policy))


class _Planes(Raster):
    """Varyings by differences from the first corner."""

    def linear(self, fragments: Fragments, corners: Floats) -> Floats:
        do, (a, b, c) = self.do, corners[fragments.triangle].T
        shares = [do.divide(edge, fragments.area) for edge in fragments.edges[1:]]
        return do.dot([a, *shares], [1.0, do.subtract(b, a), do.subtract(c, a)])


class Planes(Port):
    """Window depths and texture coordinates are interpolated by plane equations."""

    map_raster = direct_raster = warp_raster = surface_raster = _Planes


class _SharesFirst(Raster):
    """Perspective-correct weights that sum to one, then the sum of the corners."""

    def perspective(self, fragments: Fragments, w: Floats, varyings: Sequence[Floats]) -> Vector:
        do = self.do
        at = [do.divide(edge, by) for edge, by in zip(fragments.edges, w[fragments.triangle].T, strict=True)]
        shares = [do.divide(weight, do.sum(at)) for weight in at]
        return [do.dot(shares, list(varying[fragments.triangle].T)) for varying in varyings]


class SharesFirst(Port):
    """Varyings are sums by normalized weights."""

    surface_raster = _SharesFirst


class _CutAtBorders(Raster):
    """Clips at the picture's borders too."""

    def distances(self, corner: Floats) -> Vector:
        """Near, far, left, right, lower, upper."""
        sides = [self.do.add(corner[..., 3], sign * corner[..., axis]) for axis, sign in SIDES]
        return [*super().distances(corner), *sides]


class CutAtBorders(Port):
    """Triangles are cut at the borders of maps and picture: what is left may be slivers."""

    map_raster = direct_raster = surface_raster = _CutAtBorders


class CombinedMatrices(Port):
    """The texture matrix and the camera's are products, made once, in floats."""

    def to_clip(self, world: Vector) -> Vector:
        """Clip coordinates by one product."""
        camera = self.scene.camera
        return self.by_product(self.do.matrix(camera.clip_from_view), self.do.matrix(camera.view_from_world), world)

    def texture_coordinates(self, world: Vector, place: Floats) -> Vector:
        """Q by one product."""
        return self.by_one_matrix(world, place)


class HostMatrices(Port):
    """The light's matrices are made in doubles and rounded once."""

    def light_view(self, place: Floats) -> Matrix:
        """As it is uploaded."""
        return list(self.do.matrix(self.scene.light.camera(1, place).view_from_world))


class CosineOverLengths(Port):
    """n.l is divided by both lengths at the end; the normal is taken about the last corner."""

    def normals(self, world: Vector) -> Vector:
        """Of any length."""
        first, second = ([self.do.subtract(p[:, k], p[:, 2]) for p in world] for k in (0, 1))
        return self.cross(first, second)

    def toward_light(self, world: Vector) -> Vector:
        """Of any length."""
        return [self.do.subtract(at, p) for p, at in zip(world, self.centre, strict=True)]

    def cosine(self, normal: Vector, world: Vector) -> Floats:
        """max(0, n.l) / (|n| |l|)."""
        do, light = self.do, self.toward_light(world)
        normal = self.turned(normal, self.toward_eye(world))
        lengths = do.multiply(do.root(do.dot(normal, normal)), do.root(do.dot(light, light)))
        return do.divide(self.lambert(do.dot(normal, light)), lengths)


class MeanOfSamples(Port):
    """A float sum is divided by N at its end."""

    def accumulated(self, shadows: list[Floats]) -> Floats:
        """(H, W)."""
        if self.params.accumulation != "float":
            return super().accumulated(shadows)
        return self.mean(shadows)


class ShadeBySum(Port):
    """Colour is the sum of an ambient and a direct part."""

    def shaded(self, color: Vector, shadow: Floats, cosine: Floats) -> Vector:
        """Channels."""
        return self.by_parts(color, shadow, cosine)


class DirectFromCentre(Port):
    """Method "direct" renders the object moved the opposite way from the centre: what the sample sees, but for rounding."""

    def direct_clip(self, place: Floats) -> Vector:
        """Four (V,)."""
        return self.moved_clip(place)


class OwnMaps(Port):
    """The port warps nine maps that it has rendered itself, not those that the case hands over."""

    def lines(self) -> Vector:
        """Of its own positions."""
        positions = self.positions()
        return [positions[0, :, 0], positions[:, 0, 1]]

    def images(self) -> Floats:
        """Its own."""
        return self.nine_maps(self.positions())


HANDED_OVER = ("maps.positions", "maps.image")
"""The nine maps, which the case hands over."""

_VULKAN = Policy(reciprocal=True, weight_bits=8, subpixel_rounding="up", depth_bits=24)
_GL = Policy(
    fused=True, reciprocal=True, jitter=2, seed=4, weight_bits=8, weight_rounding="down", subpixel_rounding="down",
    snapped_varyings=False, depth_bits=24, color_bits=8,
)  # fmt: skip

VARIANTS: tuple[Variant, ...] = (
    Variant("doubles", Policy(float_bits=64), "ieee32"),
    Variant("floats", Policy(), "ieee32"),
    Variant("sums backwards", Policy(backwards=True), "ieee32"),
    Variant("fused multiply-add", Policy(fused=True), "ieee32"),
    Variant("fused, backwards", Policy(fused=True, backwards=True), "ieee32"),
    Variant("lerp by difference", Policy(), "ieee32", LerpByDifference),
    Variant("lerp by difference, fused", Policy(fused=True), "ieee32", LerpByDifference),
    Variant("plane equations", Policy(), "ieee32", Planes),
    Variant("normalized weights", Policy(), "ieee32", SharesFirst),
    Variant("combined matrices", Policy(), "ieee32", CombinedMatrices),
    Variant("combined matrices, fused", Policy(fused=True), "ieee32", CombinedMatrices),
    Variant("matrices of the host", Policy(), "ieee32", HostMatrices),
    Variant("cosine over lengths", Policy(), "ieee32", CosineOverLengths),
    Variant("mean of samples", Policy(), "ieee32", MeanOfSamples),
    Variant("shade by sum", Policy(fused=True), "ieee32", ShadeBySum),
    Variant("direct from the centre", Policy(), "ieee32", DirectFromCentre),
    Variant("own maps", Policy(), "ieee32", OwnMaps, HANDED_OVER),
    Variant("own maps, subpixels up", Policy(subpixel_rounding="up"), "vulkan", OwnMaps, HANDED_OVER),
    Variant("truncated", Policy(truncated=True), "d3d11"),
    Variant("truncated, fused, 8-bit weights", Policy(truncated=True, fused=True, weight_bits=8), "d3d11"),
    Variant("quotients off by 2 ULP", Policy(loose=2, seed=1), "vulkan"),
    Variant("reciprocals", Policy(reciprocal=True), "vulkan"),
    Variant("8-bit weights", Policy(weight_bits=8), "vulkan"),
    Variant("8-bit weights truncated", Policy(weight_bits=8, weight_rounding="down"), "vulkan"),
    Variant("4 subpixel bits", Policy(subpixel_bits=4), "gl,subpixel_bits=4", coarse=True),
    Variant(
        "4 subpixel bits, own maps",
        Policy(subpixel_bits=4, subpixel_rounding="down"),
        "gl,subpixel_bits=4",
        OwnMaps,
        HANDED_OVER,
    ),
    Variant(
        "bytes filtered in bytes",
        Policy(filtered_bytes=True, weight_bits=8),
        "gl,filter_result=unorm8",
        coarse=True,
    ),
    Variant("subpixels up", Policy(subpixel_rounding="up"), "vulkan"),
    Variant("subpixels truncated", Policy(subpixel_rounding="down"), "vulkan"),
    Variant("24-bit depth", Policy(depth_bits=24), "vulkan"),
    Variant("all of vulkan", _VULKAN, "vulkan", CombinedMatrices),
    Variant("jitter 1", Policy(jitter=2, seed=1), "gl"),
    Variant("jitter 2", Policy(jitter=2, seed=2), "gl"),
    Variant("jitter 3", Policy(jitter=2, seed=3, backwards=True), "gl"),
    Variant("unsnapped varyings", Policy(snapped_varyings=False), "gl"),
    Variant("cut at the borders", Policy(snapped_varyings=False), "gl", CutAtBorders, coarse=True),
    Variant("8-bit colour", Policy(color_bits=8), "gl"),
    Variant("all of gl", _GL, "gl"),
)
