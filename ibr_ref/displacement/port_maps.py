"""Maps that ports are given besides the scene's, as some searches need them: the very ones that the reference has."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.displacement.cones import cone_map
from ibr_ref.displacement.donnelly import distance_texture
from ibr_ref.displacement.prepared import prepared
from ibr_ref.displacement.quadtree import Quadtree, build
from ibr_ref.scene import BasePolygon

RELAXED = {"cone": False, "relaxed_cone": True}
"""Of the searches by cones: whether theirs are relaxed."""


def cone_map_of(polygon: BasePolygon, method: str) -> Floats:
    """Ratios (H, W) in (0, 1] for a search by cones: radius in (u, v) per height."""
    relaxed = RELAXED[method]
    found: Floats = prepared(
        polygon, ("cones", relaxed), lambda: cone_map(_heights(polygon), _repeats(polygon), relaxed)
    )
    return found


def distance_map_of(polygon: BasePolygon, layers: int) -> Floats:
    """Distances (layers, H, W) for Donnelly's search, from the top down, in units of the texture's space."""
    found: Floats = prepared(
        polygon, ("distances", layers), lambda: distance_texture(_heights(polygon), layers, _repeats(polygon))
    )
    return found


def quadtree_of(polygon: BasePolygon) -> Quadtree:
    """The maxima of a height map, all levels, the finest first."""
    found: Quadtree = prepared(polygon, ("quadtree",), lambda: build(_heights(polygon), _repeats(polygon)))
    return found


def levels_of(polygon: BasePolygon) -> list[NDArray[np.float64]]:
    """The same, an array (rows, columns) a level."""
    tree = quadtree_of(polygon)
    sizes = zip(tree.offsets.tolist(), tree.rows.tolist(), tree.columns.tolist(), strict=True)
    return [tree.values[first : first + rows * columns].reshape(rows, columns) for first, rows, columns in sizes]


def _heights(polygon: BasePolygon) -> Floats:
    return np.asarray(polygon.height_map, np.float64)


def _repeats(polygon: BasePolygon) -> bool:
    return polygon.domain == "repeat"
