"""Relief mapping (Policarpo et al. 2005): N linear steps down, then M halvings."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Sunken


class Relief(Sunken):
    """The protruded search's own lattice, below the polygon."""

    def position(self, rays: Rays, index: Ints | int) -> Vector:
        """q(k/K), and -k/K."""
        depth = self.added_up(self.do.in_lanes(self.fraction(index), rays.start[0]))
        return [*self.below(rays, depth), -depth]

    def may_stop(self, step: int) -> bool:
        """At the polygon too: where H = 1."""
        return True

    def inside(self, h: Floats, height: Floats) -> Bools:
        """d >= D."""
        return self.reached(-h, height)

    def counts_as_hit(self, index: Ints) -> Bools:
        """The bottom is hit as any other depth is."""
        return np.ones(index.shape, bool)

    def over_polygon(self, face: Ints, point: Vector) -> Bools:
        """There is no ground to fall back on."""
        return np.zeros(face.shape, bool)

    def is_steep(self, patch: object, hit: Vector, before: Floats, linear: Ints) -> Bools:
        """It knows no walls."""
        return np.zeros(linear.shape, bool)
