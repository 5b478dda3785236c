"""Shaded hits: what each legal outcome looks like, and which of them a pixel may show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement import Params
from ibr_ref.oracle.accept.bounded import Bounded, exact
from ibr_ref.oracle.accept.winners import Winners, winners
from ibr_ref.oracle.referees.displacement.arrays import joined
from ibr_ref.oracle.referees.displacement.constants import Constants
from ibr_ref.oracle.referees.displacement.hits import CHUNK, Hits
from ibr_ref.oracle.referees.displacement.light import colors_of, lit_of
from ibr_ref.oracle.referees.displacement.shade import surfaces_of

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, eq=False)
class Shades:
    """(n,) legal outcomes of the shading of hits."""

    hit: Ints
    """Index of the hit."""
    albedo: Bounded
    """(n, 3)."""
    normal: Bounded
    """(n, 3)."""
    lit: Bools

    def take(self, index: Ints | Bools) -> Shades:
        """Some of them."""
        return Shades(**{f.name: getattr(self, f.name)[index] for f in fields(self)})


def shades_of(constants: Sequence[Constants], params: Params, hits: Hits) -> Shades:
    """The legal looks of all kept hits."""
    parts = []
    for polygon, each in enumerate(constants):
        mine = np.flatnonzero((hits.polygon == polygon) & hits.kept)
        for first in range(0, len(mine), CHUNK):
            index = mine[first : first + CHUNK]
            hit = [hits.hit[index, k] for k in range(3)]
            surfaces = surfaces_of(each, hit, hits.steep[index])
            lit = lit_of(each, params, hit)
            for value, may in ((True, lit.may), (False, lit.may_not)):
                some = surfaces.take(may[surfaces.hit])
                truth = np.full(len(some.hit), value)
                parts.append(Shades(hit=index[some.hit], albedo=some.albedo, normal=some.normal, lit=truth))
    if not parts:
        nothing = exact(np.empty((0, 3)), hits.hit.device)
        empty = np.empty(0, np.int64)
        return Shades(hit=empty, albedo=nothing, normal=nothing, lit=empty > 0)
    return joined_shades(parts)


def joined_shades(parts: Sequence[Shades]) -> Shades:
    """One list."""
    return Shades(
        hit=np.concatenate([p.hit for p in parts]),
        albedo=joined([p.albedo for p in parts]),
        normal=joined([p.normal for p in parts]),
        lit=np.concatenate([p.lit for p in parts]),
    )


def lighted(constants: Sequence[Constants], hits: Hits, shades: Shades) -> tuple[Ints, Bounded]:
    """Colours (n, 3) of shades, and of which shade each is."""
    index, colors = [np.empty(0, np.int64)], [exact(np.empty((0, 3)), hits.hit.device)]
    for polygon, each in enumerate(constants):
        mine = np.flatnonzero(hits.polygon[shades.hit] == polygon)
        for first in range(0, len(mine), CHUNK):
            some = mine[first : first + CHUNK]
            at = shades.hit[some]
            hit = [hits.hit[at, k] for k in range(3)]
            found = colors_of(each, hit, shades.albedo[some], shades.normal[some], shades.lit[some])
            index.append(some[found.surface])
            colors.append(found.color)
    return np.concatenate(index), joined(colors)


def winners_of(hits: Hits, polygons: int, pixels: int) -> Winners:
    """Which outcomes their pixels may show: the depth test between polygons."""
    depth = hits.depth.widened(hits.depth.device.depth_step)
    return winners(hits.pixel, hits.certain, depth.low, depth.high, pixels, owner=hits.pixel * polygons + hits.polygon)
