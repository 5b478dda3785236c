"""Self-shadow: samples of the height map on the way from a hit to the light."""

from __future__ import annotations

from functools import reduce

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import March


class SelfShadow(March):
    """Whether hits see the light."""

    def lit(self, patch: Patch, hit: Vector) -> Bools:
        """Not in shadow; without samples everything is lit."""
        if self.params.shadow_steps == 0:
            return np.ones(hit[0].shape, bool)
        below = self.light_below_horizon(self.do.in_lanes(patch.light[2], hit[0]))
        if self.do.surely(below):
            return np.zeros(hit[0].shape, bool)
        way = self.towards(patch.light, hit)
        stretch = self.stretch(patch, hit, way)
        shadowed = np.zeros(hit[0].shape, bool)
        for j in self.shadow_samples():
            share = self.do.multiply(stretch, self.shadow_fraction(j))
            u, v, h = (self.multiply_add(d, share, x) for x, d in zip(hit, way, strict=True))
            shadowed = shadowed | self.in_shadow(patch, h, self.height_at(patch, u, v))
        return (~shadowed | (stretch <= 0.0)) & ~below

    def light_below_horizon(self, height: Floats) -> Bools:
        """Below the polygon's plane, or in it."""
        return height <= 0.0

    def stretch(self, patch: Patch, hit: Vector, way: Vector) -> Floats:
        """How much of the way is searched: to the border of the cube (of a repeated map: to the top), or to the light."""
        axes = (2,) if patch.repeat else (0, 1, 2)
        at = [hit[0], hit[1], self.above_floor(hit[2])]
        shares = [self.share_up(at[k], way[k]) if patch.repeat else self.share_to_wall(at[k], way[k]) for k in axes]
        share = reduce(self.do.least, shares)
        return self.until_light(patch, share)

    def share_up(self, h: Floats, way: Floats) -> Floats:
        """How much of the way it takes to the top; infinite where it does not lead up."""
        return np.where(np.asarray(way > 0.0), self.share_to_wall(h, way), np.inf)

    def until_light(self, patch: Patch, share: Floats) -> Floats:
        """Not beyond a point light."""
        return self.do.least(share, 1.0) if patch.light[3] == 1.0 else share

    def shadow_samples(self) -> range:
        """j."""
        return range(1, self.params.shadow_steps + 1)

    def shadow_fraction(self, j: int) -> Floats:
        """j/(S + 1)."""
        return self.do.widened(self.do.divide(float(j), float(self.params.shadow_steps + 1)), operations=1)

    def in_shadow(self, patch: Patch, h: Floats, height: Floats) -> Bools:
        """Whether a sample is below the surface."""
        return self.do.add(self.above_floor(h), self.shadow_bias(patch)) < height

    def shadow_bias(self, patch: Patch) -> Floats:
        """In units of h."""
        return self.do.number(self.params.shadow_bias)
