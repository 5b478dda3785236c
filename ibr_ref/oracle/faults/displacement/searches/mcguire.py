"""Bugs of steep parallax mapping."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.mcguire import McGuire

MCGUIRE = Bugs("march")
ONLY = ("mcguire",)


class _OtherCount(McGuire):
    """Another number of steps."""

    def count(self, patch: Patch, rays: Rays) -> Floats:
        return np.asarray(self.do.whole(self.do.in_lanes(self.steps(patch, rays), rays.start[0])))

    @abstractmethod
    def steps(self, patch: Patch, rays: Rays) -> Floats:
        """Before what is left of it is cut off."""


@MCGUIRE.add("as many steps at any angle", only=ONLY)
class _Constant(_OtherCount):
    """n = N, whatever the angle of view."""

    def steps(self, patch: Patch, rays: Rays) -> Floats:
        return float(self.params.linear_steps)


@MCGUIRE.add("fewer steps at grazing angles", only=ONLY)
class _Turned(_OtherCount):
    """n = lerp(N, 2 N, w_z): the ends of the lerp are swapped."""

    def steps(self, patch: Patch, rays: Rays) -> Floats:
        steps = float(self.params.linear_steps)
        return self.do.add(self.mixed(2.0 * steps, steps, self.cosine(patch, rays)), 0.5)


@MCGUIRE.add("number of steps rounded down", only=ONLY)
class _Down(_OtherCount):
    """n = floor(lerp(2 N, N, w_z)), without the half."""

    def steps(self, patch: Patch, rays: Rays) -> Floats:
        steps = float(self.params.linear_steps)
        return self.mixed(steps, 2.0 * steps, self.cosine(patch, rays))


@MCGUIRE.add("steps by the angle in patch space", only=ONLY)
class _PatchAngle(McGuire):
    """w_z is taken of the view ray in (u, v, h), which is scaled otherwise along each axis."""

    def cosine(self, patch: Patch, rays: Rays) -> Floats:
        way = [rays.way[0], rays.way[1], 1.0]
        return self.do.divide(1.0, self.do.root(self.do.dot(way, way)))


@MCGUIRE.add("hit at the sample before", only=ONLY)
class _Before(McGuire):
    """The last sample above the surface is the hit, not the first one below."""

    def shown_step(self, step: Ints) -> Ints:
        return step - 1
