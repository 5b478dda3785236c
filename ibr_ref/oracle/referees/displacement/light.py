"""Self-shadow and Phong's light on a hit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement import Params
from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, power, unit, uploaded
from ibr_ref.oracle.accept.fetch import fetch
from ibr_ref.oracle.device import UNIT
from ibr_ref.oracle.referees.displacement.arrays import stacked
from ibr_ref.oracle.referees.displacement.constants import Constants, Vector, world_point
from ibr_ref.oracle.referees.displacement.rays import towards

Bools = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, eq=False)
class Lit:
    """Whether hits (n,) may lie in the light, and whether in self-shadow."""

    may: Bools
    may_not: Bools


def lit_of(constants: Constants, params: Params, hit: Vector) -> Lit:
    """The shadow's samples: one that may lie below the surface may shade, one that must does."""
    count = len(hit[0].value)
    everywhere, nowhere = np.ones(count, np.bool_), np.zeros(count, np.bool_)
    if not params.shadow_steps:
        return Lit(may=everywhere, may_not=nowhere)
    horizon = constants.light[2]
    if horizon.high <= 0.0:
        return Lit(may=nowhere, may_not=everywhere)
    way = towards(constants.light, constants.light_w, hit)
    share = stretch(constants, hit, way)
    may, must = nowhere.copy(), nowhere.copy()
    path = [x * share for x in way]
    open_ = np.flatnonzero(share.high > 0.0)
    for j in range(1, params.shadow_steps + 1):
        gap = shadow_gap(constants, params, hit, path, j, open_)
        may[open_] |= gap.high > 0.0
        must[open_] |= gap.low > 0.0
        open_ = open_[~must[open_]]
    return Lit(may=~must | (share.low <= 0.0), may_not=may | (horizon.low <= 0.0))


def shadow_gap(
    constants: Constants, params: Params, hit: Vector, path: Vector, j: int, some: NDArray[np.int64]
) -> Bounded:
    """H - (h + bias) at the sample j of S, for some of the hits."""
    device = constants.device
    f = j / (params.shadow_steps + 1)
    part = Bounded(np.array(f), np.array((device.quotient + device.operation) * UNIT * f), device)
    u, v, h = [x[some] + q[some] * part for x, q in zip(hit, path, strict=True)]
    level = h + uploaded(params.shadow_bias, device)
    height = constants.textures.height
    below = np.flatnonzero(level.low <= height.largest)
    value, error = np.full(len(some), -np.inf), np.zeros(len(some))
    if len(below):
        sample = fetch(height, u[below], v[below])
        value[below], error[below] = sample.value - level.value[below], sample.error + level.error[below]
    return Bounded(value, error, device)


def stretch(constants: Constants, hit: Vector, way: Vector) -> Bounded:
    """Share of the way to the light that lies inside the volume; 0 without a way."""
    device = constants.device
    axes = (2,) if constants.polygon.domain == "repeat" else (0, 1, 2)
    values, lows, highs = [], [], []
    if constants.light_w == 1.0:
        one = np.ones_like(hit[0].value)
        values, lows, highs = [one], [one], [one]
    for k in axes:
        border = exact(np.where(way[k].value > 0.0, 1.0, 0.0), device)
        distance = border - hit[k]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = distance / way[k]
            resting = way[k].value == 0.0
            unclear = ~np.isfinite(share.error) | resting
            values.append(np.where(resting, np.inf, share.value))
            # Where the way's error covers it, the border is no nearer than the way's largest size brings it.
            nearest = np.maximum(np.abs(distance.value) - distance.error, 0.0) / way[k].size
            lows.append(np.where(unclear, np.where(way[k].size > 0.0, nearest, np.inf), share.low))
            highs.append(np.where(unclear, np.inf, share.high))
    value, low, high = (reduce(np.minimum, ends) for ends in (values, lows, highs))
    finite = np.isfinite(value)
    error = np.where(finite, np.maximum(high - value, value - low), 0.0)
    return Bounded(np.where(finite, value, 0.0), error, device)


@dataclass(frozen=True, kw_only=True, eq=False)
class Colors:
    """(n,) colours; several of one surface are alternatives."""

    surface: NDArray[np.int64]
    color: Bounded
    """(n, 3)."""


def colors_of(constants: Constants, hit: Vector, albedo: Bounded, normal: Bounded, lit: Bools) -> Colors:
    """clamp(albedo (ambient + diffuse lit max(0, n.l)) + specular lit max(0, r.v)^e where n.l > 0)."""
    ambient, diffuse, specular = constants.phong
    n, one = [normal[:, k] for k in range(3)], exact(1.0, constants.device)
    world = world_point(constants, hit)
    to_light = unit(towards(constants.light_world, constants.light_w, world))
    cosine = dot(n, to_light)
    shadow = exact(lit.astype(np.float64), constants.device)
    # Sums are taken as a b + c 1: where products are not exact, that by 1 need not be.
    bright = dot([diffuse * shadow, ambient], [cosine.positive(), one])
    matte = albedo * stacked([bright] * 3) * one
    everything = np.arange(len(lit))
    if float(specular.value) == 0.0:
        return Colors(surface=everything, color=matte.between(0.0, 1.0))
    to_eye = unit(towards(constants.eye_world, constants.eye_w, world))
    shine = specular * shadow * power(_reflected(n, to_light, to_eye, cosine).positive(), constants.exponent)
    shiny = matte + stacked([shine * one] * 3)
    may, must = cosine.high > 0.0, cosine.low > 0.0
    front, back = np.flatnonzero(may), np.flatnonzero(~must)
    color = [shiny[front].between(0.0, 1.0), matte[back].between(0.0, 1.0)]
    return Colors(
        surface=np.concatenate([front, back]),
        color=Bounded(
            np.concatenate([c.value for c in color]), np.concatenate([c.error for c in color]), constants.device
        ),
    )


def _reflected(n: Vector, to_light: Vector, to_eye: Vector, cosine: Bounded) -> Bounded:
    """r.v with r = 2 (n.l) n - l, or 2 (n.l)(n.v) - l.v: the larger error counts."""
    twice = cosine * exact(2.0, cosine.device)
    ours = dot([twice * a - b for a, b in zip(n, to_light, strict=True)], to_eye)
    other = twice * dot(n, to_eye) - dot(to_light, to_eye)
    return Bounded(ours.value, np.maximum(ours.error, np.abs(other.value - ours.value) + other.error), ours.device)
