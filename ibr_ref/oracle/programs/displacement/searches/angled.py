"""Searches whose number of steps hangs on the angle of view."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Descent


@dataclass(frozen=True)
class Sample:
    """One step of the rays that search on."""

    step: int
    """k."""
    rows: Ints
    """Which rays."""
    level: Floats
    height: Floats
    """H."""
    ends: Any
    """(rows,) whether it ends a search."""


class Angled(Descent):
    """Where the view ray's direction in the world counts."""

    def world_way(self, patch: Patch, rays: Rays) -> Vector:
        """The view ray in the world, from depth 1 up to the polygon."""
        return self.combined([patch.edge_u, patch.edge_v, patch.up], [-rays.way[0], -rays.way[1], 1.0])


class Stepped(Angled):
    """n steps, from the cosine between the view ray and the normal."""

    def cosine(self, patch: Patch, rays: Rays) -> Floats:
        """w_z: s over the ray's length, or the unit way's dot product with n."""
        way = self.world_way(patch, rays)
        ours = self.do.divide(patch.scale, self.do.root(self.do.dot(way, way)))
        return self.do.either(ours, lambda: self.do.dot(self.do.unit(way), patch.normal))

    @abstractmethod
    def count(self, patch: Patch, rays: Rays) -> Floats:
        """n of each ray, a whole number."""

    def level(self, fraction: Floats) -> Floats:
        """What a sample at k/n is compared by: its depth."""
        return fraction

    def depth_of(self, level: Floats) -> Floats:
        """Of a sample."""
        return level

    def ends(self, level: Floats, height: Floats) -> Bools:
        """Whether a sample ends the search."""
        return self.reached(level, height)

    def samples(self, patch: Patch, rays: Rays, count: Floats, first: int) -> Iterator[Sample]:
        """Step by step those of all rays that search on: one that leaves the map does not, nor one that has ended."""
        searching = np.arange(len(count))
        for k in range(first, self.most_steps() + 1):
            searching = searching[np.asarray(count[searching] >= k)]
            if not len(searching):
                return
            here = rays.some(searching)
            level = self.level(self.fraction_of(k, count[searching], here))
            u, v = self.below(here, self.depth_of(level))
            on_map = np.asarray(self.on_map(patch, [u, v]))
            searching, u, v, level = searching[on_map], u[on_map], v[on_map], level[on_map]
            height = self.height_at(patch, u, v)
            ends = np.asarray(self.ends(level, height))
            yield Sample(k, searching, level, height, ends)
            searching = searching[~ends]

    def told(self, patch: Patch, rays: Rays) -> Iterator[tuple[str, Floats]]:
        """The number of steps, and how far each sample is below the surface."""
        count = self.count(patch, rays)
        yield "w_z, cosine between the view ray and the normal", self.cosine(patch, rays)
        yield "n, number of steps", count
        for k in range(1, int(np.asarray(self.do.whole(count))[0]) + 1):
            depth = self.fraction_of(k, count, rays)
            u, v = self.below(rays, depth)
            overlap = self.overlap(depth, self.height_at(patch, u, v))
            yield f"sample {k}: H - (1 - k/n), not negative below the surface", overlap

    def mixed(self, upright: float, level: float, cosine: Floats) -> Floats:
        """From `level`, where the view is horizontal, to `upright`, where it is straight down: as lerps are written."""
        ours = self.multiply_add(cosine, upright - level, self.do.in_lanes(level, cosine))
        return self.do.either(ours, lambda: self.do.lerp(level, upright, cosine))

    def fraction_of(self, step: Any, count: Floats, rays: Rays) -> Floats:
        """k/n of rays, or k times a rounded 1/n."""
        found = self.do.divide(np.asarray(step, np.float64), count)
        return self.do.in_lanes(self.do.widened(found, operations=1), rays.start[0])

    def kept(self, values: Floats, rows: Ints, new: Floats) -> Floats:
        """With other numbers in some rows."""
        return self.do.replaced(values, rows, new) if len(rows) else values
