"""Bugs of cone stepping, plain and relaxed."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ibr_ref.displacement.port_maps import cone_map_of
from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Patch
from ibr_ref.oracle.programs.displacement.searches.cone import Cone, RelaxedCone

CONE = Bugs("march")
BOTH, PLAIN, RELAXED = ("cone", "relaxed_cone"), ("cone",), ("relaxed_cone",)


@CONE.add("ratio squared", only=BOTH)
class _Squared(Cone):
    """The ratio is squared after the fetch, as for maps that hold square roots."""

    def ratio(self, ratio: Floats) -> Floats:
        return self.do.multiply(ratio, ratio)


@CONE.add("root of the ratio", only=BOTH)
class _Root(Cone):
    """The square root of the ratio is used."""

    def ratio(self, ratio: Floats) -> Floats:
        return self.do.root(ratio)


@CONE.add("ratio in 8 bits", small=True, only=BOTH)
class _Bytes(Cone):
    """The cone map is an 8-bit texture, whose fetches are bytes."""

    def ratio(self, ratio: Floats) -> Floats:
        return self.do.divide(self.do.whole(self.do.add(self.do.multiply(ratio, 255.0), 0.5)), 255.0)


@CONE.add("slant of the ray left out", only=BOTH)
class _Upright(Cone):
    """m = 1, as if every ray fell at the same angle."""

    def slant(self, speed: Floats) -> Floats:
        return self.do.in_lanes(1.0, speed)


@CONE.add("half a step each time", only=BOTH)
class _HalfSteps(Cone):
    """Each step goes half as far as the cone allows."""

    def above(self, depth: Floats, height: Floats) -> Floats:
        return self.do.multiply(super().above(depth, height), 0.5)


@CONE.add("one step more", only=PLAIN)
class _StepMore(Cone):
    """N + 1 steps."""

    def steps(self) -> range:
        return range(self.params.linear_steps + 1)


@CONE.add("one step less", only=BOTH)
class _StepLess(Cone):
    """N - 1 steps."""

    def steps(self) -> range:
        return range(self.params.linear_steps - 1)


@CONE.add("relaxed cones without a binary search", only=RELAXED)
class _NoHalvings(RelaxedCone):
    """The steps' end, inside the solid, is the hit."""

    def binary_steps(self) -> range:
        return range(0)

    def first_middle(self, reached: Floats, stretch: Floats) -> Floats:
        return reached


@CONE.add("binary search starts at the end of the steps", only=RELAXED)
class _FromEnd(RelaxedCone):
    """The halvings start at d_N, not at d_N / 2."""

    def first_middle(self, reached: Floats, stretch: Floats) -> Floats:
        return reached


@CONE.add("halvings the wrong way", only=RELAXED)
class _WrongWay(RelaxedCone):
    """On where the sample is inside, back where it is not."""

    def goes_back(self, patch: Patch, u: Floats, v: Floats, depth: Floats) -> Bools:
        return ~np.asarray(super().goes_back(patch, u, v, depth))


@CONE.add("the other search's cones", only=BOTH)
class _OtherCones(Cone):
    """The cone map is made for the other one of plain and relaxed cone stepping."""

    others: ClassVar[dict[str, str]] = {"cone": "relaxed_cone", "relaxed_cone": "cone"}

    def ratios(self, patch: Patch) -> Floats:
        return self.do.number(cone_map_of(self.scene.polygons[patch.number], self.others[self.cones]))
