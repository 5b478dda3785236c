"""The stretch of each view ray that is searched (sections 3.1 and 3.2.2), with its bounds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded, exact, lerp
from ibr_ref.oracle.device import UNIT
from ibr_ref.oracle.referees.displacement.constants import Constants, Vector

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, eq=False)
class Rays:
    """p(t) from `start` at t = 0 to `end` at t = 1, (n,) components each."""

    start: Vector
    end: Vector
    may_go: Bools
    """The ray may lead down from the eye, as the paper's interval needs it."""
    must_go: Bools

    def at(self, rays: Ints, index: Ints, lattice: int) -> Vector:
        """p(k/K) of some rays, whether as B (1 - t) + A t or as B + (A - B) t."""
        t = fraction(index, lattice, self.start[0])
        return [lerp(start[rays], end[rays], t) for start, end in zip(self.start, self.end, strict=True)]


def fraction(index: Ints, lattice: int, like: Bounded) -> Bounded:
    """t = k/K as a quotient, or k times the rounded 1/K."""
    t = np.asarray(index / lattice, np.float64)
    return Bounded(t, (like.device.quotient + like.device.operation) * UNIT * t, like.device)


def towards(goal: Vector, w: float, point: Vector) -> Vector:
    """The way from points to a homogeneous goal."""
    if w == 1.0:
        return [g - p for g, p in zip(goal, point, strict=True)]
    zero = exact(np.zeros_like(point[0].value), goal[0].device)
    return [Bounded(g.value + zero.value, g.error + zero.value, g.device) for g in goal]


def paper_rays(constants: Constants, point: Vector) -> Rays:
    """From B on h = 1 to A on h = 0.

    Their h is 1 and 0 where a port takes 1 - t. Where it computes them as B_h = C_h + v_h ((1 - C_h)/v_h) the errors of C_h
    and v_h cancel; what remains is the quotient's rounding, the product's, that of 1 - C_h and that of the sum.
    """
    device = constants.device
    way = towards(constants.eye, constants.eye_w, point)
    one = exact(1.0, device)
    below, above = point[2] / way[2], (one - point[2]) / way[2]
    end = [c - v * below for c, v in zip(point[:2], way[:2], strict=True)]
    start = [c + v * above for c, v in zip(point[:2], way[:2], strict=True)]
    level = (device.quotient + 3.0 * device.operation) * UNIT
    nothing = np.zeros_like(point[2].value)
    return Rays(
        start=[*start, Bounded(nothing + 1.0, nothing + level, device)],
        end=[*end, Bounded(nothing, nothing + level, device)],
        may_go=way[2].high > 0.0,
        must_go=way[2].low > 0.0,
    )


def volume_rays(constants: Constants, point: Vector) -> Rays:
    """From where the ray enters the unit cube, or the eye if that is inside, to C."""
    device = constants.device
    way = towards(constants.eye, constants.eye_w, point)
    shares = [_share(x, v) for x, v in zip(point, way, strict=True)]
    values = np.stack([s.value for s in shares])
    axis = np.argmin(values, axis=0)
    low = reduce(np.minimum, [s.low for s in shares])
    high = reduce(np.minimum, [s.high for s in shares])
    share = values.min(axis=0)
    first = Bounded(share, np.maximum(high - share, share - low), device)
    eye_inside = constants.eye_w == 1.0 and all(0.0 <= x.value <= 1.0 for x in constants.eye)
    start = []
    for k in range(3):
        reached = point[k] + way[k] * first
        wall = Bounded(np.where(way[k].value > 0.0, 1.0, 0.0), np.zeros_like(share), device)
        certain = (axis == k) & ((values != share).sum(axis=0) == 2) & _alone(shares, k)
        # Where another wall may come first, the coordinate is the wall's or what is reached, which differ by rounding.
        value = np.where(axis == k, wall.value, reached.value)
        error = np.where(certain, 0.0, np.abs(reached.value - value) + reached.error)
        eye = constants.eye[k]
        start.append(Bounded(eye.value + 0.0 * share, eye.error + 0.0 * share, device) if eye_inside else
                     Bounded(value, error, device))  # fmt: skip
    always = np.ones_like(share, np.bool_)
    return Rays(start=start, end=point, may_go=always, must_go=always)


def _share(x: Bounded, way: Bounded) -> Bounded:
    """How much of the way it takes from x to the border ahead; infinite where it rests."""
    border = exact(np.where(way.value > 0.0, 1.0, 0.0), x.device)
    share = (border - x) / way
    resting = way.value == 0.0
    error = np.where(resting | np.isinf(share.error), 0.0, share.error)
    value = np.where(resting, np.inf, share.value)
    unclear = ~resting & np.isinf(share.error)  # the way's own error covers it: at least what its largest size takes
    least = np.abs(border.value - x.value) / np.where(unclear, way.size, 1.0)
    return Bounded(np.where(unclear, least, value), np.where(unclear, x.error / way.size, error), x.device)


def _alone(shares: Vector, k: int) -> Bools:
    """Whether axis k certainly comes first."""
    others = [s for i, s in enumerate(shares) if i != k]
    return np.asarray(shares[k].high < np.minimum(others[0].low, others[1].low), np.bool_)
