"""The systems that the paper compares with (its table 1), and three later ones: their searches, on the base face alone.

Each has a kernel of its own, compiled when it is first asked for (`ibr_ref.searches`). It is given the point of every pixel
on the polygon, and finds the hit there; `fragment.draw` takes it from there as from any other search.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.displacement.buffers import Hits, Uniforms
from ibr_ref.displacement.inputs import Params
from ibr_ref.displacement.prepared import prepared
from ibr_ref.displacement.raster import base_points
from ibr_ref.displacement.sought import Found, Sought
from ibr_ref.displacement.textures import Map
from ibr_ref.methods import Room
from ibr_ref.scene import BasePolygon


def search(
    room: Room,
    params: Params,
    polygon: BasePolygon,
    height: Map,
    constants: Uniforms,
    triangles: Any,
    width: int,
    rows: int,
) -> Found:
    """The hits of a polygon's base face, `triangles`, in a picture of so many columns and rows of pixels."""
    pixels = width * rows
    points = np.full((3, pixels), np.nan)
    base_points(triangles, width, rows, points)
    sought = Sought(
        heights=np.asarray(polygon.height_map, np.float64),
        height=height,
        repeat=True if polygon.domain == "repeat" else None,
        points=points,
        constants=constants,
        params=params,
        found=Found(_no_hits(pixels), np.zeros(pixels, np.int32)),
        prepared=partial(prepared, polygon),
    )
    room.open().search(sought)
    return sought.found


def _no_hits(pixels: int) -> Hits:
    """Hits that are all discarded; no decision was close."""

    def full(value: float) -> Floats:
        return np.full(pixels, value)

    return Hits(
        linear_index=np.full(pixels, -1, np.int32),
        hit_index=np.full(pixels, -1, np.int32),
        u=full(np.nan),
        v=full(np.nan),
        h=full(np.nan),
        height_before=full(0.0),
        steep=np.zeros(pixels, np.bool_),
        margin=full(np.inf),
        domain_margin=full(np.inf),
        steep_margin=full(np.inf),
        depth=full(np.nan),
    )
