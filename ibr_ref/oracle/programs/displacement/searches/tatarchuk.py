"""Parallax occlusion mapping (Tatarchuk 2005): as many steps as the angle asks for, then one secant."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.angled import Stepped
from ibr_ref.oracle.programs.displacement.searches.below import Found


class Tatarchuk(Stepped, search="tatarchuk"):
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
        step, one = self.last_step(count), self.do.in_lanes(1.0, rays.start[0])
        last = self.do.in_lanes(self.first_height(), rays.start[0])
        last_ray, depth, before = one, one, self.do.in_lanes(0.0, rays.start[0])
        for sample in self.samples(patch, rays, count, first=1):
            rows, ends = sample.rows, sample.ends
            there = rows[ends]
            step[there] = sample.step
            found = self.crossing(sample.level[ends], sample.height[ends], last_ray[there], last[there])
            depth = self.kept(depth, there, self.do.subtract(1.0, found))
            before = self.kept(before, there, last[there])
            last, last_ray = self.kept(last, rows, sample.height), self.kept(last_ray, rows, sample.level)
        return Found(step, depth, before)

    def last_step(self, count: Floats) -> Ints:
        """What is written where nothing stops."""
        return np.asarray(count, np.int64)

    def level(self, fraction: Floats) -> Floats:
        """Height of the ray, 1 - k/n."""
        return self.do.subtract(1.0, fraction)

    def depth_of(self, level: Floats) -> Floats:
        """1 - (1 - k/n)."""
        return self.do.subtract(1.0, level)

    def ends(self, level: Floats, height: Floats) -> Bools:
        """H > 1 - k/n."""
        return height > level

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
