"""Distance maps of base polygons, as ports are given them: made once for each."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement.donnelly import distance_texture
from ibr_ref.scene import BasePolygon

_MADE: WeakKeyDictionary[BasePolygon, dict[int, NDArray[np.float64]]] = WeakKeyDictionary()


def distance_map_of(polygon: BasePolygon, layers: int) -> NDArray[np.float64]:
    """Distances (layers, H, W) for Donnelly's search, from the top down, in units of the texture's space."""
    made = _MADE.setdefault(polygon, {})
    if layers not in made:
        heights = np.asarray(polygon.height_map, np.float64)
        made[layers] = distance_texture(heights, layers, polygon.domain == "repeat")
    return made[layers]
