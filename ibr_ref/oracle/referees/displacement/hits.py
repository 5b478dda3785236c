"""Outcomes of fragments of all polygons: where they lie in the window, and what is discarded before the near plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement import Params
from ibr_ref.oracle.accept.bounded import Bounded, exact
from ibr_ref.oracle.referees.displacement.arrays import joined, stacked
from ibr_ref.oracle.referees.displacement.constants import Constants, Vector, clip_point
from ibr_ref.oracle.referees.displacement.march import Outcomes, outcomes_of, search_of
from ibr_ref.oracle.referees.displacement.raster import Fragments

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

CHUNK = 1 << 14
"""Fragments that are followed at a time: their arrays stay in the cache."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Hits:
    """(n,) legal outcomes of the march of fragments."""

    pixel: Ints
    polygon: Ints
    face: Ints
    certain: Bools
    """The fragment is there whatever the device does (see `Fragments`)."""
    point: Bounded
    """(n, 3) C."""
    linear_index: Ints
    hit_index: Ints
    hit: Bounded
    """(n, 3)."""
    height_before: Bounded
    steep: Bools
    depth: Bounded
    """Window depth; infinite where discarded."""

    def __len__(self) -> int:
        return len(self.pixel)

    def take(self, index: Ints | Bools | slice) -> Hits:
        """Some of them."""
        return Hits(**{f.name: getattr(self, f.name)[index] for f in fields(self)})

    @property
    def kept(self) -> Bools:
        """Whether anything was hit."""
        return self.hit_index >= 0


def hits_of(constants: Sequence[Constants], params: Params, fragments: Fragments) -> tuple[Hits, Ints]:
    """The legal outcomes of all fragments, and the pixels of those that have too many."""
    parts, lost = [], []
    for polygon, each in enumerate(constants):
        mine = np.flatnonzero(fragments.polygon == polygon)
        for first in range(0, len(mine), CHUNK):
            some = fragments.take(mine[first : first + CHUNK])
            outcomes, many = outcomes_of(search_of(each, params, [some.point[:, k] for k in range(3)]))
            parts += _projected(each, params, some, outcomes)
            lost.append(some.pixel[many])
    if not parts:
        nothing = np.empty(0, np.int64)
        return no_hits(fragments), nothing
    return joined_hits(parts), np.unique(np.concatenate(lost))


def no_hits(fragments: Fragments) -> Hits:
    """An empty list."""
    nothing, device = np.empty(0), fragments.point.device
    scalar, triple = exact(nothing, device), exact(np.empty((0, 3)), device)
    index, flag = nothing.astype(np.int64), nothing.astype(np.bool_)
    return Hits(pixel=index, polygon=index, face=index, certain=flag, point=triple, linear_index=index,
                hit_index=index, hit=triple, height_before=scalar, steep=flag, depth=scalar)  # fmt: skip


def _projected(constants: Constants, params: Params, fragments: Fragments, outcomes: Outcomes) -> list[Hits]:
    """The outcomes with their depths; one before the near plane is discarded, one at it may be."""
    at, device = outcomes.fragment, constants.device
    z, depth = window_depth(constants, outcomes.hit)
    if params.depth == "polygon":
        depth = fragments.depth[at]
    hits = Hits(
        pixel=fragments.pixel[at],
        polygon=fragments.polygon[at],
        face=fragments.face[at],
        certain=fragments.certain[at],
        point=fragments.point[at],
        linear_index=outcomes.linear_index,
        hit_index=outcomes.hit_index,
        hit=stacked(outcomes.hit),
        height_before=outcomes.height_before,
        steep=outcomes.steep,
        depth=depth,
    )
    none = hits.hit_index < 0
    cut = hits.take(~none & (z.low < 0.0))
    nowhere = Bounded(np.full(len(cut), np.inf), np.zeros(len(cut)), device)
    cut = replace(
        cut,
        linear_index=np.full(len(cut), -1),
        hit_index=np.full(len(cut), -1),
        hit=exact(np.full((len(cut), 3), np.nan), device),
        height_before=exact(np.zeros(len(cut)), device),
        steep=np.zeros(len(cut), np.bool_),
        depth=nowhere,
    )
    missed = hits.take(none)
    missed = replace(missed, depth=exact(np.full(len(missed), np.inf), device))
    return [hits.take(~none & ~(z.high < 0.0)), missed, cut]


def window_depth(constants: Constants, hit: Vector) -> tuple[Bounded, Bounded]:
    """Clip z and window depth of points in patch space."""
    _, _, z, w = clip_point(constants, hit)
    return z, z / w


def joined_hits(parts: Sequence[Hits]) -> Hits:
    """One list."""
    columns: dict[str, Any] = {}
    for field in fields(Hits):
        values = [getattr(p, field.name) for p in parts]
        columns[field.name] = joined(values) if isinstance(values[0], Bounded) else np.concatenate(values)
    return Hits(**columns)
