"""The march: where the line of sight through a fragment first lies below the height map (sections 3.1 and 4)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch, Vector
from ibr_ref.oracle.programs.displacement.raster import Fragments
from ibr_ref.oracle.programs.displacement.texture import FILTER, TextureUnit
from ibr_ref.oracle.programs.displacement.vertex import BASE, Vertex


@dataclass(frozen=True)
class Rays:
    """Stretches of lines of sight in patch space, p(t) = start + way t, t in [0, 1]."""

    start: Vector
    way: Vector

    def some(self, which: Ints | Bools) -> Rays:
        """Those chosen."""
        return Rays([x[which] for x in self.start], [x[which] for x in self.way])


@dataclass(frozen=True)
class Hits:
    """What the march found; everything (F,), (u, v, h) NaN where the fragment is discarded."""

    linear_index: Ints
    hit_index: Ints
    point: Vector
    height_before: Floats
    steep: Bools


class March(Vertex, TextureUnit):
    """Linear search, binary search, steepness."""

    def march(self, patch: Patch, fragments: Fragments) -> Hits:
        """The hits of one patch's fragments."""
        usable = np.flatnonzero(self.goes_up(self.towards(patch.eye, fragments.point)))
        point = [x[usable] for x in fragments.point]
        face = fragments.face[usable]
        rays = self.rays(patch, point)
        linear = self.linear_search(patch, rays)
        index = self.binary_search(patch, rays, linear)
        hit = self.hit_point(patch, rays, index)
        stopped = (linear >= 0) & self.counts_as_hit(index)
        ground = np.asarray(~stopped & self.over_polygon(face, point))
        index, linear = np.where(ground, self.last(), index), np.where(stopped, linear, -1)
        bottom = self.position(rays, np.full(len(index), self.last()))
        hit = [np.where(ground, b, x) for b, x in zip([*bottom[:2], np.zeros(len(index))], hit, strict=True)]
        kept = np.asarray((stopped | ground) & self.behind_near_plane(patch, hit))
        some = np.flatnonzero(stopped & kept)
        before = self.height_before(patch, rays.some(some), linear[some])
        steep = np.zeros(len(index), np.bool_)
        steep[some] = self.is_steep(patch, [x[some] for x in hit], before, linear[some])
        count, spread, shown = len(fragments.face), self.do.spread, np.flatnonzero(kept)
        return Hits(
            spread(self.written_linear_index(linear[shown]), usable[shown], count, -1),
            spread(index[shown], usable[shown], count, -1),
            [spread(x[shown], usable[shown], count, np.nan) for x in hit],
            spread(before, usable[some], count, 0.0),
            spread(steep, usable, count, False),
        )

    # --- Rays --------------------------------------------------------------------------------------------------------

    def goes_up(self, way: Vector) -> Bools:
        """Whether the way to the eye leads up, as the paper's interval needs it."""
        return way[2] > 0.0 if self.params.interval == "paper" else np.ones(way[2].shape, bool)

    def rays(self, patch: Patch, point: Vector) -> Rays:
        """The stretch that is searched for each fragment at a point C."""
        way = self.towards(patch.eye, point)
        if self.params.interval == "volume":
            start = self.entry(patch, point, way)
            return Rays(start, [self.do.subtract(c, s) for c, s in zip(point, start, strict=True)])
        below, above = self.on_ground(point, way), self.on_top(point, way)
        across = [self.do.subtract(a, b) for a, b in zip(below, above, strict=True)]
        # Where h = 1 is computed as C_h + v_h ((1 - C_h)/v_h), the errors of C_h and v_h cancel: four roundings remain.
        one = self.do.widened(self.do.in_lanes(1.0, point[2]), quotients=1, operations=3)
        top, ground = self.do.named("top", one), self.do.named("ground", self.do.subtract(1.0, one))
        return Rays([*above, top], [*across, self.do.subtract(ground, top)])

    def on_ground(self, point: Vector, way: Vector) -> Vector:
        """(u, v) of A, where the line of sight meets h = 0: the paper's mapping onto the virtual extended plane."""
        share = self.do.divide(point[2], way[2])
        return [self.multiply_add(-way[k], share, point[k]) for k in (0, 1)]

    def on_top(self, point: Vector, way: Vector) -> Vector:
        """(u, v) of B, where it meets h = 1."""
        share = self.do.divide(self.do.subtract(1.0, point[2]), way[2])
        return [self.multiply_add(way[k], share, point[k]) for k in (0, 1)]

    def entry(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        """Where the line of sight enters the unit cube, or the eye inside it."""
        shares = [self.share_to_wall(x, d) for x, d in zip(point, way, strict=True)]
        axis, share = self.do.first_least(shares), reduce(self.do.least, shares)
        eye_inside = self.eye_comes_first(patch, share)
        start = []
        reach = np.where(np.isfinite(share), share, 0.0)
        for k in range(3):
            reached = self.multiply_add(way[k], reach, point[k])
            wall = np.where(way[k] > 0.0, 1.0, 0.0)
            start.append(np.where(eye_inside, patch.eye[k], np.where(axis == k, wall, reached)))
        return start

    def share_to_wall(self, x: Floats, way: Floats) -> Floats:
        """How much of the way it takes from a coordinate inside [0, 1] to the border ahead; infinite where it rests."""
        ahead, rests = np.asarray(way > 0.0), np.asarray(way == 0.0)
        left = self.do.subtract(np.where(ahead, 1.0, 0.0), x)
        return np.where(rests, np.inf, self.do.divide(left, np.where(rests, 1.0, way)))

    def eye_comes_first(self, patch: Patch, share: Floats) -> Bools:
        """Whether the way ends in the eye before it leaves the cube."""
        return (share >= 1.0) & bool(patch.eye[3] == 1.0)

    def position(self, rays: Rays, index: Ints | int) -> Vector:
        """p(t) at a lattice index: B + (A - B) t, or B (1 - t) + A t."""
        t = self.fraction(index)
        point = [self.multiply_add(way, t, start) for start, way in zip(rays.start, rays.way, strict=True)]
        return self.do.either(point, lambda: self.between_ends(rays, t))

    def between_ends(self, rays: Rays, t: Floats) -> Vector:
        """B (1 - t) + A t."""
        ends = [self.do.add(start, way) for start, way in zip(rays.start, rays.way, strict=True)]
        return [self.do.lerp(start, end, t) for start, end in zip(rays.start, ends, strict=True)]

    def fraction(self, index: Ints | int) -> Floats:
        """t = k/K, or k times a rounded 1/K."""
        return self.do.widened(self.do.divide(index, float(self.last())), operations=1)

    def last(self) -> int:
        """K = N 2^M."""
        return int(self.params.linear_steps << self.params.binary_steps)

    # --- Search ------------------------------------------------------------------------------------------------------

    def linear_steps(self) -> range:
        """i."""
        return range(self.params.linear_steps + 1)

    def linear_search(self, patch: Patch, rays: Rays) -> Ints:
        """The first step inside, -1: none."""
        count = len(rays.start[0])
        found, searching = np.full(count, -1), np.arange(count)
        for i in self.linear_steps():
            if not self.may_stop(i):
                continue
            stops = self.stops(patch, rays.some(searching), i << self.params.binary_steps)
            found[searching[stops]] = i
            searching = searching[~stops]
        return found

    def stops(self, patch: Patch, rays: Rays, index: Ints | int) -> Bools:
        """Whether the samples at lattice indices are inside the solid."""
        point = self.position(rays, index)
        result = np.zeros(len(point[2]), np.bool_)
        near = self.near_surface(patch, point)
        if near is None:
            height, empty = self.sample(patch, point)
            return np.asarray(self.inside(point[2], height) & ~empty)
        point = [x[near] for x in point]
        height, empty = self.sample(patch, point)
        result[near] = self.inside(point[2], height) & ~empty
        return result

    def near_surface(self, patch: Patch, point: Vector) -> Ints | None:
        """Samples that are not certainly above all texels around them, where that is sooner known; None: all."""
        if not (self.do.bounded and self.right("sample", "inside", "height_at", *FILTER)):
            return None
        return self.do.below_highest(patch.heights, point[0], point[1], self.above_floor(point[2]), patch.repeat)

    def height_before(self, patch: Patch, rays: Rays, linear: Ints) -> Floats:
        """a: the height map one linear step before a stop, 0 where that is none of the search's."""
        known = np.flatnonzero(np.isin(linear - 1, self.linear_steps()))
        point = self.position(rays.some(known), (linear[known] - 1) << self.params.binary_steps)
        height = self.height_remembered(*self.sample(patch, point))
        return self.do.replaced(self.do.in_lanes(0.0, rays.start[0]), known, height)

    def may_stop(self, step: int) -> bool:
        """Not at h = 1, where nothing is higher; in the volume the first sample may lie anywhere."""
        return step > 0 or self.params.interval == "volume"

    def sample(self, patch: Patch, point: Vector) -> tuple[Floats, Bools]:
        """H at samples, and which are empty."""
        return self.height_at(patch, point[0], point[1]), self.empty(patch, point)

    def empty(self, patch: Patch, point: Vector) -> Bools:
        """Whether the sample lies outside the map."""
        u, v, _ = point
        if patch.repeat or self.params.interval == "volume":
            return np.zeros(u.shape, bool)
        return self.outside(u, v)

    def outside(self, u: Floats, v: Floats) -> Bools:
        """Outside the unit square."""
        return (u < 0.0) | (u > 1.0) | (v < 0.0) | (v > 1.0)

    def inside(self, h: Floats, height: Floats) -> Bools:
        """Whether a sample is below the surface: strictly."""
        return h < height

    def height_remembered(self, height: Floats, empty: Bools) -> Floats:
        """a, if the next step stops."""
        return np.where(empty, 0.0, height)

    def bracket(self, step: Ints) -> tuple[Ints, Ints]:
        """Lattice indices before and at a linear step."""
        return (step - 1) << self.params.binary_steps, step << self.params.binary_steps

    def binary_steps(self) -> range:
        """M halvings."""
        return range(self.params.binary_steps)

    def binary_search(self, patch: Patch, rays: Rays, linear: Ints) -> Ints:
        """The hit's lattice index for each linear step; 0 for step 0, -1 for none."""
        refined = np.flatnonzero(linear > 0)
        low, high = self.bracket(linear[refined])
        rays = rays.some(refined)
        for _ in self.binary_steps():
            middle = (low + high) // 2
            low, high = self.halved(low, high, middle, self.stops(patch, rays, middle))
        result = np.minimum(linear, 0)
        result[refined] = self.found(low, high)
        return result

    def halved(self, low: Ints, high: Ints, middle: Ints, inside: Bools) -> tuple[Ints, Ints]:
        """The half of the bracket that the surface lies in."""
        return np.where(inside, low, middle), np.where(inside, middle, high)

    def found(self, low: Ints, high: Ints) -> Ints:
        """The hit: the first point known to be inside."""
        return high

    # --- Outcome -----------------------------------------------------------------------------------------------------

    def hit_point(self, patch: Patch, rays: Rays, index: Ints) -> Vector:
        """(u, v, h) of the hit: on the lattice."""
        return self.position(rays, index)

    def counts_as_hit(self, index: Ints) -> Bools:
        """A hit at the end of the ray is none."""
        return index < self.last()

    def over_polygon(self, face: Ints, point: Vector) -> Bools:
        """Whether the fragment itself lies on the polygon: on the base, or on the lower edge of a side."""
        return ((face == BASE) | (point[2] == 0.0)) & ~self.outside(point[0], point[1])

    def behind_near_plane(self, patch: Patch, hit: Vector) -> Bools:
        """Whether the hit can be seen."""
        return self.projected(patch, hit)[2] >= 0.0

    def is_steep(self, patch: Patch, hit: Vector, before: Floats, linear: Ints) -> Bools:
        """Whether the hit is on a wall: b - a > delta (section 4.2)."""
        return self.do.subtract(hit[2], before) > self.do.number(self.params.steep_threshold)

    def written_linear_index(self, linear: Ints) -> Ints:
        """As it is handed in."""
        return linear
