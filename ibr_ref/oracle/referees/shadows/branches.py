"""Every branch of every open decision of a fragment, enumerated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.referees.shadows import resolve
from ibr_ref.oracle.referees.shadows.accumulate import accumulated
from ibr_ref.oracle.referees.shadows.maps import VISIBLE
from ibr_ref.oracle.referees.shadows.model import Model
from ibr_ref.oracle.referees.shadows.project import Shadow
from ibr_ref.oracle.referees.shadows.surface import Seen

MOST_OPEN = 6
"""Open decisions of a fragment that are followed, 64 branches; a fragment with more is accepted and counted as undecided."""


@dataclass(frozen=True, eq=False)
class Branches:
    """Outcomes (m,): the fragment, its shadow, and which side of it is lit. The first n are as exact arithmetic has it."""

    fragment: Ints
    shadow: Bounded
    turned: Bools
    crowded: Bools
    """(n,) fragments with more decisions than are followed."""


def branches(model: Model, seen: Seen, shadows: Sequence[Shadow]) -> Branches:
    """Every combination of the samples' outcomes, and of the sides that the eye may be on."""
    device, count = seen.depth.device, len(seen.pixel)
    base = accumulated(model, [s.first for s in shadows])
    open_ = np.stack([s.open for s in shadows], axis=1)
    number, lost = open_.sum(axis=1), np.logical_or.reduce([s.spoiled for s in shadows])
    fragments, values, errors = [np.arange(count)], [base.value], [np.broadcast_to(base.error, base.value.shape)]
    for m in range(1, MOST_OPEN + 1):
        mine = np.flatnonzero(number == m)
        if not len(mine):
            continue
        which = np.nonzero(open_[mine])[1].reshape(-1, m)
        for taken in list(product((False, True), repeat=m))[1:]:
            total = accumulated(model, _choice(shadows, mine, which, taken))
            fragments.append(mine)
            values.append(total.value)
            errors.append(total.error)
    fragment = np.concatenate(fragments)
    summed = Bounded(np.concatenate(values), np.concatenate(errors), device)
    both = np.flatnonzero(seen.edge_on[fragment])
    turned = np.r_[np.zeros(len(fragment), np.bool_), np.ones(len(both), np.bool_)]
    every = np.r_[np.arange(len(fragment)), both]
    return Branches(fragment[every], summed[every], turned, (number > MOST_OPEN) | lost)


def _choice(shadows: Sequence[Shadow], mine: Ints, which: Ints, taken: Sequence[bool]) -> list[Bounded]:
    """The samples' shadows of some fragments, with the other outcome where it is taken."""
    result = []
    for i, sample in enumerate(shadows):
        other = ((which == i) & np.array(taken)).any(axis=1)
        result.append(sample.other[mine].where(other, sample.first[mine]))
    return result


def in_shadow(seen: Seen, shadow: Bounded) -> Branches:
    """One shadow (n,) for each fragment; both sides where the eye may be on either."""
    count = len(seen.pixel)
    both = np.flatnonzero(seen.edge_on)
    every = np.r_[np.arange(count), both]
    turned = np.r_[np.zeros(count, np.bool_), np.ones(len(both), np.bool_)]
    return Branches(every, shadow[every], turned, np.zeros(count, np.bool_))


def spread(model: Model, seen: Seen, found: Branches, color: list[Bounded]) -> tuple[Bools, Floats]:
    """(H W,) whether another outcome shows, and the width of the widest outcome."""
    pixels = len(seen.empty)
    count, pixel = len(seen.pixel), seen.pixel[found.fragment]
    undecided, widths = np.zeros(pixels, np.bool_), np.zeros(pixels)
    nothing = resolve.background(model)
    for channel, empty in zip(color, nothing, strict=True):
        error = np.broadcast_to(channel.error, channel.value.shape)
        first_low, first_high = (np.full(pixels, float(end[0])) for end in (empty.low, empty.high))
        some = seen.first >= 0
        first_low[some], first_high[some] = (
            channel.low[:count][seen.first[some]],
            channel.high[:count][seen.first[some]],
        )
        out = (first_low[pixel] - channel.low > VISIBLE) | (channel.high - first_high[pixel] > VISIBLE)
        undecided[pixel[out]] = True
        gap = (first_low - empty.high > VISIBLE) | (empty.low - first_high > VISIBLE)
        undecided |= seen.empty & gap
        np.maximum.at(widths, pixel, 2.0 * error)
    return undecided, widths
