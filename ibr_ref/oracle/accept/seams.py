"""Where two triangles share an edge: a pixel that may lie on either side of it belongs to one of them, for certain.

Both triangles have the same two corners there, which a device snaps once: the pixel's centre is on one side of the snapped
edge, or on it and by the top-left rule of one triangle. Taken alone neither is certain, and what lies behind would seem
to show through every surface of triangles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.coverage import Fragments


@dataclass(frozen=True, eq=False)
class Owners:
    """Fragments (n,) of which one of a pair comes about."""

    owner: Ints
    """The first fragment of the pair; itself where it has no partner."""
    drawn: Bools
    """The fragment or its partner is drawn by every legal device."""


def owners(found: Fragments, vertices: NDArray[np.integer], width: int) -> Owners:
    """Pair the fragments of triangles with these vertices (T, 3): where vertices have one number, they are one point."""
    count = len(found.triangle)
    owner, drawn = np.arange(count), found.certain.copy()
    open_edges = ~found.inside
    alone = np.flatnonzero(open_edges.sum(axis=1) == 1)
    edge = np.argmax(open_edges[alone], axis=1)
    names = vertices[found.triangle[alone]].astype(np.int64)
    steps = np.arange(len(alone))
    a, b = names[steps, (edge + 1) % 3], names[steps, (edge + 2) % 3]
    side = (a > b) ^ found.turned[alone]
    pixel = found.rows[alone] * width + found.columns[alone]
    keys = np.stack([pixel, np.minimum(a, b), np.maximum(a, b)])
    order = np.lexsort(keys[::-1])
    keys, side, alone = keys[:, order], side[order], alone[order]
    same = (keys[:, 1:] == keys[:, :-1]).all(axis=0)
    pair = same & (side[1:] != side[:-1])
    pair[1:] &= ~same[:-1]  # where three or more triangles share an edge, none is certain
    pair[:-1] &= ~same[1:]
    first, second = alone[:-1][pair], alone[1:][pair]
    owner[np.maximum(first, second)] = np.minimum(first, second)
    drawn[first] = drawn[second] = True
    return Owners(owner, drawn)


def loose(found: Fragments, pixel: Ints, vertices: NDArray[np.integer], drawn: Bools) -> Bools:
    """(n,) whether a fragment's pixel may lie beyond an edge where nothing else covers it; drawn (T,): triangles.

    A pixel near an edge of two triangles is covered by one of them, whichever it is, if it may be covered by both. Where
    none is on the other side, or one that is so thin that the pixel lies beyond it too, there may be nothing.
    """
    names = vertices.astype(np.int64)
    a, b = names[:, [1, 2, 0]], names[:, [2, 0, 1]]
    count = int(names.max(initial=0)) + 1
    edge, forward = np.minimum(a, b) * count + np.maximum(a, b), a < b
    _, number = np.unique(edge, return_inverse=True)
    number = number.reshape(edge.shape)
    key = 2 * (pixel[:, None] * (int(number.max(initial=0)) + 1) + number[found.triangle])
    key += forward[found.triangle] ^ found.turned[:, None]
    unsure = ~found.inside
    there = drawn[found.triangle] & np.isin(pixel, pixel[unsure.any(axis=1)])
    return np.asarray((unsure & ~np.isin(key ^ 1, key[there])).any(axis=1), np.bool_)
