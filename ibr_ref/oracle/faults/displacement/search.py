"""Bugs of the march: binary search, outcome, steepness."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.port import Port

SEARCH = Bugs("march")

# --- Binary search ---------------------------------------------------------------------------------------------------


@SEARCH.add("one halving left out", small=True)
class _HalvingMissing(Port):
    """The binary search ends after M - 1 halvings."""

    def binary_steps(self) -> range:
        return range(self.params.binary_steps - 1)


@SEARCH.add("last point outside")
class _LastOutside(Port):
    """The hit is the lower end of the bracket."""

    def found(self, low: Ints, high: Ints) -> Ints:
        return low


@SEARCH.add("bracket a step early")
class _EarlyBracket(Port):
    """The bracket is [i - 2, i - 1]."""

    def bracket(self, step: Ints) -> tuple[Ints, Ints]:
        return super().bracket(np.maximum(step - 1, 1))


@SEARCH.add("bracket a step late")
class _LateBracket(Port):
    """The bracket is [i, i + 1]."""

    def bracket(self, step: Ints) -> tuple[Ints, Ints]:
        return super().bracket(np.minimum(step + 1, self.params.linear_steps))


@SEARCH.add("halves swapped")
class _SwappedHalves(Port):
    """The binary search goes on in the half that the surface is not in."""

    def halved(self, low: Ints, high: Ints, middle: Ints, inside: Bools) -> tuple[Ints, Ints]:
        return super().halved(low, high, middle, ~inside)


@SEARCH.add("hit half a lattice step early", small=True)
class _MiddleOfLast(Port):
    """(u, v, h) is that of the middle of the last bracket."""

    def hit_point(self, patch: Patch, rays: Rays, index: Ints) -> Vector:
        t = self.do.divide(np.maximum(index - 0.5, 0.0), float(self.last()))
        return [self.multiply_add(way, t, start) for start, way in zip(rays.start, rays.way, strict=True)]


@SEARCH.add("height of the hit from the map", small=True)
class _HeightOfMap(Port):
    """h of the hit is H(u, v) instead of the ray's height."""

    def hit_point(self, patch: Patch, rays: Rays, index: Ints) -> Vector:
        u, v, h = super().hit_point(patch, rays, index)
        height = self.height_at(patch, u, v)
        return [u, v, np.where(self.inside(h, height), height, h)]


@SEARCH.add("hit in half precision", small=True)
class _HalfHit(Port):
    """(u, v, h) goes through a 16-bit buffer."""

    def hit_point(self, patch: Patch, rays: Rays, index: Ints) -> Vector:
        return [half(x) for x in super().hit_point(patch, rays, index)]


# --- Outcome ---------------------------------------------------------------------------------------------------------


@SEARCH.add("no ground")
class _NoGround(Port):
    """A search that stops nowhere is discarded over the polygon as well."""

    def over_polygon(self, face: Ints, point: Vector) -> Bools:
        return np.zeros(face.shape, bool)


@SEARCH.add("ground everywhere")
class _EndlessGround(Port):
    """A search that stops nowhere hits the polygon's plane, beside the polygon too."""

    def over_polygon(self, face: Ints, point: Vector) -> Bools:
        return np.ones(face.shape, bool)


@SEARCH.add("hits at h = 0 are hits", small=True, hidden="the hit is the same point of the polygon")
class _HitsAtBottom(Port):
    """A hit at k = K keeps its linear index."""

    def counts_as_hit(self, index: Ints) -> Bools:
        return np.ones(index.shape, bool)


@SEARCH.add("hits in front of the near plane")
class _BeforeNear(Port):
    """Hits in front of the near plane, or behind the eye, are shown."""

    def behind_near_plane(self, patch: Patch, hit: Vector) -> Bools:
        return np.ones(hit[0].shape, bool)


@SEARCH.add("linear index from 0", hidden="the step's number has no part in the colour")
class _IndexFromZero(Port):
    """The first step below the top is numbered 0."""

    def written_linear_index(self, linear: Ints) -> Ints:
        return np.maximum(linear - 1, -1)


# --- Steepness -------------------------------------------------------------------------------------------------------


@SEARCH.add("delta on the height at the hit")
class _SteepAtHit(Port):
    """b - a with a = H at the hit itself: never steep."""

    def is_steep(self, patch: Patch, hit: Vector, before: Floats, linear: Ints) -> Bools:
        return super().is_steep(patch, hit, self.height_at(patch, hit[0], hit[1]), linear)


@SEARCH.add("delta on the height of the step", small=True)
class _SteepByStep(Port):
    """b is the ray's height at the linear step, not at the hit."""

    def is_steep(self, patch: Patch, hit: Vector, before: Floats, linear: Ints) -> Bools:
        h = self.do.subtract(1.0, self.fraction(linear << self.params.binary_steps))
        return super().is_steep(patch, [hit[0], hit[1], h], before, linear)


@SEARCH.add("delta on the size of the difference")
class _SteepBothWays(Port):
    """|b - a| > delta: also where the map was higher before."""

    def is_steep(self, patch: Patch, hit: Vector, before: Floats, linear: Ints) -> Bools:
        return super().is_steep(patch, [np.abs(hit[2] - before)] * 3, np.zeros(before.shape), linear)


@SEARCH.add("delta on a - b")
class _SteepBackwards(Port):
    """a - b > delta: the height before minus the hit's, steep where the map was higher before."""

    def is_steep(self, patch: Patch, hit: Vector, before: Floats, linear: Ints) -> Bools:
        return super().is_steep(patch, [before] * 3, hit[2], linear)


@SEARCH.add("delta in world units")
class _SteepInWorld(Port):
    """s (b - a) > delta."""

    def is_steep(self, patch: Patch, hit: Vector, before: Floats, linear: Ints) -> Bools:
        scaled = [self.do.multiply(x, patch.scale) for x in (hit[2], before)]
        return super().is_steep(patch, [scaled[0]] * 3, scaled[1], linear)


@SEARCH.add("delta off by 5 %", small=True)
class _Threshold(Port):
    """delta is 1.05 times what it should be."""

    def is_steep(self, patch: Patch, hit: Vector, before: Floats, linear: Ints) -> Bools:
        return super().is_steep(patch, [x / 1.05 for x in hit], before / 1.05, linear)


@SEARCH.add("border's height before the map", small=True)
class _BorderRemembered(Port):
    """A sample outside the map gives a the height of the border."""

    def height_remembered(self, height: Floats, empty: Bools) -> Floats:
        return height


@SEARCH.add("height before in 8 bits", small=True)
class _ByteBefore(Port):
    """a goes through an 8-bit channel."""

    def height_remembered(self, height: Floats, empty: Bools) -> Floats:
        return np.rint(super().height_remembered(height, empty) * 255.0) / 255.0
