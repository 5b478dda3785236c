"""Searches whose number of steps hangs on the angle of view."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Descent


class Angled(Descent):
    """n steps, from the cosine between the view ray and the normal."""

    def world_way(self, patch: Patch, rays: Rays) -> Vector:
        """The view ray in the world, from depth 1 up to the polygon."""
        return self.combined([patch.edge_u, patch.edge_v, patch.up], [-rays.way[0], -rays.way[1], 1.0])

    def cosine(self, patch: Patch, rays: Rays) -> Floats:
        """w_z: s over the ray's length, or the unit way's dot product with n."""
        way = self.world_way(patch, rays)
        ours = self.do.divide(patch.scale, self.do.root(self.do.dot(way, way)))
        return self.do.either(ours, lambda: self.do.dot(self.do.unit(way), patch.normal))

    def count(self, patch: Patch, rays: Rays) -> Floats:
        """n of each ray, a whole number."""
        raise NotImplementedError

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
