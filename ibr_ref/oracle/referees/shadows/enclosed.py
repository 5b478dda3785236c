"""Soft shadows of fragments whose outcomes are too many to follow: bounds around all of them, for which nothing forks.

At the verge of the caster a texel may be empty or not, and where a point of the light is looked up it may be one texel
or the next: each of dozens of comparisons would double the outcomes. But their ways meet again, in a mean. That of blockers
lies between the least and the largest mean of any choice among them. And as no weight of a filter is below 0, a shadow is
the lightest where nothing blocks that may or may not, and the darkest where all of it does.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.arithmetic.number import Number, Truth, may_and_must
from ibr_ref.oracle.programs.program import Vector, right
from ibr_ref.oracle.programs.shadows import Port
from ibr_ref.oracle.referees.shadows.maps import Map
from ibr_ref.oracle.referees.shadows.model import Model

MOST_TEXELS = 10
"""Along an axis, of a place; a fragment with wider ones is lost."""
ROUNDINGS = 8.0
"""More than a bilinear mix has."""


class Enclosed(Port):
    """A program whose blockers and comparisons have bounds as a whole, where no bug changes how they are put together."""

    vacant: Bools
    """(S, S) texels that may be empty, whatever may be drawn there."""

    def blocker(self, image: Number, at: Vector) -> Any:
        """(N,) all that the mean of blockers may be; one decision: whether there are any."""
        sampler = self.shadow_sampler(self.do)
        if not (self.right("mean_of_blockers", "held") and right(sampler, "index", "texel", "nearest")):
            return super().blocker(image, at)
        (s, t, r), (height, width) = at, image.shape
        here, taps = self.search_distance(r), []
        for u, v in self.looked_up([s, t], self.search_points, self.search_scale(r)):
            columns = sampler.wrap(self._reached(self.do.multiply(u, width)), width)
            rows = sampler.wrap(self._reached(self.do.multiply(v, height)), height)
            may, must, low, high = self._blocking(image, rows, columns, here)
            on_map = may_and_must(self.in_map(u, v))
            may, must = may.any(axis=(1, 2)) & on_map[0], must.all(axis=(1, 2)) & on_map[1]
            taps.append((may, must, low.min(axis=(1, 2)), high.max(axis=(1, 2))))
        may, must, low, high = (np.stack(each, axis=1) for each in zip(*taps, strict=True))
        least, most = least_mean(low, may, must), -least_mean(-high, may, must)
        some = Truth(self.do, may.any(axis=1), must.any(axis=1), r.lane).decided()
        mean = self._mean(np.where(some, least, 0.0), np.where(some, most, 0.0), r, len(taps))
        return self.do.where(some, mean, 0.0)

    def mean_of_comparisons(self, image: Number, places: Sequence[Vector], here: Number) -> Any:
        """(N,) all that it may be."""
        sampler = self.shadow_sampler(self.do)
        if not (self.right("of_point", "asked") and right(sampler, "position", "texel", "taps", "mix")):
            return super().mean_of_comparisons(image, places, here)
        height, width = image.shape
        least, most = np.zeros(len(here)), np.zeros(len(here))
        for u, v in places:
            x, y = sampler.position(u, width), sampler.position(v, height)
            columns, rows = (self._reached(each, 1) for each in (x, y))
            asked = self._blocking(image, sampler.wrap(rows, height), sampler.wrap(columns, width), here)[:2]
            weights = [hats(each, at) for each, at in ((y, rows), (x, columns))]
            most_here, least_here = (np.einsum("nyr,nrc,nxc->nyx", weights[0], each, weights[1]) for each in asked)
            may, must = may_and_must(self.in_map(u, v))
            least += np.where(must, least_here.min(axis=(1, 2)), 0.0)
            most += np.where(may, most_here.max(axis=(1, 2)), 0.0)
        total = self.do.of_bytes(self._mean(least / len(places), most / len(places), here, len(places)))
        step = self.do.device.weight_step
        return total.off_by(2.0 * step * (1.0 + step) + self.do.device.operation * ROUNDINGS * UNIT)

    def _reached(self, x: Number, more: int = 0) -> Ints:
        """(N, K) floor(x), whatever it may be, and so many after it; the last ones again where there are fewer than K."""
        first, last = np.floor(x.low), np.floor(x.high)
        far = ~(last - first < MOST_TEXELS)
        self.do.give_up(x[far])
        first, last = (np.where(far, 0.0, end).astype(np.int64) for end in (first, last))
        count = int((last - first).max(initial=0)) + 1 + more
        texels: Ints = np.minimum(first[:, None] + np.arange(count), last[:, None] + more)
        return texels

    def _blocking(self, image: Number, rows: Ints, columns: Ints, here: Number) -> tuple[Bools, Bools, Floats, Floats]:
        """(N, R, C) each, of texels: whether they may block, whether they must, and the ends of their distances."""
        row, column = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
        fragment = np.repeat(np.arange(len(rows)), rows.shape[1] * columns.shape[1])
        depth = self.do.in_lanes(image[row.reshape(-1), column.reshape(-1)], here[fragment])
        distance = self._distance(depth)
        may, must = may_and_must(self.there(depth) & self.nearer(distance, here[fragment]))
        low, high = np.where(may, distance.low, np.inf), np.where(may, distance.high, -np.inf)
        sure = must.reshape(row.shape) & ~self.vacant[row, column]
        return may.reshape(row.shape), sure, low.reshape(row.shape), high.reshape(row.shape)

    def _distance(self, depth: Number) -> Number:
        """Of depths; it grows with them, so that it lies between those of the ends."""
        ends = [self.do.of(self.distance(Number(self.do, end, 0.0, {}, depth.lane))) for end in (depth.low, depth.high)]
        return self._between(ends[0].low, ends[1].high, depth)

    def _between(self, low: Floats, high: Floats, like: Number) -> Number:
        middle = 0.5 * (low + high)
        return Number(self.do, middle, np.maximum(high - middle, middle - low), {}, like.lane)

    def _mean(self, low: Floats, high: Floats, like: Number, terms: int) -> Number:
        """Between the ends of a mean of so many terms."""
        found: Number = self.do.widened(self._between(low, high, like), quotients=1.0, operations=terms + 1.0)
        return found


def enclosed(model: Model, texels: Map) -> Any:
    """The model's program, for a map."""
    kind = type("Enclosed", (Enclosed, model.kind), {"vacant": texels.vacant})
    return kind(model.case.scene, model.case.params, Policy(), model.case.inputs).on(model.machine)


def least_mean(numbers: Floats, may: Bools, must: Bools) -> Floats:
    """(N,) the least mean of those of the numbers (N, M) that must be in it and any of those that may; inf of none."""
    free = np.sort(np.where(may & ~must, numbers, np.inf), axis=1)
    total = np.where(must, numbers, 0.0).sum(axis=1)[:, None] + np.pad(np.cumsum(free, axis=1), ((0, 0), (1, 0)))
    count = must.sum(axis=1)[:, None] + np.arange(numbers.shape[1] + 1)
    least: Floats = np.where(count > 0, total / np.maximum(count, 1), np.inf).min(axis=1)
    return least


def hats(x: Number, texels: Ints) -> Floats:
    """(N, X, K) the weights that texels (N, K) along an axis have at the ends of places, and at the centres between.

    On a rectangle of places a bilinear mix has its extremes there.
    """
    at = np.clip(texels, x.low[:, None], x.high[:, None])
    at = np.concatenate([at, x.low[:, None], x.high[:, None]], axis=1)
    fresh = np.diff(texels, axis=1, prepend=texels[:, :1] - 1) > 0  # a texel that stands there again has no weight
    weights: Floats = np.maximum(0.0, 1.0 - np.abs(at[:, :, None] - texels[:, None, :])) * fresh[:, None, :]
    return weights
