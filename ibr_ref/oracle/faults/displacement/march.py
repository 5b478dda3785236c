"""Bugs of the march: rays and linear search."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.port import Port

MARCH = Bugs("march")

# --- Rays ------------------------------------------------------------------------------------------------------------


@MARCH.add("sides not mapped onto the extended plane")
class _Unmapped(Port):
    """A fragment on a side is taken for the end of its ray at h = 0 as it is."""

    def on_ground(self, point: Vector, way: Vector) -> Vector:
        return point[:2]


@MARCH.add("sides mapped inwards")
class _MappedInwards(Port):
    """The mapping onto the extended plane has the wrong sign."""

    def on_ground(self, point: Vector, way: Vector) -> Vector:
        return super().on_ground(point, [-way[0], -way[1], way[2]])


@MARCH.add("start of the ray from h = 0")
class _StartIgnoresHeight(Port):
    """B is C + v/v_h, as if C lay on the base."""

    def on_top(self, point: Vector, way: Vector) -> Vector:
        return super().on_top([point[0], point[1], np.zeros(point[2].shape)], way)


@MARCH.add("parallel lines of sight towards a point")
class _ParallelAsPoint(Port):
    """The direction to an orthographic eye is taken for its position."""

    def rays(self, patch: Patch, point: Vector) -> Rays:
        eye = patch.eye
        below = self.towards([*eye[:3], np.ones(())], point)
        ends = self.on_ground(point, below), self.on_top(point, below)
        one = self.do.widened(self.do.in_lanes(1.0, point[2]), quotients=1, operations=3)
        return Rays([*ends[1], one], [*(a - b for a, b in zip(*ends, strict=True)), -one])


@MARCH.add("rays that go down are kept")
class _AnyDirection(Port):
    """Fragments above the eye are searched, upwards."""

    def goes_up(self, way: Vector) -> Bools:
        return way[2] != 0.0


@MARCH.add("grazing rays discarded", small=True)
class _Grazing(Port):
    """v_h > 0.1, against a division by numbers near zero."""

    def goes_up(self, way: Vector) -> Bools:
        return np.asarray(way[2] > 0.1) if self.params.interval == "paper" else super().goes_up(way)


@MARCH.add("search from behind the eye")
class _BehindEye(Port):
    """In the volume the ray starts at the wall, even where the eye comes first."""

    def eye_comes_first(self, patch: Patch, share: Floats) -> Bools:
        return np.zeros(share.shape, bool)


@MARCH.add("entry through the top only")
class _TopOnly(Port):
    """In the volume the ray starts at h = 1, even where it enters through a side."""

    def entry(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        up = [np.zeros(way[0].shape), np.zeros(way[1].shape), way[2]]
        share = self.share_to_wall(point[2], up[2])
        share = np.where(np.isfinite(share) & ~self.eye_comes_first(patch, share), share, 1.0)
        return [self.multiply_add(d, share, c) for d, c in zip(way, point, strict=True)]


# --- Samples ---------------------------------------------------------------------------------------------------------


@MARCH.add("lattice of K - 1 steps", small=True)
class _OneStepLess(Port):
    """t = k/(K - 1)."""

    def fraction(self, index: Ints | int) -> Floats:
        return self.do.divide(index, float(max(self.last() - 1, 1)))


@MARCH.add("last linear step left out", small=True)
class _LastStepMissing(Port):
    """i runs to N - 1."""

    def linear_steps(self) -> range:
        return range(self.params.linear_steps)


@MARCH.add("first sample left out", small=True)
class _FirstStepMissing(Port):
    """i runs from 1: a is unknown, 0, where the search stops at once."""

    def linear_steps(self) -> range:
        return range(1, self.params.linear_steps + 1)


@MARCH.add("stops a little above the surface", small=True)
class _Tolerant(Port):
    """h < H + 1/1000."""

    def inside(self, h: Floats, height: Floats) -> Bools:
        return h < height + 1e-3


@MARCH.add("stops a little below the surface", small=True)
class _Hesitant(Port):
    """h + 1/4096 < H: a bias of the shadow's kind."""

    def inside(self, h: Floats, height: Floats) -> Bools:
        return h + 2.0**-12 < height


@MARCH.add("no border of the map")
class _NoDomain(Port):
    """Samples outside the map take its border's height."""

    def outside(self, u: Floats, v: Floats) -> Bools:
        return np.zeros(u.shape, bool)


@MARCH.add("no border at u = 0 and v = 0")
class _UpperDomain(Port):
    """Only u > 1 and v > 1 are outside."""

    def outside(self, u: Floats, v: Floats) -> Bools:
        return (u > 1.0) | (v > 1.0)


@MARCH.add("border half a texel inside", small=True)
class _NarrowDomain(Port):
    """The map ends at the centres of its outermost texels (of 256)."""

    def outside(self, u: Floats, v: Floats) -> Bools:
        half = 0.5 / 256.0
        return (u < half) | (u > 1.0 - half) | (v < half) | (v > 1.0 - half)


# --- Fetches ---------------------------------------------------------------------------------------------------------


@MARCH.add("heights in 8 bits", small=True)
class _ByteHeights(Port):
    """The height map is uploaded as bytes."""

    def uploaded_heights(self, heights: Floats) -> Floats:
        return self.do.number(np.rint(heights * 255.0) / 255.0)


@MARCH.add("heights half a texel off")
class _HalfTexel(Port):
    """Heights are fetched at u + 1/(2W), v + 1/(2H)."""

    def height_at(self, patch: Patch, u: Floats, v: Floats) -> Floats:
        rows, columns = patch.heights.shape
        return super().height_at(patch, self.do.add(u, 0.5 / columns), self.do.add(v, 0.5 / rows))


@MARCH.add("texels spread over size - 1")
class _EndToEnd(Port):
    """The outermost texels' centres lie on the border: x = u (W - 1)."""

    def texel_position(self, coordinate: Floats, size: int) -> Floats:
        return self.do.multiply(coordinate, float(size - 1))


@MARCH.add("nearest heights")
class _NearestHeights(Port):
    """The height map is not filtered."""

    def height_at(self, patch: Patch, u: Floats, v: Floats) -> Floats:
        rows, columns = patch.heights.shape
        row = self.wrapped(self.do.whole(v * rows), rows, patch.repeat)
        return self.do.number(patch.heights[row, self.wrapped(self.do.whole(u * columns), columns, patch.repeat)])


@MARCH.add("weights swapped")
class _SwappedWeights(Port):
    """Bilinear with f_x down and f_y across."""

    def bilinear(self, texels: tuple[Floats, Floats, Floats, Floats], fx: Floats, fy: Floats) -> Floats:
        return super().bilinear(texels, fy, fx)


@MARCH.add("rows of the heights upside down")
class _FlippedHeights(Port):
    """Row 0 of the height map lies at v = 1."""

    def height_at(self, patch: Patch, u: Floats, v: Floats) -> Floats:
        return super().height_at(patch, u, self.do.subtract(1.0, v))


@MARCH.add("s for t")
class _SwappedCoordinates(Port):
    """The height map is fetched at (v, u)."""

    def height_at(self, patch: Patch, u: Floats, v: Floats) -> Floats:
        return super().height_at(patch, v, u)


@MARCH.add("heights wrap at the border", small=True)
class _WrappedHeights(Port):
    """The height map is repeated although it ends at its border."""

    def height_at(self, patch: Patch, u: Floats, v: Floats) -> Floats:
        return self.fetch(patch.heights, u, v, True)


@MARCH.add("repeated heights clamped")
class _ClampedHeights(Port):
    """The height map is clamped although it is repeated."""

    def height_at(self, patch: Patch, u: Floats, v: Floats) -> Floats:
        return self.fetch(patch.heights, u, v, False)
