"""Percentage-closer soft shadows: one map for the whole light, asked for blockers, and then as wide as the penumbra."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Self

import numpy as np

from ibr_ref.array_types import Floats as Array
from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.lights import Matrix
from ibr_ref.oracle.programs.shadows.maps import Maps
from ibr_ref.oracle.programs.shadows.project import Project
from ibr_ref.oracle.programs.shadows.sampler import Sampler
from ibr_ref.shadows import parallel
from ibr_ref.shadows.light_map import map_of
from ibr_ref.shadows.percentage_closer import on_map

SOFT = "pcss"


class Soft(Maps, Project):
    """Method "pcss"."""

    @property
    def soft(self) -> bool:
        """Whether one map is softened."""
        return bool(self.params.method == SOFT)

    def on(self, do: Any) -> Self:
        """On another arithmetic: a device's, or bounds of what devices make of it."""
        super().on(do)
        if self.soft:
            frame, window = map_of(self.scene)
            self.soft_view, self.light_projection = frame.view_from_world, parallel.clip_from_view(window)
            self.planes, self.nearest = parallel.planes(window), window.near
            counts = self.params.search_points, self.params.filter_points
            self.search_points, self.filter_points = (on_map(frame, window, count) for count in counts)
        return self

    # --- The map -----------------------------------------------------------------------------------------------------

    def soft_map(self) -> Floats:
        """(S, S) window depths of the caster, from the light's centre at right angles to its plane."""
        return self.caster_map(self.direct_raster(self.do), self.soft_clip())

    def soft_clip(self) -> Vector:
        """Of the caster where it is."""
        return self.caster_clip(self.offset, self.do.matrix(self.soft_view))

    def projecting_view(self, place: Floats) -> Matrix:
        """Of the map."""
        return self.do.matrix(self.soft_view) if self.soft else super().projecting_view(place)

    def coordinates(self, world: Vector, place: Floats) -> Vector:
        """s, t, r and q_w; r is the distance from the light's plane."""
        if not self.soft:
            return super().coordinates(world, place)
        q = self.texture_coordinates(world, place)
        s, t, _ = self.divided(q)
        return [s, t, self.do.add(q[3], 0.0), q[3]]

    def exempt(self, casts: Bools) -> Bools:
        """The caster's own fragments are lit."""
        return casts if self.soft else super().exempt(casts)

    def distance(self, depth: Floats) -> Floats:
        """Of a window depth from the light's plane."""
        do, (n, f) = self.do, self.planes
        below = do.subtract(do.number(f), do.multiply(depth, do.number(f - n)))
        h = do.divide(do.number(n * f), below)
        return do.either(h, lambda: do.divide(n, do.subtract(1.0, do.multiply(depth, do.number((f - n) / f)))))

    def there(self, depth: Floats) -> Bools:
        """Whether a texel is not empty."""
        return depth < 1.0

    # --- What it says ------------------------------------------------------------------------------------------------

    def shadowed(self, image: Floats, at: Vector, casts: Bools) -> Floats:
        """(N,) what the map says at s, t, r and q_w."""
        return self.softened(image, at, casts)[2] if self.soft else super().shadowed(image, at, casts)

    def softened(self, image: Floats, at: Vector, casts: Bools) -> list[Floats]:
        """Three (N,): blocker, penumbra and shadow; 0 where it is lit."""
        place = self.receiving(at, casts)
        b = self.blocker(image, [x[place] for x in at[:3]])
        some = np.flatnonzero(b > 0.0)
        w = self.penumbra(b[some], at[2][place[some]])
        shadow = self.percentage(image, [x[place[some]] for x in at[:3]], w)
        where = place[some]
        return [self.do.spread(x, where, len(casts), 0.0) for x in (b[some], w, shadow)]

    def receiving(self, at: Vector, casts: Bools) -> Any:
        """Which fragments are looked at."""
        s, t, r = at[:3]
        beyond = (r > self.do.number(self.nearest)) & self.in_map(s, t)
        return np.flatnonzero(np.asarray(beyond) & ~np.asarray(self.exempt(casts)))

    def biased_distance(self, r: Floats) -> Floats:
        """What is compared with the map's distances."""
        here = self.do.subtract(r, self.do.number(self.params.bias))
        return self.do.widened(here, operations=1) if self.params.bias else here

    def search_scale(self, r: Floats) -> Floats:
        """Of the light's points on the map, at the caster's nearest distance."""
        return self.penumbra(self.do.number(self.nearest), r)

    def looked_up(self, at: Vector, points: Array, scale: Floats) -> list[Vector]:
        """For each of the light's points its place (s, t) on the map."""
        given = self.do.matrix(points)
        return [[self.do.dot([x, p], [1.0, scale]) for x, p in zip(at, point, strict=True)] for point in given]

    def blocker(self, image: Floats, at: Vector) -> Floats:
        """(N,) the mean distance of blockers; 0 without any."""
        s, t, r = at
        here, sampler = self.search_distance(r), self.shadow_sampler(self.do)
        found, counts = [], []
        for u, v in self.looked_up([s, t], self.search_points, self.search_scale(r)):
            depth = self.do.in_lanes(sampler.nearest(image, u, v), r)
            distance = self.distance(depth)
            blocks = np.asarray(self.in_map(u, v) & self.there(depth) & self.nearer(distance, here))
            found.append(np.where(blocks, self.held(depth, distance), 0.0))
            counts.append(blocks)
        return self.mean_of_blockers(found, counts)

    def search_distance(self, r: Floats) -> Floats:
        """What blockers are nearer than."""
        return self.biased_distance(r)

    def held(self, depth: Floats, distance: Floats) -> Floats:
        """What is averaged of a blocker."""
        return distance

    def mean_of_blockers(self, found: Sequence[Floats], counts: Sequence[Bools]) -> Floats:
        """(N,)."""
        count = np.sum(np.stack(counts), axis=0).astype(np.float64)
        mean = self.do.divide(self.do.sum(list(found)), np.maximum(count, 1.0))
        return np.where(count > 0.0, mean, 0.0)

    def nearer(self, distance: Floats, here: Floats) -> Bools:
        """Whether what the map holds is nearer to the light."""
        return distance < here

    def penumbra(self, b: Floats, r: Floats) -> Floats:
        """1/b - 1/r, or (r - b)/(b r)."""
        do = self.do
        w = do.subtract(do.divide(1.0, b), do.divide(1.0, r))
        if not self.right("penumbra"):
            return w
        return do.either(
            w,
            lambda: do.divide(do.subtract(r, b), do.multiply(b, r)),
            lambda: do.divide(do.divide(do.subtract(r, b), b), r),
        )

    def percentage(self, image: Floats, at: Vector, scale: Floats) -> Floats:
        """(N,) the mean of the comparisons, 0 lit to 1."""
        s, t, r = at
        places = self.looked_up([s, t], self.filter_points, scale)
        return self.mean_of_comparisons(image, places, self.biased_distance(r))

    def mean_of_comparisons(self, image: Floats, places: Sequence[Vector], here: Floats) -> Floats:
        """(N,) of all places (s, t) on the map."""
        found, sampler = [], self.shadow_sampler(self.do)
        for u, v in places:
            mixed = self.of_point(sampler, image, u, v, here)
            found.append(np.where(np.asarray(self.in_map(u, v)), mixed, 0.0))
        return self.do.divide(self.do.sum(found), float(len(found)))

    def of_point(self, sampler: Sampler, image: Floats, u: Floats, v: Floats, here: Floats) -> Floats:
        """The mix of four comparisons."""
        texels, fx, fy = sampler.taps(image, u, v)
        return self.do.of_bytes(sampler.mix([self.asked(texel, here) for texel in texels], fx, fy))

    def asked(self, depth: Floats, here: Floats) -> Floats:
        """1 where a texel is nearer to the light."""
        depth = self.do.in_lanes(depth, here)
        return np.where(np.asarray(self.there(depth) & self.nearer(self.distance(depth), here)), 1.0, 0.0)
