"""Cone step mapping (Dummer 2006), and relaxed cones with a binary search (Policarpo & Oliveira 2007)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce
from typing import ClassVar

import numpy as np

from ibr_ref.displacement.port_maps import cone_map_of
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Descent, Found


class Cone(Descent, search="cone"):
    """N steps, each as far as the empty cone over the texel reaches."""

    cones: ClassVar[str] = "cone"
    """Whose cone map it is given."""

    def ratios(self, patch: Patch) -> Floats:
        """The cone map as a float texture."""
        return self.do.number(cone_map_of(self.scene.polygons[patch.number], self.cones))

    def steps(self) -> range:
        """Of the ray."""
        return range(self.params.linear_steps)

    def speed(self, rays: Rays) -> Floats:
        """m: the way in (u, v) per depth."""
        return self.do.root(self.do.dot(rays.way[:2], rays.way[:2]))

    def cone_depth(self, patch: Patch, rays: Rays) -> Floats:
        """d after all steps."""
        ratios, speed = self.ratios(patch), self.speed(rays)
        return reduce(
            lambda depth, _: self.stepped(patch, ratios, rays, speed, depth),
            self.steps(),
            self.do.in_lanes(0.0, rays.start[0]),
        )

    def told(self, patch: Patch, rays: Rays) -> Iterator[tuple[str, Floats]]:
        """The depth after each step."""
        ratios, speed, depth = self.ratios(patch), self.speed(rays), self.do.in_lanes(0.0, rays.start[0])
        yield "m, the way in (u, v) per depth", speed
        for i in self.steps():
            depth = self.stepped(patch, ratios, rays, speed, depth)
            yield f"d after cone step {i + 1}", depth

    def stepped(self, patch: Patch, ratios: Floats, rays: Rays, speed: Floats, depth: Floats) -> Floats:
        """After one step: d + c (D - d) / (m + c)."""
        depth = self.do.named("d", self.do.settled(depth, *rays.start, *rays.way))
        u, v = self.below(rays, depth)
        with self.do.one_place():
            height, ratio = self.height_at(patch, u, v), self.fetch(ratios, u, v, patch.repeat)
        above = self.above(depth, height)
        ratio = self.ratio(self.do.named("c", ratio))
        share = self.do.divide(ratio, self.do.add(self.slant(speed), ratio))
        step = self.do.either(
            self.do.divide(self.do.multiply(ratio, above), self.do.add(self.slant(speed), ratio)),
            lambda: self.do.multiply(share, above),
        )
        # Never below the bottom, but for roundings.
        return self.do.between(self.do.add(depth, step), 0.0, self.do.widened(1.0, quotients=1, operations=6))

    def above(self, depth: Floats, height: Floats) -> Floats:
        """max(0, D - d)."""
        return self.do.greatest(-self.overlap(depth, height), 0.0)

    def ratio(self, ratio: Floats) -> Floats:
        """c, as the map holds it."""
        return ratio

    def slant(self, speed: Floats) -> Floats:
        """m, as it stands beside c."""
        return speed

    def descend(self, patch: Patch, rays: Rays) -> Found:
        """Where the last step ends."""
        depth = self.cone_depth(patch, rays)
        return Found(np.full(len(depth), self.params.linear_steps), depth, self.do.in_lanes(0.0, depth))


class RelaxedCone(Cone, search="relaxed_cone"):
    """The steps end inside the solid; M halvings of the whole stretch find the way back."""

    cones: ClassVar[str] = "relaxed_cone"

    def descend(self, patch: Patch, rays: Rays) -> Found:
        """Where the last halving ends."""
        reached = self.cone_depth(patch, rays)
        depth, stretch = reached, self.do.multiply(reached, 0.5)
        if self.params.binary_steps:
            depth = self.first_middle(reached, stretch)
        for _ in self.binary_steps():
            stretch = self.do.multiply(stretch, 0.5)
            u, v = self.below(rays, depth)
            below = np.asarray(self.goes_back(patch, u, v, depth))
            depth = np.where(below, self.do.subtract(depth, stretch), self.do.add(depth, stretch))
        return Found(np.full(len(depth), self.params.linear_steps), depth, self.do.in_lanes(0.0, depth))

    def first_middle(self, reached: Floats, stretch: Floats) -> Floats:
        """Half of the way from the polygon."""
        return stretch

    def goes_back(self, patch: Patch, u: Floats, v: Floats, depth: Floats) -> Bools:
        """Whether the surface lies before the sample."""
        return self.reached(depth, self.height_at(patch, u, v)) & self.on_map(patch, [u, v])
