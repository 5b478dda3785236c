"""What is made of a polygon's maps beforehand, once for as long as it lives: for its pictures, and for ports."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary

from ibr_ref.scene import BasePolygon

_KEPT: WeakKeyDictionary[BasePolygon, dict[tuple[Any, ...], Any]] = WeakKeyDictionary()
"""A polygon is frozen, and so are its maps."""


def prepared(polygon: BasePolygon, key: tuple[Any, ...], make: Callable[[], Any]) -> Any:
    """A mip chain, distances, cones, a quadtree; the key says which."""
    kept = _KEPT.setdefault(polygon, {})
    if key not in kept:
        kept[key] = make()
    return kept[key]
