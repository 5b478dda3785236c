"""Where in the world displaced polygons are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement.inputs import Params
from ibr_ref.displacement.patch_space import edge_h, rows_of, to_patch
from ibr_ref.displacement.vertex import extended_base
from ibr_ref.scene import BasePolygon, Camera

_CORNERS = np.array([(u, v) for u in (0.0, 1.0) for v in (0.0, 1.0)])


def bounding_points(
    polygons: Sequence[BasePolygon], camera: Camera, params: Params | None = None
) -> NDArray[np.float64]:
    """(N, 3) points in world space whose convex hull holds all that is drawn: `camera.fitted` takes them.

    The corners of the displaced volumes, from -1 where a method's shapes sink, and with faces="extended" those of the base
    as the camera's eye has it.
    """
    params = Params() if params is None else params
    sinks = params.method not in ("protruded", "exact")
    heights = (-1.0, 0.0, 1.0) if sinks else (0.0, 1.0)
    points = []
    for polygon in polygons:
        corner, edge_u, edge_v = polygon.arrays
        axes = np.array([edge_u, edge_v, edge_h(polygon)])
        corners = [(u, v, h) for u, v in _CORNERS.tolist() for h in heights]
        if params.drawn_faces == "extended":
            eye = to_patch(rows_of(polygon), corner, camera.eye)
            if eye[2] > eye[3]:  # otherwise `render` says that it may not be
                corners += extended_base(eye).tolist()
        points += [corner + u * axes[0] + v * axes[1] + h * axes[2] for u, v, h in corners]
    return np.array(points)
