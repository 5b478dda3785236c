"""What a search of one polygon is given, and where it writes what it finds (`compared`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.displacement.buffers import Hits, Uniforms
from ibr_ref.displacement.textures import Map


class Found(NamedTuple):
    """What a search finds, one element a fragment."""

    hits: Hits
    fetches: NDArray[np.int32]
    """Texture fetches of the search."""


class Sought(NamedTuple):
    """A search's inputs."""

    heights: Floats
    """(H, W), read-only."""
    height: Map
    """The same, flat."""
    repeat: bool | None
    """True or None, a type to the compiler: the map repeats, or it ends at its border."""
    points: Floats
    """(3, F): the fragments' points on the polygon; NaN between bands."""
    constants: Uniforms
    params: Any
    """Params, which a file with kernels does not name."""
    found: Found
    """Filled by the search: all discarded, and no fetches."""
    prepared: Callable[[tuple[Any, ...], Callable[[], Any]], Any]
    """What a search needs beforehand, by a key, made once for the polygon: `prepared`."""
