"""Sphere tracing in a distance map (Donnelly 2005): N steps, each as far as the nearest solid voxel is."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

import numpy as np

from ibr_ref.displacement.port_maps import distance_map_of
from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Descent, Found


class Donnelly(Descent, search="donnelly"):
    """Along the unit ray of the space (u, v, d), all of it scaled alike."""

    def distances(self, patch: Patch) -> Floats:
        """The distance map as a float texture of three dimensions, (layers, rows, columns)."""
        return self.do.number(distance_map_of(self.scene.polygons[patch.number], self.params.distance_layers))

    def steps(self) -> range:
        """Of the ray."""
        return range(self.params.linear_steps)

    def descend(self, patch: Patch, rays: Rays) -> Found:
        """Where the last step ends, but not below the bottom."""
        reached = reduce(lambda _, step: step[1], self.traced(patch, rays), self.do.in_lanes(0.0, rays.start[0]))
        depth = self.do.least(self.do.settled(reached, *rays.start, *rays.way), 1.0)
        return Found(np.full(len(depth), self.params.linear_steps), depth, self.do.in_lanes(0.0, depth))

    def traced(self, patch: Patch, rays: Rays) -> Iterator[tuple[Floats, Floats]]:
        """After each step: how far it is to the solid before it, and the depth."""
        distances, length, depth = self.distances(patch), self.length(patch, rays), self.do.in_lanes(0.0, rays.start[0])
        for _ in self.steps():
            depth = self.do.named("d", self.do.settled(depth, *rays.start, *rays.way))
            u, v = self.below(rays, depth)
            distance = self.read(self.distance(patch, distances, u, v, depth))
            depth = self.do.add(depth, self.advance(distance, length))
            yield distance, depth

    def told(self, patch: Patch, rays: Rays) -> Iterator[tuple[str, Floats]]:
        """The distance and the depth after each step."""
        yield "length of the ray in (u, v, d) per depth", self.length(patch, rays)
        for i, (distance, depth) in enumerate(self.traced(patch, rays), 1):
            yield f"distance before step {i}", distance
            yield f"d after step {i}", depth

    def length(self, patch: Patch, rays: Rays) -> Floats:
        """Of the ray from depth 0 to depth 1."""
        way = [*rays.way[:2], 1.0]
        return self.do.root(self.do.dot(way, way))

    def advance(self, distance: Floats, length: Floats) -> Floats:
        """The way down of a step: over the length, or along the unit ray."""
        ours = self.do.divide(distance, length)
        return self.do.either(ours, lambda: self.do.multiply(distance, self.do.divide(1.0, length)))

    def distance(self, patch: Patch, distances: Floats, u: Floats, v: Floats, depth: Floats) -> Floats:
        """Trilinear: between two layers, each fetched for those rays that are there."""
        layer, weight = self.layer_and_weight(depth, len(distances))
        found = self.do.in_lanes(0.0, depth)
        for k in np.unique(layer):
            rows = np.flatnonzero(layer == k)
            here = u[rows], v[rows]
            with self.do.one_place():
                above, under = (
                    self.fetch(distances[self.layer(k + i, len(distances))], *here, patch.repeat) for i in (0, 1)
                )
            mixed = self.do.settled(self.lerp(above, under, weight[rows]), *here, depth)
            found = self.do.replaced(found, rows, mixed)
        return found

    def layer_and_weight(self, depth: Floats, count: int) -> tuple[Ints, Floats]:
        """The layer whose middle is at or above a depth, and the way from there to the next."""
        layer, weight = self.texel_and_weight(depth, count)
        return np.asarray(layer, np.int64), weight

    def layer(self, number: int, count: int) -> int:
        """Clamped, whatever the wrap mode of u and v."""
        return min(max(int(number), 0), count - 1)

    def read(self, distance: Floats) -> Floats:
        """As the map holds it."""
        return distance
