"""Bugs of parallax occlusion mapping."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.tatarchuk import Tatarchuk

TATARCHUK = Bugs("march")
ONLY = ("tatarchuk",)


@TATARCHUK.add("number of layers not cut off", only=ONLY)
class _FloatLayers(Tatarchuk):
    """n is not made a whole number: the layers are 1/n of a fraction apart, and the last one is not at the bottom."""

    def count(self, patch: Patch, rays: Rays) -> Floats:
        return self.mixed(float(self.params.min_steps), float(self.params.max_steps), self.cosine(patch, rays))

    def last_step(self, count: Floats) -> Ints:
        return np.asarray(self.do.whole(count), np.int64)


@TATARCHUK.add("min_steps and max_steps swapped", only=ONLY)
class _Turned(Tatarchuk):
    """Most steps where the view is straight down."""

    def mixed(self, upright: float, level: float, cosine: Floats) -> Floats:
        return super().mixed(level, upright, cosine)


@TATARCHUK.add("max_steps at any angle", only=ONLY)
class _Constant(Tatarchuk):
    """n = n_max, whatever the angle of view."""

    def count(self, patch: Patch, rays: Rays) -> Floats:
        return np.full(rays.start[0].shape, float(self.params.max_steps))


@TATARCHUK.add("layers by the angle in patch space", only=ONLY)
class _PatchAngle(Tatarchuk):
    """w_z is taken of the view ray in (u, v, h), which is scaled otherwise along each axis."""

    def cosine(self, patch: Patch, rays: Rays) -> Floats:
        way = [rays.way[0], rays.way[1], 1.0]
        return self.do.divide(1.0, self.do.root(self.do.dot(way, way)))


@TATARCHUK.add("no secant", only=ONLY)
class _NoSecant(Tatarchuk):
    """The sample that stopped is the hit: steep parallax mapping."""

    def crossing(self, ray: Floats, height: Floats, ray_before: Floats, height_before: Floats) -> Floats:
        return ray


@TATARCHUK.add("hit at the layer before", only=ONLY)
class _Before(Tatarchuk):
    """The last sample above the surface is the hit."""

    def crossing(self, ray: Floats, height: Floats, ray_before: Floats, height_before: Floats) -> Floats:
        return ray_before


@TATARCHUK.add("weights of the secant swapped", only=ONLY)
class _SwappedWeights(Tatarchuk):
    """The two samples' weights are swapped."""

    def crossing(self, ray: Floats, height: Floats, ray_before: Floats, height_before: Floats) -> Floats:
        found = super().crossing(ray, height, ray_before, height_before)
        return self.do.subtract(self.do.add(ray, ray_before), found)


@TATARCHUK.add("middle of the last two samples", only=ONLY)
class _Middle(Tatarchuk):
    """The hit is half way between the last two samples."""

    def crossing(self, ray: Floats, height: Floats, ray_before: Floats, height_before: Floats) -> Floats:
        return self.do.multiply(self.do.add(ray, ray_before), 0.5)


@TATARCHUK.add("surface starts at the bottom", small=True, only=ONLY)
class _FromBottom(Tatarchuk):
    """H_0 counts as 0, not as 1: a stop at the first step is interpolated from the bottom."""

    def first_height(self) -> float:
        return 0.0
