"""Cone maps of base polygons, as ports are given them: made once for each."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement.cones import cone_map
from ibr_ref.scene import BasePolygon

RELAXED = {"cone": False, "relaxed_cone": True}
"""Of the searches by cones: whether theirs are relaxed."""

_MADE: WeakKeyDictionary[BasePolygon, dict[str, NDArray[np.float64]]] = WeakKeyDictionary()


def cone_map_of(polygon: BasePolygon, method: str) -> NDArray[np.float64]:
    """Ratios (H, W) in (0, 1] for a search by cones: radius in (u, v) per height."""
    made = _MADE.setdefault(polygon, {})
    if method not in made:
        heights = np.asarray(polygon.height_map, np.float64)
        made[method] = cone_map(heights, polygon.domain == "repeat", RELAXED[method])
    return made[method]
