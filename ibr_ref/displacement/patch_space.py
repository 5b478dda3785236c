"""Patch space (u, v, h) of a base polygon, and the constants that the kernels get for it (their uniforms).

A world point is corner + u U + v V + h N3 with N3 = height_scale * n, so that the displaced volume is the unit cube.
The way back is the reciprocal basis of (U, V, N3). The eye and the light are homogeneous: w = 1 for a point, w = 0 for
a direction, and the vector from p towards them is xyz - w p. Everything in float64, sums from left to right.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.scene import BasePolygon, Camera, Light

Array = NDArray[np.float64]


class Uniforms(NamedTuple):
    """Constants of one polygon's draw call."""

    corner: Array
    """(3,) world."""
    axes: Array
    """(3, 3): U, V and N3 as rows, world."""
    rows: Array
    """(3, 3): the reciprocal basis as rows; the first two are U* and V*."""
    frame: Array
    """(3, 3): U/|U|, n x U/|U| and n as rows: the frame of the normal map."""
    lengths: Array
    """(2,): |U| and |V|."""
    scale: float
    """World units of h = 1."""
    tile: Array
    """(2,): width and height of a facade tile, world units."""
    eye: Array
    """(4,) in patch space."""
    light: Array
    """(4,) in patch space."""
    eye_world: Array
    """(4,)."""
    light_world: Array
    """(4,)."""
    phong: Array
    """(3,): ambient, diffuse, specular."""
    exponent: int
    """Specular exponent."""
    view_from_world: Array
    """(4, 4)."""
    clip_from_view: Array
    """(4, 4)."""


def _cross(a: Array, b: Array) -> Array:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _length(a: Array) -> float:
    return float(np.sqrt(_dot(a, a)))


def _to_patch(rows: Array, corner: Array, homogeneous: Array) -> Array:
    """A homogeneous world point or direction in patch space."""
    offset = homogeneous[:3] - corner if homogeneous[3] == 1.0 else homogeneous[:3]
    return np.array([*(_dot(row, offset) for row in rows), homogeneous[3]])


def uniforms(polygon: BasePolygon, camera: Camera, light: Light) -> Uniforms:
    """The constants of a polygon's draw call."""
    corner, edge_u, edge_v = polygon.arrays
    normal = _cross(edge_u, edge_v)
    normal = normal / _length(normal)
    edge_h = polygon.height_scale * normal
    across = _cross(edge_v, edge_h)
    det = _dot(edge_u, across)
    rows = np.array([across / det, _cross(edge_h, edge_u) / det, _cross(edge_u, edge_v) / det])
    tangent = edge_u / _length(edge_u)
    light_world = light.homogeneous
    return Uniforms(
        corner=corner.copy(),
        axes=np.array([edge_u, edge_v, edge_h]),
        rows=rows,
        frame=np.array([tangent, _cross(normal, tangent), normal]),
        lengths=np.array([_length(edge_u), _length(edge_v)]),
        scale=polygon.height_scale,
        tile=np.array(polygon.facade_tile),
        eye=_to_patch(rows, corner, camera.eye),
        light=_to_patch(rows, corner, light_world),
        eye_world=camera.eye.copy(),
        light_world=light_world,
        phong=np.array([light.ambient, light.diffuse, light.specular]),
        exponent=light.exponent,
        view_from_world=camera.view_from_world.copy(),
        clip_from_view=camera.clip_from_view.copy(),
    )
