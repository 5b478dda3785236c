"""Quadtrees of base polygons, as ports are given them: made once for each."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement.maximum_mipmap import Quadtree, build
from ibr_ref.scene import BasePolygon

_MADE: WeakKeyDictionary[BasePolygon, Quadtree] = WeakKeyDictionary()


def quadtree_of(polygon: BasePolygon) -> Quadtree:
    """The maxima of a height map, all levels, the finest first."""
    if polygon not in _MADE:
        _MADE[polygon] = build(np.asarray(polygon.height_map, np.float64), polygon.domain == "repeat")
    return _MADE[polygon]


def levels_of(polygon: BasePolygon) -> list[NDArray[np.float64]]:
    """The same, an array (rows, columns) a level."""
    tree = quadtree_of(polygon)
    sizes = zip(tree.offsets.tolist(), tree.rows.tolist(), tree.columns.tolist(), strict=True)
    return [tree.values[first : first + rows * columns].reshape(rows, columns) for first, rows, columns in sizes]
