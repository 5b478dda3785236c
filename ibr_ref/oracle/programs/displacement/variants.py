"""Legal ports of displacement mapping: none may be accused."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from ibr_ref.oracle.accept.borders import SIDES
from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.faults.kinds import Variant
from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.port import Port
from ibr_ref.oracle.programs.displacement.raster import Fragments
from ibr_ref.oracle.programs.displacement.searches.below import Sunken
from ibr_ref.oracle.programs.displacement.vertex import Quad

# --- Other orders of operations --------------------------------------------------------------------------------------


class _CombinedMatrices(Port):
    """Both matrices are multiplied on the host, as most renderers hand them over."""

    def to_clip(self, world: Vector) -> Vector:
        matrix = self.do.number(self.scene.camera.clip_from_world)
        return [self.do.dot(row, [*world, 1.0]) for row in matrix]


class _FromFragment(Port):
    """Positions are C + v (h - C_h)/v_h, without the end points."""

    def rays(self, patch: Patch, point: Vector) -> Rays:
        if self.params.interval == "volume" or isinstance(self, Sunken):  # below the polygon they are so anyway
            return super().rays(patch, point)
        way = self.towards(patch.eye, point)
        slope = [self.do.divide(x, way[2]) for x in way]
        start = [self.multiply_add(s, self.do.subtract(1.0, point[2]), c) for s, c in zip(slope, point, strict=True)]
        one = np.ones(point[2].shape)
        return Rays([start[0], start[1], one], [-slope[0], -slope[1], -one])


class _BetweenEnds(Port):
    """Positions are B (1 - t) + A t."""

    def position(self, rays: Rays, index: Ints | int) -> Vector:
        return self.between_ends(rays, self.fraction(index))


class _ShortLerp(Port):
    """A + f (b - a)."""

    def lerp(self, a: Floats, b: Floats, f: Floats) -> Floats:
        return self.multiply_add(self.do.subtract(b, a), f, a)


class _WeightedTexels(Port):
    """Four products of weights, one sum."""

    def bilinear(self, texels: tuple[Floats, Floats, Floats, Floats], fx: Floats, fy: Floats) -> Floats:
        gx, gy = self.do.subtract(1.0, fx), self.do.subtract(1.0, fy)
        return self.do.dot(list(texels), [self.do.multiply(*pair) for pair in ((gx, gy), (fx, gy), (gx, fy), (fx, fy))])


class _ScaledTexels(Port):
    """Half a texel is taken off before the multiplication: (u - 0.5/W) W."""

    def texel_position(self, coordinate: Floats, size: int) -> Floats:
        return self.do.multiply(self.do.subtract(coordinate, self.do.divide(0.5, float(size))), float(size))


class _Planes(Port):
    """Varyings over w by plane equations, from the first corner on, as rasterizers set them up."""

    def varying(self, weights: Sequence[Floats], values: Sequence[Floats], w: Sequence[Floats]) -> Floats:
        return self.by_planes(weights, values, w, 0)


class _CrossedTangents(Port):
    """The normal is the cross product of the surface's tangents U + g_u s n and V + g_v s n."""

    def height_normal(self, patch: Patch, gradient: tuple[Floats, Floats]) -> Vector:
        return self.crossed_tangents(patch, gradient)


class _NoReflectedVector(Port):
    """The cosine of reflection as 2 (n.l)(n.v) - l.v, without a reflected vector."""

    def highlight(self, normal: Vector, to_light: Vector, to_eye: Vector, cosine: Floats) -> Floats:
        base = np.maximum(self.reflected_cosine(normal, to_light, to_eye, cosine), 0.0)
        return self.do.multiply(self.do.number(self.scene.light.specular), self.do.power(base, self.exponent()))


class _HostPatchSpace(Port):
    """Patch spaces, with eye and light in them, are computed on the host in float64 and uploaded."""

    def patch(self, number: int, polygon: Any) -> Patch:
        device, self.do = self.do, Arithmetic(Policy(float_bits=64))
        eye, light = self.eye, self.light
        self.eye, self.light = list(self.scene.camera.eye), list(self.scene.light.homogeneous)
        exact = super().patch(number, polygon)
        self.do, self.eye, self.light = device, eye, light
        fields = {
            name: [self.upload(x) for x in value] if name == "rows" else self.upload(value)
            for name, value in vars(exact).items()
            if name in ("corner", "edge_u", "edge_v", "normal", "up", "rows", "eye", "light", "facade_tile")
        }
        textures = {
            name: None if value is None else self.do.number(value)
            for name, value in vars(exact).items()
            if name in ("scale", "heights", "colors", "normals", "facade")
        }
        return Patch(**{**vars(exact), **fields, **textures})


class CutAtBorders(Port):
    """Polygons are cut at the picture's borders and fanned from another corner, their varyings planes over the window."""

    def clipped(self, polygon: list[Floats]) -> list[Floats]:
        """What near, far, left, right, lower and upper plane leave."""
        polygon = super().clipped(polygon)
        for axis, sign in SIDES:
            polygon = self.cut(polygon, partial(self.side_distance, axis, sign))
        return [*polygon[1:], *polygon[:1]]

    def side_distance(self, axis: int, sign: float, clip: Floats) -> Floats:
        """W + x, w - x, w + y, w - y."""
        return self.do.add(clip[3], sign * clip[axis])

    def weights(self, window: tuple[Floats, Floats], edges: Sequence[Ints], row: Ints, column: Ints) -> list[Floats]:
        """Each as c + a x + b y, of the unsnapped corners."""
        do, (x, y) = self.do, window
        sides = [(do.subtract(x[b], x[a]), do.subtract(y[b], y[a]), x[a], y[a]) for a, b in ((1, 2), (2, 0), (0, 1))]
        (ux, uy, _, _), (vx, vy, _, _) = sides[1:]
        area = do.subtract(do.multiply(ux, vy), do.multiply(uy, vx))
        weights = []
        for dx, dy, at_x, at_y in sides:
            along, down = do.divide(-dy, area), do.divide(dx, area)
            start = -do.dot([along, down], [at_x, at_y])
            weights.append(do.dot([start, along, down], [1.0, column + 0.5, row + 0.5]))
        return weights


class WholeTriangles(Port):
    """Covers clipped polygons, but makes planes of the triangles' own corners, behind the eye too, as SwiftShader does."""

    def fragments(self, quads: Sequence[Quad], first_triangle: int) -> Fragments:
        """Of the quads; kept is which triangle each is of."""
        pairs = zip(self.polygons(quads), self.unclipped(quads), strict=True)
        self.own = [np.array(before) for (_, corners), (_, before) in pairs for _ in corners[2:]]
        self.first = first_triangle
        return super().fragments(quads, first_triangle)

    def rasterized(
        self, vertices: Floats, triangle: int, face: int
    ) -> tuple[Ints, Ints, Ints, Ints, list[Floats], Floats]:
        """Of the polygon's pixels, by the triangle's planes."""
        row, column, number, faces, *_ = super().rasterized(vertices, triangle, face)
        own = self.own[triangle - self.first]
        window, w = self.window(own[:, :4]), own[:, 3]
        x, y = (self.snapped(axis) for axis in window)
        edges, _ = self.coverage(x, y, row, column)
        weights = self.weights(window, edges, row, column)
        first = int(np.argmax(w))
        point = [self.by_planes(weights, list(own[:, 4 + k]), list(w), first) for k in range(3)]
        return row, column, number, faces, point, self.face_depth(weights, self.do.divide(own[:, 2], w), w)


VARIANTS: tuple[Variant, ...] = (
    Variant("float64", Policy(float_bits=64), "ieee32"),
    Variant("float32", Policy(), "ieee32"),
    Variant("sums from the right", Policy(backwards=True), "ieee32"),
    Variant("fused multiply-add", Policy(fused=True), "ieee32"),
    Variant("fused, from the right", Policy(fused=True, backwards=True), "ieee32"),
    Variant("matrices multiplied first", Policy(), "ieee32", _CombinedMatrices),
    Variant("positions from the fragment", Policy(), "ieee32", _FromFragment),
    Variant("positions between the ends", Policy(fused=True), "ieee32", _BetweenEnds),
    Variant("lerp a + f (b - a)", Policy(), "ieee32", _ShortLerp),
    Variant("four weighted texels", Policy(), "ieee32", _WeightedTexels),
    Variant("texel positions (u - 0.5/W) W", Policy(), "ieee32", _ScaledTexels),
    Variant("varyings by planes", Policy(), "ieee32", _Planes),
    Variant("normal of crossed tangents", Policy(), "ieee32", _CrossedTangents),
    Variant("reflection without a vector", Policy(), "ieee32", _NoReflectedVector),
    Variant("pow", Policy(intrinsic_power=True), "ieee32"),
    Variant("pow, loose", Policy(intrinsic_power=True, loose=2, seed=3), "vulkan"),
    Variant("patch space from the host", Policy(), "ieee32", _HostPatchSpace),
    Variant("reciprocal division", Policy(reciprocal=True), "vulkan"),
    Variant("quotients off by 2 ULP, seed 1", Policy(loose=2, seed=1), "vulkan"),
    Variant("quotients off by 2 ULP, seed 2", Policy(loose=2, seed=2, fused=True), "vulkan"),
    Variant("8-bit weights, truncated", Policy(weight_bits=8, weight_rounding="down"), "vulkan"),
    Variant("subpixel ties up", Policy(subpixel_rounding="up"), "vulkan"),
    Variant("subpixels truncated", Policy(subpixel_rounding="down"), "vulkan"),
    Variant("4 subpixel bits", Policy(subpixel_bits=4), "gl,subpixel_bits=4", coarse=True),
    Variant(
        "4 subpixel bits, truncated, unsnapped",
        Policy(subpixel_bits=4, subpixel_rounding="down", snapped_varyings=False, weight_bits=8),
        "gl,subpixel_bits=4",
    ),
    Variant(
        "bytes filtered in bytes",
        Policy(filtered_bytes=True, weight_bits=8),
        "gl,filter_result=unorm8",
        coarse=True,
    ),
    Variant("truncated", Policy(truncated=True), "d3d11"),
    Variant("truncated, fused, 8-bit weights", Policy(truncated=True, fused=True, weight_bits=8), "d3d11"),
    Variant("8-bit weights, rounded", Policy(weight_bits=8), "d3d11"),
    Variant("1-ULP jitter, seed 1", Policy(jitter=1, seed=1), "gl"),
    Variant("1-ULP jitter, seed 2", Policy(jitter=1, seed=2, weight_bits=8), "gl"),
    Variant("24-bit depth", Policy(depth_bits=24), "d3d11"),
    Variant("unsnapped varyings", Policy(snapped_varyings=False), "gl"),
    Variant("cut at the borders", Policy(snapped_varyings=False), "gl", CutAtBorders, coarse=True),
    Variant("triangles set up whole", Policy(), "vulkan", WholeTriangles),
    Variant("triangles set up whole, 4 subpixel bits", Policy(subpixel_bits=4), "gl,subpixel_bits=4", WholeTriangles),
    Variant("8-bit colour", Policy(color_bits=8), "gl"),
    Variant("2-ULP jitter, seed 1", Policy(jitter=2, seed=1), "gl"),
    Variant("2-ULP jitter, seed 2", Policy(jitter=2, seed=2, backwards=True), "gl"),
    Variant(
        "everything that gl allows",
        Policy(
            fused=True,
            reciprocal=True,
            weight_bits=8,
            weight_rounding="down",
            subpixel_rounding="up",
            snapped_varyings=False,
            depth_bits=24,
            color_bits=8,
        ),
        "gl",
        _CombinedMatrices,
    ),
)
