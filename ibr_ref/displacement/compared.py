"""The systems that the paper compares with (its table 1), and three later ones: their searches, on the base face alone.

Each has a kernel of its own, compiled when it is first asked for (`ibr_ref.searches`). It is given all fragments' points on
the polygon, and finds their hits; `fragment.draw` takes fragments and hits from there as from any other search.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.displacement.buffers import Fragments, Hits, Uniforms
from ibr_ref.displacement.inputs import Params
from ibr_ref.displacement.prepared import prepared
from ibr_ref.displacement.sought import Found, Sought
from ibr_ref.displacement.textures import Map
from ibr_ref.methods import Room
from ibr_ref.scene import BasePolygon


def search(
    room: Room, params: Params, polygon: BasePolygon, height: Map, constants: Uniforms, fragments: Fragments
) -> Found:
    """The hits of all fragments of a polygon's base face."""
    count = len(fragments.pixel)
    sought = Sought(
        heights=np.asarray(polygon.height_map, np.float64),
        height=height,
        repeat=True if polygon.domain == "repeat" else None,
        points=fragments.patch,
        constants=constants,
        params=params,
        found=Found(_no_hits(count), np.zeros(count, np.int32)),
        prepared=partial(prepared, polygon),
    )
    room.open().search(sought)
    return sought.found


def _no_hits(count: int) -> Hits:
    """Hits that are all discarded; no decision was close."""

    def full(value: float) -> Floats:
        return np.full(count, value)

    return Hits(
        linear_index=np.full(count, -1, np.int32),
        hit_index=np.full(count, -1, np.int32),
        u=full(np.nan),
        v=full(np.nan),
        h=full(np.nan),
        height_before=full(0.0),
        steep=np.zeros(count, np.bool_),
        margin=full(np.inf),
        domain_margin=full(np.inf),
        steep_margin=full(np.inf),
        depth=full(np.nan),
    )
