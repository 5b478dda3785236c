"""Where a ray meets the bilinear surface between two depths of one cell."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Sunken

Met = list[tuple[Ints, Floats]]
"""Rows, and the depths of their hits."""


class Leaf(Sunken):
    """The quadratic through three samples: exact, as a bilinear surface is one along a line."""

    def patch_hit(self, patch: Patch, rays: Rays, first: Floats, out: Floats) -> tuple[Ints, Met]:
        """The rows that may leave without a hit, and those that may meet the surface."""
        middle = self.do.multiply(self.do.add(first, out), 0.5)
        start, half, end = (
            self.do.named("overlap", self.below_surface(patch, rays, depth)) for depth in (first, middle, out)
        )
        bend = self.do.multiply(self.do.subtract(self.do.add(end, start), self.do.multiply(half, 2.0)), 2.0)
        rise = self.do.subtract(self.do.subtract(end, start), bend)
        inside, above = self.do.parted(start > 0.0)
        comes, passes = self.do.parted(self.comes_up(start, rise, bend, end))
        met = [(np.flatnonzero(inside), first[inside])]
        for way, slope in zip(self.do.parted(rise >= 0.0), (1, -1), strict=True):
            rows = np.flatnonzero(above & comes & way)
            share = np.clip(self.crossing(start[rows], rise[rows], bend[rows], slope), 0.0, 1.0)
            depth = self.do.add(first[rows], self.do.multiply(share, self.do.subtract(out[rows], first[rows])))
            depth = self.do.settled(self.do.between(depth, first[rows], out[rows]), first[rows], out[rows])
            met.append((rows, depth))
        return np.flatnonzero(above & passes), met

    def below_surface(self, patch: Patch, rays: Rays, depth: Floats) -> Floats:
        """d - D."""
        return self.overlap(depth, self.height_at(patch, *self.below(rays, depth)))

    def comes_up(self, start: Floats, rise: Floats, bend: Floats, end: Floats) -> Bools:
        """Whether bend s^2 + rise s + start becomes positive between 0 and 1: at the end, or at an apex before it."""
        apex = (bend < 0.0) & (rise > 0.0) & (rise < self.do.multiply(bend, -2.0))
        apex = apex & (self.discriminant(start, rise, bend) > 0.0)
        return (end > 0.0) | apex

    def discriminant(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        """rise^2 - 4 bend start."""
        return self.do.dot([rise, self.do.multiply(bend, -4.0)], [rise, start])

    def crossing(self, start: Floats, rise: Floats, bend: Floats, slope: int) -> Floats:
        """The root with a rising slope, so that nothing cancels; slope: the sign of `rise`, 1 where it is 0."""
        root = self.do.root(self.do.greatest(self.discriminant(start, rise, bend), 0.0))
        if slope > 0:
            return self.do.divide(self.do.multiply(start, -2.0), self.do.add(rise, root))
        return self.do.divide(self.do.subtract(root, rise), self.do.multiply(bend, 2.0))
