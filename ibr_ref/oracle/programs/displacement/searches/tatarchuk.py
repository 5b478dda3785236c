"""Parallax occlusion mapping (Tatarchuk 2005): as many steps as the angle asks for, then one secant."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.angled import Angled
from ibr_ref.oracle.programs.displacement.searches.below import Found


class Tatarchuk(Angled):
    """The first of n samples above the ray, and the crossing with the line from the one before."""

    def most_steps(self) -> int:
        """Where the view is horizontal."""
        return int(self.params.max_steps)

    def count(self, patch: Patch, rays: Rays) -> Floats:
        """trunc(n_max + (n_min - n_max) w_z)."""
        mixed = self.mixed(float(self.params.min_steps), float(self.params.max_steps), self.cosine(patch, rays))
        return np.asarray(self.do.whole(mixed))

    def first_height(self) -> float:
        """H_0: the surface is taken to start at the polygon."""
        return 1.0

    def descend(self, patch: Patch, rays: Rays) -> Found:
        """Sample by sample; without a stop the hit is at depth 1."""
        count = self.count(patch, rays)
        step, searching = self.last_step(count), np.arange(len(count))
        one = self.do.in_lanes(1.0, rays.start[0])
        last = self.do.in_lanes(self.first_height(), rays.start[0])
        last_ray, depth, before = one, one, self.do.in_lanes(0.0, rays.start[0])
        for k in range(1, self.most_steps() + 1):
            searching = searching[np.asarray(count[searching] >= k)]
            if not len(searching):
                break
            here = rays.some(searching)
            ray = self.do.subtract(1.0, self.fraction_of(k, count[searching], here))
            u, v = self.below(here, self.do.subtract(1.0, ray))
            on_map = np.asarray(self.on_map(patch, [u, v]))
            searching, u, v, ray = searching[on_map], u[on_map], v[on_map], ray[on_map]
            height = self.height_at(patch, u, v)
            stops = np.asarray(self.above_ray(height, ray))
            there = searching[stops]
            step[there] = k
            found = self.crossing(ray[stops], height[stops], last_ray[there], last[there])
            depth = self.kept(depth, there, self.do.subtract(1.0, found))
            before = self.kept(before, there, last[there])
            last, last_ray = self.kept(last, searching, height), self.kept(last_ray, searching, ray)
            searching = searching[~stops]
        return Found(step, depth, before)

    def last_step(self, count: Floats) -> Ints:
        """What is written where nothing stops."""
        return np.asarray(count, np.int64)

    def above_ray(self, height: Floats, ray: Floats) -> Bools:
        """H > 1 - k/n."""
        return height > ray

    def crossing(self, ray: Floats, height: Floats, ray_before: Floats, height_before: Floats) -> Floats:
        """Height at which the ray crosses the line between two samples: between the two."""
        under = self.do.named("under", self.do.subtract(height, ray))
        over = self.do.named("over", self.do.subtract(ray_before, height_before))
        whole = self.do.add(over, under)
        mixed = self.do.divide(self.do.dot([ray, ray_before], [over, under]), whole)
        found = self.do.either(
            mixed, lambda: self.multiply_add(self.do.subtract(ray_before, ray), self.do.divide(under, whole), ray)
        )
        least, most = (self.do.widened(x, quotients=1, operations=4) for x in (ray, ray_before))
        return self.do.between(found, least, most)
