"""What searches below the polygon share: it is the top of the volume, and they march on it alone.

With D = 1 - H and C the fragment, the view ray at depth d is q(d) = C_uv - d (v_uv / v_h), v the way to the eye. Ports add
positions and depths up step by step, as their authors' shaders do, or multiply: both are legal.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Hits, Rays
from ibr_ref.oracle.programs.displacement.port import Port
from ibr_ref.oracle.programs.displacement.raster import Fragments


@dataclass(frozen=True)
class Found:
    """Where searches ended, one a fragment."""

    step: Ints
    """Its number; -1: nothing was found."""
    depth: Floats
    """d."""
    before: Floats
    """The height that is handed in as that before the hit."""


class Sunken(Port):
    """Rays down from the polygon; no ground, no walls."""

    floor: ClassVar[float] = -1.0

    def goes_up(self, way: Vector) -> Bools:
        """Whether the eye is above the polygon."""
        return way[2] > 0.0

    def rays(self, patch: Patch, point: Vector) -> Rays:
        """From C, d = 0, to q(1)."""
        way = self.towards(patch.eye, point)
        along = [self.do.named(f"along {k}", self.do.divide(way[k], way[2])) for k in (0, 1)]
        zero, one = (self.do.in_lanes(x, point[0]) for x in (0.0, 1.0))
        return Rays([point[0], point[1], zero], [-along[0], -along[1], -one])

    def below(self, rays: Rays, depth: Floats) -> Vector:
        """q(d), (u, v)."""
        return [
            self.added_up(self.multiply_add(way, depth, self.added_up(start)))
            for way, start in zip(rays.way[:2], rays.start[:2], strict=True)
        ]

    def added_up(self, x: Floats) -> Floats:
        """What may be a sum of as many terms as there are steps."""
        return self.do.widened(x, operations=float(self.most_steps()))

    def most_steps(self) -> int:
        """Of one ray."""
        return int(self.params.linear_steps)

    def on_map(self, patch: Patch, point: Vector) -> Bools:
        """Whether there is a map at (u, v)."""
        return np.ones(point[0].shape, bool) if patch.repeat else ~self.outside(point[0], point[1])

    def empty(self, patch: Patch, point: Vector) -> Bools:
        """Beside the map."""
        return ~self.on_map(patch, point)

    def overlap(self, depth: Floats, height: Floats) -> Floats:
        """d - D: how far a sample is below the surface; as d - (1 - H), or as H - (1 - d)."""
        ours = self.do.subtract(depth, self.do.subtract(1.0, height))
        return self.do.either(ours, lambda: self.do.subtract(height, self.do.subtract(1.0, depth)))

    def reached(self, depth: Floats, height: Floats) -> Bools:
        """Whether a sample is at or below the surface."""
        return self.overlap(depth, height) >= 0.0


class Descent(Sunken, ABC):
    """Searches that end at a depth of their own, on no lattice."""

    def march(self, patch: Patch, fragments: Fragments) -> Hits:
        """The hits of one patch's fragments."""
        usable = np.flatnonzero(self.goes_up(self.towards(patch.eye, fragments.point)))
        rays = self.rays(patch, [x[usable] for x in fragments.point])
        found = self.descend(patch, rays)
        hit = self.place(patch, rays, found)
        seen = self.on_map(patch, hit) & self.behind_near_plane(patch, hit)
        shown = np.flatnonzero(np.asarray((found.step >= 0) & seen))
        count, spread, places = len(fragments.face), self.do.spread, usable[shown]
        step = spread(found.step[shown], places, count, -1)
        return Hits(
            spread(self.written_linear_index(found.step[shown]), places, count, -1),
            step,
            [spread(x[shown], places, count, np.nan) for x in hit],
            spread(found.before[shown], places, count, 0.0),
            np.zeros(count, np.bool_),
        )

    @abstractmethod
    def descend(self, patch: Patch, rays: Rays) -> Found:
        """The search."""

    @abstractmethod
    def told(self, patch: Patch, rays: Rays) -> Iterator[tuple[str, Floats]]:
        """What a port author compares with: steps of the computation in words, and what comes out."""

    def place(self, patch: Patch, rays: Rays, found: Found) -> Vector:
        """(u, v, h) of the hit: on the ray."""
        return [*self.below(rays, found.depth), -found.depth]
