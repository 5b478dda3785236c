"""Patch space (u, v, h) of a base polygon, and the constants that the kernels get for it (their uniforms).

A world point is corner + u U + v V + h N3 with N3 = height_scale * n, so that the displaced volume is the unit cube.
The way back is the reciprocal basis of (U, V, N3). The eye and the light are homogeneous: w = 1 for a point, w = 0 for
a direction, and the vector from p towards them is xyz - w p. Everything in float64, sums from left to right.
"""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.displacement.buffers import Uniforms
from ibr_ref.scene import BasePolygon, Camera, Light
from ibr_ref.scene.vectors import cross, dot, length


def to_patch(rows: Floats, corner: Floats, homogeneous: Floats) -> Floats:
    """A homogeneous world point or direction in patch space."""
    offset = homogeneous[:3] - corner if homogeneous[3] == 1.0 else homogeneous[:3]
    return np.array([*(dot(row, offset) for row in rows), homogeneous[3]])


def _normal(polygon: BasePolygon) -> Floats:
    normal = cross(*polygon.arrays[1:])
    return normal / length(normal)


def edge_h(polygon: BasePolygon) -> Floats:
    """(3,) N3, the edge of the volume that stands on the polygon."""
    return polygon.height_scale * _normal(polygon)


def rows_of(polygon: BasePolygon) -> Floats:
    """(3, 3) the reciprocal basis: u, v and h of a world point are its rows times the vector from the corner."""
    _, edge_u, edge_v = polygon.arrays
    upwards = edge_h(polygon)
    across = cross(edge_v, upwards)
    det = dot(edge_u, across)
    return np.array([across / det, cross(upwards, edge_u) / det, cross(edge_u, edge_v) / det])


def uniforms(polygon: BasePolygon, camera: Camera, light: Light) -> Uniforms:
    """The constants of a polygon's draw call."""
    corner, edge_u, edge_v = polygon.arrays
    normal, rows = _normal(polygon), rows_of(polygon)
    tangent = edge_u / length(edge_u)
    light_world = light.homogeneous
    return Uniforms(
        corner=corner.copy(),
        axes=np.array([edge_u, edge_v, edge_h(polygon)]),
        rows=rows,
        frame=np.array([tangent, cross(normal, tangent), normal]),
        lengths=np.array([length(edge_u), length(edge_v)]),
        scale=polygon.height_scale,
        tile=np.array(polygon.facade_tile),
        eye=to_patch(rows, corner, camera.eye),
        light=to_patch(rows, corner, light_world),
        eye_world=camera.eye.copy(),
        light_world=light_world,
        phong=np.array([light.ambient, light.diffuse, light.specular]),
        exponent=light.exponent,
        view_from_world=camera.view_from_world.copy(),
        clip_from_view=camera.clip_from_view.copy(),
    )
