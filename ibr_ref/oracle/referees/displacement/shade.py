"""Stage shade: albedo, normal and light of a hit, with every decision that rounding may turn (sections 3.1 and 4.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, opposite, unit
from ibr_ref.oracle.accept.fetch import Texture, fetch
from ibr_ref.oracle.referees.displacement.arrays import joined, stacked
from ibr_ref.oracle.referees.displacement.constants import Constants, Vector
from ibr_ref.oracle.referees.displacement.rays import towards

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

LEAST_DIFFERENCE = 2.0**-16
"""A smaller difference of heights counts as 0 (displacement/method.md, "Gradients")."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Surfaces:
    """(n,) what hits may look like; several of one hit are alternatives."""

    hit: Ints
    albedo: Bounded
    """(n, 3)."""
    normal: Bounded
    """(n, 3)."""

    def take(self, index: Ints | Bools) -> Surfaces:
        """Some of them."""
        return Surfaces(hit=self.hit[index], albedo=self.albedo[index], normal=self.normal[index])


@dataclass(frozen=True, kw_only=True, eq=False)
class Slope:
    """The gradient of the height map."""

    along: Vector
    """g_u and g_v."""
    may_vanish: Bools
    """Both may be 0."""
    must_vanish: Bools


def surfaces_of(constants: Constants, hit: Vector, steep: Bools) -> Surfaces:
    """Albedo and normal of hits (u, v, h): all alternatives."""
    maps = constants.textures
    walls = steep if maps.facade is not None else np.zeros_like(steep)
    plain, wall = np.flatnonzero(~walls), np.flatnonzero(walls)
    return joined_surfaces([_plain(constants, plain, [x[plain] for x in hit]), *_walls(constants, wall, hit)])


def _plain(constants: Constants, index: Ints, hit: Vector) -> Surfaces:
    u, v, _ = hit
    normal = height_normal(constants, hit) if constants.textures.normal is None else _mapped_normal(constants, u, v)
    return Surfaces(hit=index, albedo=fetch(constants.textures.color, u, v), normal=normal)


def _mapped_normal(constants: Constants, u: Bounded, v: Bounded) -> Bounded:
    """2 c - 1 in the frame of the polygon, normalized; n where it is zero."""
    assert constants.textures.normal is not None
    device = constants.device
    code = fetch(constants.textures.normal, u, v) * exact(2.0, device) - exact(1.0, device)
    parts = [code[:, i] for i in range(3)]
    return _unit([dot(parts, [axis[k] for axis in constants.frame]) for k in range(3)], constants.frame[2])


def height_normal(constants: Constants, hit: Vector) -> Bounded:
    """normalize(n - s (g_u U* + g_v V*)), or as the cross product (U + g_u s n) x (V + g_v s n).

    Written out, the cross product is U x V + g_u s n x V + g_v U x s n: sums of the same three terms, each times the area,
    with two products and a difference in place of a product. The larger error of the two counts.
    """
    g = slope(constants, hit).along
    n, scale = constants.frame[2], constants.scale
    uphill = [dot(g, [row[k] for row in constants.rows[:2]]) for k in range(3)]
    ours = _unit([n[k] - scale * uphill[k] for k in range(3)], n)
    edge_u, edge_v, rise = constants.axes
    tangents = [
        [a + x * b for a, b in zip(edge, rise, strict=True)] for x, edge in zip(g, (edge_u, edge_v), strict=True)
    ]
    crossed = [tangents[0][i] * tangents[1][j] - tangents[0][j] * tangents[1][i] for i, j in ((1, 2), (2, 0), (0, 1))]
    other = _unit(crossed, n)
    return Bounded(ours.value, np.maximum(ours.error, np.abs(other.value - ours.value) + other.error), ours.device)


def slope(constants: Constants, hit: Vector) -> Slope:
    """Central differences one texel apart; a difference that may be below the threshold may be 0."""
    height, device = constants.textures.height, constants.device
    u, v = hit[:2]
    along, may, must = [], np.ones_like(u.value, np.bool_), np.ones_like(u.value, np.bool_)
    for axis, size in ((0, height.texels.shape[1]), (1, height.texels.shape[0])):
        step = exact(1.0, device) / exact(float(size), device)
        difference = _sample(height, u, v, axis, step) - _sample(height, u, v, axis, -step)
        may_zero = np.abs(difference.value) - difference.error < LEAST_DIFFERENCE
        must_zero = np.abs(difference.value) + difference.error < LEAST_DIFFERENCE
        value = np.where(np.abs(difference.value) < LEAST_DIFFERENCE, 0.0, difference.value)
        low, high = (np.where(must_zero, 0.0, end) for end in (difference.low, difference.high))
        low, high = np.where(may_zero, np.minimum(low, 0.0), low), np.where(may_zero, np.maximum(high, 0.0), high)
        bounded = Bounded(value, np.maximum(high - value, value - low), device)
        along.append(bounded * exact(float(size), device) * exact(0.5, device))
        may, must = may & may_zero, must & must_zero
    return Slope(along=along, may_vanish=may, must_vanish=must)


def _sample(height: Texture, u: Bounded, v: Bounded, axis: int, step: Bounded) -> Bounded:
    return fetch(height, u + step, v) if axis == 0 else fetch(height, u, v + step)


def _walls(constants: Constants, index: Ints, hit: Vector) -> list[Surfaces]:
    """Steep hits: the facade, by where the wall faces."""
    if not len(index):
        return []
    hit = [x[index] for x in hit]
    g = slope(constants, hit)
    uphill = [dot(g.along, [row[k] for row in constants.rows[:2]]) for k in range(3)]
    sides = [g.along[k].absolute() / constants.lengths[k] for k in range(2)]
    sloped = _facing(constants, index, hit, ~g.must_vanish, sides, _unit([-x for x in uphill], constants.frame[2]))
    if not g.may_vanish.any():
        return sloped
    d = towards(constants.eye[:2], constants.eye_w, hit[:2])
    level = _unit([dot(d, [axis[k] for axis in constants.axes[:2]]) for k in range(3)], constants.frame[2])
    sides = [d[k].absolute() * constants.lengths[k] for k in range(2)]
    return sloped + _facing(constants, index, hit, g.may_vanish, sides, level)


def _facing(
    constants: Constants, index: Ints, hit: Vector, which: Bools, sides: Vector, normal: Bounded
) -> list[Surfaces]:
    """The facade on walls that face u, and on those that face v: both where that is a matter of rounding."""
    result = []
    margin = sides[0] - sides[1]
    for faces_u, may in ((True, margin.high >= 0.0), (False, margin.low < 0.0)):
        some = np.flatnonzero(which & may)
        along = hit[1][some] * constants.lengths[1] if faces_u else hit[0][some] * constants.lengths[0]
        across, up = along / constants.tile[0], -(hit[2][some] * constants.scale) / constants.tile[1]
        facade = constants.textures.facade
        assert facade is not None
        result.append(Surfaces(hit=index[some], albedo=fetch(facade, across, up), normal=normal[some]))
    return result


def _unit(a: Vector, instead: Vector) -> Bounded:
    """(n, 3) a vector divided by its length; `instead` where it is zero, and anything where it may be."""
    length = stacked(a).value
    zero = (length == 0.0).all(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        result = stacked(unit(a))
    value = np.where(zero[..., None], stacked(instead).value, result.value)
    anything = opposite(result.device)
    error = np.fmin(result.error, anything)
    return Bounded(value, np.where(zero[..., None], anything, error), result.device)


def joined_surfaces(parts: list[Surfaces]) -> Surfaces:
    """One list."""
    return Surfaces(
        hit=np.concatenate([p.hit for p in parts]),
        albedo=joined([p.albedo for p in parts]),
        normal=joined([p.normal for p in parts]),
    )
