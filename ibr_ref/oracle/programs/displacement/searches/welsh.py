"""Parallax mapping with offset limiting (Welsh 2004): one fetch, one step along the polygon."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.angled import Angled
from ibr_ref.oracle.programs.displacement.searches.below import Found


class Welsh(Angled):
    """(u, v) = C_uv + H(C) s (U*.w, V*.w), w the unit way to the eye; nothing is displaced."""

    floor: ClassVar[float] = 0.0

    def most_steps(self) -> int:
        """None is added up."""
        return 0

    def descend(self, patch: Patch, rays: Rays) -> Found:
        """The polygon is hit where it is."""
        none = self.do.in_lanes(0.0, rays.start[0])
        return Found(np.zeros(len(rays.start[0]), np.int64), none, none)

    def place(self, patch: Patch, rays: Rays, found: Found) -> Vector:
        """T, on the polygon."""
        u, v, _ = rays.start
        raised = self.do.multiply(self.read(self.height_at(patch, u, v)), patch.scale)
        offsets = [self.limited(raised, -way, self.length(patch, rays)) for way in rays.way[:2]]
        return [*(self.moved(x, offset) for x, offset in zip((u, v), offsets, strict=True)), -found.depth]

    def told(self, patch: Patch, rays: Rays) -> Iterator[tuple[str, Floats]]:
        """The height, and the length of the way to the eye."""
        yield "H(C)", self.height_at(patch, *rays.start[:2])
        yield "abs(W), length of the way to the eye", self.length(patch, rays)

    def read(self, height: Floats) -> Floats:
        """The height that is fetched, without a scale or a bias of its own."""
        return height

    def length(self, patch: Patch, rays: Rays) -> Floats:
        """Of the way to the eye, per height of the volume."""
        way = self.world_way(patch, rays)
        return self.do.root(self.do.dot(way, way))

    def limited(self, raised: Floats, along: Floats, length: Floats) -> Floats:
        """s H w: of the unit way, which is not divided by its height."""
        ours = self.do.divide(self.do.multiply(raised, along), length)
        return self.do.either(ours, lambda: self.do.multiply(raised, self.do.divide(along, length)))

    def moved(self, x: Floats, offset: Floats) -> Floats:
        """Towards the eye."""
        return self.do.add(x, offset)

    @property
    def displaces(self) -> bool:
        """Whatever the parameters say, depth is the polygon's own."""
        return False
