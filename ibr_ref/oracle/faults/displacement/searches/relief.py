"""Bugs of relief mapping; those of the linear and the binary search are the protruded search's too."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.relief import Relief

RELIEF = Bugs("march")
ONLY = ("relief",)


@RELIEF.add("binary search over the whole ray", only=ONLY)
class _WholeRay(Relief):
    """The bracket of the binary search starts at the polygon, not one step before the hit."""

    def bracket(self, step: Ints) -> tuple[Ints, Ints]:
        low, high = super().bracket(step)
        return np.zeros_like(low), high


@RELIEF.add("step of 1/(N + 1)", only=ONLY)
class _ShortSteps(Relief):
    """The ray is cut into N + 1 steps, of which N are taken."""

    def fraction(self, index: Ints | int) -> Floats:
        steps = float(self.params.linear_steps)
        return self.do.multiply(super().fraction(index), self.do.divide(steps, steps + 1.0))


@RELIEF.add("binary search left out", only=ONLY)
class _Linear(Relief):
    """The stop of the linear search is the hit."""

    def binary_search(self, patch: Patch, rays: Rays, linear: Ints) -> Ints:
        return np.where(linear < 0, -1, linear << self.params.binary_steps)
