"""Bugs in percentage-closer soft shadows, from what people get wrong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ibr_ref.array_types import Floats as Array
from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.sampler import Sampler

SOFT = Bugs("project", only=("pcss",))
ORTHOGONAL = np.array([1.0, -1.0])


@SOFT.add("soft-search-not-scaled")
class _SearchNotScaled(Port):
    """The blocker search has one size, whatever the distance of the receiver: 1/m."""

    def search_scale(self, r: Floats) -> Floats:
        return self.do.in_lanes(self.do.divide(1.0, self.do.number(self.nearest)), r)


@SOFT.add("soft-search-as-wide-as-the-light")
class _SearchByDistance(Port):
    """The blocker search is as wide as the light seen from the receiver: 1/r."""

    def search_scale(self, r: Floats) -> Floats:
        return self.do.divide(1.0, r)


@SOFT.add("soft-receiver-for-blocker")
class _Exchanged(Port):
    """The penumbra is (r - b)/r, not (r - b)/b: receiver and blocker are exchanged in the denominator."""

    def penumbra(self, b: Floats, r: Floats) -> Floats:
        do = self.do
        return do.divide(do.divide(do.subtract(r, b), r), r)


@SOFT.add("soft-penumbra-not-seen-from-the-light")
class _NotSeen(Port):
    """Fernando's (r - b)/b scales the points on the map as it is, not over r."""

    def percentage(self, image: Floats, at: Vector, scale: Floats) -> Floats:
        return super().percentage(image, at, self.do.multiply(scale, at[2]))


@SOFT.add("soft-penumbra-fixed")
class _Fixed(Port):
    """The filter is as wide as the search, wherever the blockers are."""

    def percentage(self, image: Floats, at: Vector, scale: Floats) -> Floats:
        return super().percentage(image, at, self.search_scale(at[2]))


@SOFT.add("soft-bias-sign", small=True)
class _BiasSign(Port):
    """The bias is added to the receiver's distance."""

    def biased_distance(self, r: Floats) -> Floats:
        return self.do.add(r, self.do.number(self.params.bias))


@SOFT.add("soft-comparison-reversed")
class _Reversed(Port):
    """The filter counts what is farther than the receiver: light for shadow."""

    def asked(self, depth: Floats, here: Floats) -> Floats:
        return self.do.subtract(1.0, super().asked(depth, here))


@SOFT.add("soft-mean-of-all-samples")
class _OverAll(Port):
    """The blockers' sum is divided by all samples of the search."""

    def mean_of_blockers(self, found: Sequence[Floats], counts: Sequence[Bools]) -> Floats:
        return self.do.divide(self.do.sum(list(found)), float(len(found)))


@SOFT.add("soft-nearest-blocker")
class _Nearest(Port):
    """The nearest blocker is taken for their mean."""

    def mean_of_blockers(self, found: Sequence[Floats], counts: Sequence[Bools]) -> Floats:
        least = np.where(counts[0], found[0], 1e6)
        for distance, blocks in zip(found[1:], counts[1:], strict=True):
            least = self.do.least(least, np.where(blocks, distance, 1e6))
        return np.where(np.any(np.stack(counts), axis=0), least, 0.0)


@SOFT.add("soft-mean-of-window-depths")
class _MeanOfDepths(Port):
    """Window depths are averaged, and their mean is made a distance."""

    def held(self, depth: Floats, distance: Floats) -> Floats:
        return depth

    def mean_of_blockers(self, found: Sequence[Floats], counts: Sequence[Bools]) -> Floats:
        mean = super().mean_of_blockers(found, counts)
        return np.where(np.any(np.stack(counts), axis=0), self.distance(mean), 0.0)


@SOFT.add(
    "soft-empty-texels-block",
    survives="in no case is a receiver farther from the light than the map's far plane by more than the bias",
)
class _EmptyBlock(Port):
    """Texels that are empty, of depth 1, block at the far plane."""

    def there(self, depth: Floats) -> Bools:
        return depth < 2.0


@SOFT.add("soft-distances-of-another-range")
class _GLRange(Port):
    """Depths are made distances as if they were NDC from -1 to 1: 2 d - 1."""

    def distance(self, depth: Floats) -> Floats:
        return super().distance(self.do.subtract(self.do.multiply(depth, 2.0), 1.0))


@SOFT.add("soft-filter-nearest")
class _FilterNearest(Port):
    """The filter compares the nearest texel alone: no mix of four."""

    def of_point(self, sampler: Sampler, image: Floats, u: Floats, v: Floats, here: Floats) -> Floats:
        return self.asked(sampler.nearest(image, u, v), here)


@SOFT.add("soft-filter-of-depths")
class _FilterOfDepths(Port):
    """Depths are filtered, and then compared."""

    def of_point(self, sampler: Sampler, image: Floats, u: Floats, v: Floats, here: Floats) -> Floats:
        return self.asked(sampler.mix(*sampler.taps(image, u, v)), here)


@SOFT.add("soft-points-flipped")
class _Flipped(Port):
    """The light's points have their y upwards on the map."""

    def looked_up(self, at: Vector, points: Array, scale: Floats) -> list[Vector]:
        return super().looked_up(at, points * ORTHOGONAL, scale)


@SOFT.add("soft-light-halved")
class _Halved(Port):
    """The light's full size is taken for its half: regions are half as wide."""

    def looked_up(self, at: Vector, points: Array, scale: Floats) -> list[Vector]:
        return super().looked_up(at, 0.5 * points, scale)


@SOFT.add("soft-light-doubled")
class _Doubled(Port):
    """The light's half size is taken for its whole: regions are twice as wide."""

    def looked_up(self, at: Vector, points: Array, scale: Floats) -> list[Vector]:
        return super().looked_up(at, 2.0 * points, scale)


@SOFT.add("soft-last-point-left-out")
class _LastLeftOut(Port):
    """The filter's loop ends one point early, its sum is divided by all."""

    def looked_up(self, at: Vector, points: Array, scale: Floats) -> list[Vector]:
        found = super().looked_up(at, points, scale)
        return [*found[:-1], [-1.0 + 0.0 * x for x in found[-1]]] if points is self.filter_points else found


@SOFT.add("soft-no-bias-in-the-search", small=True)
class _SearchWithoutBias(Port):
    """Blockers are searched without the bias."""

    def search_distance(self, r: Floats) -> Floats:
        return 1.0 * r


@SOFT.add("soft-caster-shadowed")
class _OnCaster(Port):
    """The caster's own fragments are in shadow too."""

    def exempt(self, casts: Bools) -> Bools:
        return np.zeros_like(casts)


@SOFT.add("soft-distances-half-floats", small=True)
class _HalfDistances(Port):
    """The map's distances are held in half floats."""

    def distance(self, depth: Floats) -> Floats:
        return half(super().distance(depth))


@SOFT.add("soft-blocker-half-floats", small=True)
class _HalfBlocker(Port):
    """The mean of the blockers is held in half floats."""

    def mean_of_blockers(self, found: Sequence[Floats], counts: Sequence[Bools]) -> Floats:
        return half(super().mean_of_blockers(found, counts))


@SOFT.add("soft-penumbra-half-floats", small=True)
class _HalfPenumbra(Port):
    """The penumbra is held in half floats."""

    def penumbra(self, b: Floats, r: Floats) -> Floats:
        return half(super().penumbra(b, r))


@SOFT.add("soft-points-half-floats", small=True)
class _HalfPoints(Port):
    """The light's points are held in half floats."""

    def looked_up(self, at: Vector, points: Array, scale: Floats) -> list[Vector]:
        return super().looked_up(at, half(points), scale)
