"""Steep parallax mapping (McGuire & McGuire 2005): n equal steps down, no refinement."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.angled import Stepped
from ibr_ref.oracle.programs.displacement.searches.below import Found
from ibr_ref.scene.checks import reject


class McGuire(Stepped, search="mcguire"):
    """The first of n samples, from d = 0 on, with d >= D."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """Raises ValueError for coarser levels of the height map: which they are, drivers differ in."""
        if params.lod_bias != 0.0:
            raise reject("lod_bias", params.lod_bias, "0 in a case of mcguire: drivers make other mip levels")
        super().__init__(scene, params, policy, inputs)

    def most_steps(self) -> int:
        """Where the view is horizontal."""
        return 2 * int(self.params.linear_steps)

    def count(self, patch: Patch, rays: Rays) -> Floats:
        """floor(lerp(2 N, N, w_z) + 1/2)."""
        steps = float(self.params.linear_steps)
        mixed = self.mixed(steps, 2.0 * steps, self.cosine(patch, rays))
        return np.asarray(self.do.whole(self.do.add(mixed, 0.5)))

    def descend(self, patch: Patch, rays: Rays) -> Found:
        """Sample by sample; a ray that leaves the map finds nothing."""
        count = self.count(patch, rays)
        step = np.full(len(count), -1)
        last = before = self.do.in_lanes(0.0, rays.start[0])
        for sample in self.samples(patch, rays, count, first=0):
            there = sample.rows[sample.ends]
            step[there] = sample.step
            before = self.kept(before, there, last[there])
            last = self.kept(last, sample.rows, sample.height)
        return Found(step, self.fraction_of(np.maximum(self.shown_step(step), 0), count, rays), before)

    def shown_step(self, step: Ints) -> Ints:
        """The sample that is the hit."""
        return step
