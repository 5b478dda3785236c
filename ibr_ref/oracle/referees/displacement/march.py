"""Stage march: every way in which the search may legally come out (sections 3.1 and 4.2).

The search runs in lockstep over all fragments. At each sample the gap H - h has a bound: where it certainly lies above 0 the
search stops, where it may, it stops in one branch and goes on in another. The binary search splits its branches likewise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement import Params
from ibr_ref.oracle.accept.bounded import Bounded, uploaded
from ibr_ref.oracle.accept.fetch import fetch, highest_around
from ibr_ref.oracle.referees.displacement.arrays import joined
from ibr_ref.oracle.referees.displacement.constants import Constants, Vector
from ibr_ref.oracle.referees.displacement.rays import Rays, paper_rays, volume_rays

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

MOST_BRANCHES = 64
"""A fragment whose search splits into more is not followed: whatever a port makes of it is accepted, and it is undecided."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Outcomes:
    """(n,) ways in which searches may come out; several of one fragment are alternatives."""

    fragment: Ints
    linear_index: Ints
    hit_index: Ints
    """-1 discarded; then the rest is NaN, 0 and False."""
    hit: Vector
    """(u, v, h)."""
    height_before: Bounded
    steep: Bools

    def take(self, index: Ints | Bools) -> Outcomes:
        """Some of them."""
        return Outcomes(
            fragment=self.fragment[index],
            linear_index=self.linear_index[index],
            hit_index=self.hit_index[index],
            hit=[x[index] for x in self.hit],
            height_before=self.height_before[index],
            steep=self.steep[index],
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Search:
    """The search of one polygon's fragments."""

    constants: Constants
    params: Params
    rays: Rays
    point: Vector
    """C."""

    @property
    def volume(self) -> bool:
        """interval="volume"."""
        return self.params.interval == "volume"

    @property
    def bounded(self) -> bool:
        """Samples outside the unit square are empty."""
        return self.constants.polygon.domain == "clip" and not self.volume

    @property
    def lattice(self) -> int:
        """K."""
        return self.params.linear_steps << self.params.binary_steps

    def step(self, index: int) -> int:
        """The lattice index of a linear step."""
        return index << self.params.binary_steps


def search_of(constants: Constants, params: Params, point: Vector) -> Search:
    """Prepare the search for fragments at points C."""
    rays = (volume_rays if params.interval == "volume" else paper_rays)(constants, point)
    return Search(constants=constants, params=params, rays=rays, point=point)


def outcomes_of(search: Search) -> tuple[Outcomes, Ints]:
    """All legal outcomes, and the fragments that have too many."""
    fragment, step, low, high, none = _linear(search)
    fragment, step, high, lost = _binary(search, fragment, step, low, high)
    end = high == search.lattice  # a hit at the end of the ray is none
    none = np.union1d(none, fragment[end])
    ground, discarded = _without_hit(search, none)
    fragment, step, high = (a[~end] for a in (fragment, step, high))
    ends = (np.full(len(ground), -1), np.full(len(ground), search.lattice))
    nothing = np.full(len(discarded), -1)
    outcomes = _placed(
        search,
        np.concatenate([fragment, ground, discarded]),
        np.concatenate([step, ends[0], nothing]),
        np.concatenate([high, ends[1], nothing]),
    )
    # Where the eye may lie at the fragment's own height, the ray may lead anywhere.
    anywhere = (outcomes.hit_index >= 0) & ~np.all([np.isfinite(x.value + x.error) for x in outcomes.hit], axis=0)
    return outcomes.take(~anywhere), np.union1d(lost, outcomes.fragment[anywhere])


def inside(search: Search, fragment: Ints, index: Ints) -> tuple[Bools, Bools]:
    """Whether the sample at a lattice index may lie inside the solid, and whether it must."""
    point = search.rays.at(fragment, index, search.lattice)
    may_count, must_count = domain(search, *point[:2])
    # Most samples lie above all texels around them: they need no fetch.
    near = np.flatnonzero(may_count & ~(point[2].low > highest_around(search.constants.textures.height, *point[:2])))
    gap = _gap(search, [x[near] for x in point])
    may, must = np.zeros(len(fragment), np.bool_), np.zeros(len(fragment), np.bool_)
    may[near], must[near] = gap.high > 0.0, must_count[near] & (gap.low > 0.0)
    return may, must


def compared(search: Search, fragment: Ints, index: Ints) -> tuple[Bounded, Bools, Bools]:
    """H - h at samples, NaN above all heights and outside the domain, and whether they may and must lie inside the solid."""
    point = search.rays.at(fragment, index, search.lattice)
    may_count, _ = domain(search, *point[:2])
    near = np.flatnonzero(may_count & ~(point[2].low > search.constants.textures.height.largest))
    value, error = np.full(len(fragment), np.nan), np.zeros(len(fragment))
    gap = _gap(search, [x[near] for x in point])
    value[near], error[near] = gap.value, gap.error
    return Bounded(value, error, gap.device), *inside(search, fragment, index)


def _gap(search: Search, point: Vector) -> Bounded:
    u, v, h = point
    sample = fetch(search.constants.textures.height, u, v)
    return Bounded(sample.value - h.value, sample.error + h.error, h.device)


def domain(search: Search, u: Bounded, v: Bounded) -> tuple[Bools, Bools]:
    """Whether samples may lie in the map's domain, and whether they must. Where nothing is known they may."""
    everywhere = np.ones(len(u.value), np.bool_)
    if not search.bounded:
        return everywhere, everywhere
    outside = (u.high < 0.0) | (u.low > 1.0) | (v.high < 0.0) | (v.low > 1.0)
    within = (u.low >= 0.0) & (u.high <= 1.0) & (v.low >= 0.0) & (v.high <= 1.0)
    return ~outside, within


def _linear(search: Search) -> tuple[Ints, Ints, Ints, Ints, Ints]:
    """Possible stops: fragment, step, and the bracket's ends; and the fragments that may stop nowhere."""
    searching = np.flatnonzero(search.rays.may_go)
    found: list[tuple[Ints, int]] = []
    first = 0 if search.volume else 1  # at h = 1 nothing is higher
    for i in range(first, search.params.linear_steps + 1):
        if not len(searching):
            break
        may, must = inside(search, searching, np.full(len(searching), search.step(i)))
        found.append((searching[may], i))
        searching = searching[~must]
    fragment = np.concatenate([f for f, _ in found]) if found else np.empty(0, np.int64)
    step = np.concatenate([np.full(len(f), i) for f, i in found]) if found else np.empty(0, np.int64)
    none = np.union1d(searching, np.flatnonzero(~search.rays.must_go))
    high = step << search.params.binary_steps
    low = np.maximum(step - 1, 0) << search.params.binary_steps
    return fragment, step, low, high, none


def _binary(search: Search, fragment: Ints, step: Ints, low: Ints, high: Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """M halvings: fragment, step and lattice index of each branch; and the fragments with too many."""
    lost = np.empty(0, np.int64)
    for _ in range(search.params.binary_steps + 1):
        counts = np.bincount(fragment, minlength=1)
        lost = np.union1d(lost, np.flatnonzero(counts > MOST_BRANCHES))
        kept = counts[fragment] <= MOST_BRANCHES
        fragment, step, low, high = (a[kept] for a in (fragment, step, low, high))
        open_ = high - low > 1
        if not open_.any():
            break
        middle = (low + high) // 2
        may, must = open_.copy(), np.zeros(len(open_), np.bool_)
        may[open_], must[open_] = inside(search, fragment[open_], middle[open_])
        must |= ~open_  # what is found already stays as it is, in one branch
        may |= ~open_
        middle = np.where(open_, middle, high)
        stay = ~must
        fragment, step = np.concatenate([fragment[may], fragment[stay]]), np.concatenate([step[may], step[stay]])
        low, high = np.concatenate([low[may], middle[stay]]), np.concatenate([middle[may], high[stay]])
    return fragment, step, high, lost


def _without_hit(search: Search, none: Ints) -> tuple[Ints, Ints]:
    """Fragments that may hit the polygon itself, and those that may be discarded."""
    u, v, h = (x[none] for x in search.point)
    level = (h.value == 0.0) & search.rays.may_go[none]
    may = level & (u.high >= 0.0) & (u.low <= 1.0) & (v.high >= 0.0) & (v.low <= 1.0)
    must = level & (u.low >= 0.0) & (u.high <= 1.0) & (v.low >= 0.0) & (v.high <= 1.0)
    return none[may], none[~(must & search.rays.must_go[none])]


def _placed(search: Search, fragment: Ints, step: Ints, index: Ints) -> Outcomes:
    """Where the outcomes lie, and whether on a wall: both ways where that is a matter of rounding."""
    device = search.constants.device
    kept, stopped = index >= 0, step >= 0
    hit = search.rays.at(fragment, np.where(kept, index, search.lattice), search.lattice)
    ground = kept & ~stopped
    hit[2] = Bounded(np.where(ground, 0.0, hit[2].value), np.where(ground, 0.0, hit[2].error), device)
    hit = [Bounded(np.where(kept, x.value, np.nan), np.where(kept, x.error, 0.0), device) for x in hit]
    before, (empty, full) = _heights_before(search, fragment, step)
    outcomes = [
        Outcomes(
            fragment=fragment[some],
            linear_index=step[some],
            hit_index=index[some],
            hit=[x[some] for x in hit],
            height_before=height[some],
            steep=np.zeros(int(some.sum()), np.bool_),
        )
        for some, height in ((empty, Bounded(np.zeros(len(step)), np.zeros(len(step)), device)), (full, before))
    ]
    split = [part for each in outcomes for part in _steep(search, each)]
    return joined_outcomes(split)


def _heights_before(search: Search, fragment: Ints, step: Ints) -> tuple[Bounded, tuple[Bools, Bools]]:
    """a, and where it may be 0 because that sample is empty, and where it may be what the map has."""
    device = search.constants.device
    value, error = np.zeros(len(step)), np.zeros(len(step))
    empty, full = np.ones(len(step), np.bool_), np.zeros(len(step), np.bool_)
    some = np.flatnonzero(step > 0)
    if len(some):
        before = (step[some] - 1) << search.params.binary_steps
        u, v, _ = search.rays.at(fragment[some], before, search.lattice)
        may, must = domain(search, u, v)
        height = fetch(search.constants.textures.height, u, v)
        value[some], error[some] = height.value, height.error
        full[some], empty[some] = may, ~must
    return Bounded(value, error, device), (empty, full)


def _steep(search: Search, outcomes: Outcomes) -> list[Outcomes]:
    margin = steep_margin(search, outcomes)
    stopped = outcomes.linear_index >= 0
    may, must = stopped & (margin.high > 0.0), stopped & (margin.low > 0.0)
    steep = outcomes.take(may)
    steep = Outcomes(**{**vars(steep), "steep": np.ones(len(steep.fragment), np.bool_)})
    return [steep, outcomes.take(~must)]


def steep_margin(search: Search, outcomes: Outcomes) -> Bounded:
    """b - a - delta."""
    return outcomes.hit[2] - outcomes.height_before - uploaded(search.params.steep_threshold, search.constants.device)


def joined_outcomes(parts: list[Outcomes]) -> Outcomes:
    """One list."""
    return Outcomes(
        **{
            n: np.concatenate([getattr(p, n) for p in parts])
            for n in ("fragment", "linear_index", "hit_index", "steep")
        },
        hit=[joined([p.hit[k] for p in parts]) for k in range(3)],
        height_before=joined([p.height_before for p in parts]),
    )
