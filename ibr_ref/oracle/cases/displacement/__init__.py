"""The cases of displacement mapping. Together they show every feature of the method that a port can get wrong.

Cameras are chosen so that float32 cannot turn many pixels: no corner of a face lies near the middle between two subpixels,
roofs lie between the lattice's heights, thresholds off it, and no background halfway between two bytes. Each test of a case
says how many pixels are left open.
"""

from __future__ import annotations

from collections.abc import Callable

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.cases.displacement import features, limits, searches

__all__ = ["CASES"]

CASES: dict[str, Callable[[], Case]] = {
    f"displacement-{make.__name__}": make
    for make in (
        features.box, features.mapped, features.dusk, features.slope, features.city, features.extended,
        features.tiles, features.beside, features.lamp, features.filtered, features.loose, limits.street,
        limits.planes, limits.low, limits.crossing, limits.borders, limits.rim, limits.sliver,
        searches.relief, searches.parallax, searches.steep, searches.occlusion, searches.cone,
        searches.relaxed, searches.distance, searches.quadtree, features.metropolis,
    )
}  # fmt: skip
"""By name."""
