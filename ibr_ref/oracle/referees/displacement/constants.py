"""What a port computes once per polygon: its patch space, and the camera and the light in it, with their bounds.

A port may compute these in float64 on the host and upload them, or in float32 on the device: the bounds hold both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.displacement import Scene
from ibr_ref.oracle.accept.bounded import Bounded, dot, exact, total, unit, uploaded
from ibr_ref.oracle.accept.fetch import Texture
from ibr_ref.oracle.device import Device
from ibr_ref.scene import BasePolygon

Vector = list[Bounded]
"""Components of a vector."""
Matrix = list[list[Bounded]]
"""Rows of a matrix."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Textures:
    """A polygon's maps; None: not there."""

    height: Texture
    color: Texture
    normal: Texture | None
    facade: Texture | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Constants:
    """A polygon's constants; scalars but for the textures."""

    polygon: BasePolygon
    axes: Matrix
    """U, V and s n as rows."""
    rows: Matrix
    """The reciprocal basis as rows: the first two are U* and V*."""
    frame: Matrix
    """U/|U|, n x U/|U| and n as rows."""
    lengths: Vector
    """|U| and |V|."""
    scale: Bounded
    tile: Vector
    eye: Vector
    """In patch space; with w = 0 the direction towards an orthographic camera."""
    eye_w: float
    light: Vector
    light_w: float
    eye_world: Vector
    light_world: Vector
    phong: Vector
    """Ambient, diffuse, specular."""
    exponent: int
    transforms: list[Matrix]
    """From patch to clip space: world from patch, view from world, clip from view."""
    textures: Textures

    @cached_property
    def combined(self) -> tuple[Matrix, Matrix]:
        """Clip from world and clip from patch, multiplied on the device."""
        world, view, clip = self.transforms
        clip_from_world = _product(clip, view)
        return clip_from_world, _product(clip_from_world, world)

    @property
    def device(self) -> Device:
        """Whose bounds these are."""
        return self.scale.device


def constants_of(scene: Scene, device: Device) -> list[Constants]:
    """Of each polygon of a scene."""
    return [_constants(scene, polygon, device) for polygon in scene.polygons]


def _constants(scene: Scene, polygon: BasePolygon, device: Device) -> Constants:
    corner, edge_u, edge_v = (_uploaded(vector, device) for vector in polygon.arrays)
    scale = uploaded(polygon.height_scale, device)
    normal = unit(_cross(edge_u, edge_v))
    rise = [scale * x for x in normal]
    across = _cross(edge_v, rise)
    det = dot(edge_u, across)
    rows = [[x / det for x in row] for row in (across, _cross(rise, edge_u), _cross(edge_u, edge_v))]
    tangent = unit(edge_u)
    lengths = [dot(edge, edge).root() for edge in (edge_u, edge_v)]
    camera, light = scene.camera, scene.light
    light_world, light_w = _light(scene, device)
    eye_world, eye_w = _uploaded(camera.eye[:3], device), float(camera.eye[3])
    world_from_patch = [[*(axis[i] for axis in (edge_u, edge_v, rise)), corner[i]] for i in range(3)]
    world_from_patch.append([exact(x, device) for x in (0.0, 0.0, 0.0, 1.0)])
    return Constants(
        polygon=polygon,
        axes=[edge_u, edge_v, rise],
        rows=rows,
        frame=[tangent, _cross(normal, tangent), normal],
        lengths=lengths,
        scale=scale,
        tile=_uploaded(np.asarray(polygon.facade_tile), device),
        eye=_to_patch(rows, corner, eye_world, eye_w),
        eye_w=eye_w,
        light=_to_patch(rows, corner, light_world, light_w),
        light_w=light_w,
        eye_world=eye_world,
        light_world=light_world,
        phong=_uploaded(np.array([light.ambient, light.diffuse, light.specular]), device),
        exponent=light.exponent,
        transforms=[
            world_from_patch,
            *([_uploaded(row, device) for row in matrix] for matrix in (camera.view_from_world, camera.clip_from_view)),
        ],
        textures=_textures(polygon),
    )


def _light(scene: Scene, device: Device) -> tuple[Vector, float]:
    """The light in world space; a direction is a unit vector."""
    if scene.light.direction is None:
        return _uploaded(np.asarray(scene.light.position), device), 1.0
    return unit(_uploaded(np.asarray(scene.light.direction), device)), 0.0


def _to_patch(rows: Matrix, corner: Vector, point: Vector, w: float) -> Vector:
    offset = [a - b for a, b in zip(point, corner, strict=True)] if w == 1.0 else point
    return [dot(row, offset) for row in rows]


def _textures(polygon: BasePolygon) -> Textures:
    def texture(texels: ArrayLike | None, repeat: bool) -> Texture | None:
        return None if texels is None else Texture(np.asarray(texels, np.float64), repeat)

    repeat = polygon.domain == "repeat"
    return Textures(
        height=Texture(np.asarray(polygon.height_map, np.float64), repeat),
        color=Texture(np.asarray(polygon.color_map, np.float64), repeat),
        normal=texture(polygon.normal_map, repeat),
        facade=texture(polygon.facade_map, True),
    )


def _uploaded(vector: ArrayLike, device: Device) -> Vector:
    return [uploaded(x, device) for x in np.asarray(vector, np.float64)]


def _cross(a: Vector, b: Vector) -> Vector:
    return [a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def world_point(constants: Constants, point: Sequence[Bounded]) -> Vector:
    """corner + u U + v V + h s n."""
    return apply(constants.transforms[0], point)[:3]


def apply(matrix: Matrix, point: Sequence[Bounded]) -> Vector:
    """A matrix times (x, y, z, 1), or times (x, y, z, w)."""
    point = [*point, exact(1.0, point[0].device)] if len(point) == 3 else point
    return [_sparse_dot(row, point) for row in matrix]


def clip_point(constants: Constants, point: Sequence[Bounded]) -> Vector:
    """A point of patch space in clip space, whether the matrices are applied one after another or multiplied before.

    The value is the first way's, as the reference's; the error is the largest of the three ways'.
    """
    world, view, clip = constants.transforms
    clip_from_world, clip_from_patch = constants.combined
    at = apply(world, point)
    ways = [apply(clip, apply(view, at)), apply(clip_from_world, at), apply(clip_from_patch, point)]
    return [
        Bounded(
            x.value, reduce(np.maximum, [x.error, *(o.error + np.abs(o.value - x.value) for o in others)]), x.device
        )
        for x, *others in zip(*ways, strict=True)
    ]


def _product(a: Matrix, b: Matrix) -> Matrix:
    return [[_sparse_dot(row, column) for column in zip(*b, strict=True)] for row in a]


def _sparse_dot(a: Sequence[Bounded], b: Sequence[Bounded]) -> Bounded:
    """The sum of products; where sums and products are correctly rounded, 0 and a factor 1 add no error."""
    device = a[0].device
    pairs = list(zip(a, b, strict=True))
    if device.operation > 1.0:
        return total([x * y for x, y in pairs])
    terms = [_times(x, y) for x, y in pairs if not (_is(x, 0.0) or _is(y, 0.0))]
    if not terms:
        return exact(np.zeros(np.broadcast_shapes(*(x.value.shape for x in (*a, *b)))), device)
    return total(terms) if len(terms) > 1 else terms[0]


def _times(x: Bounded, y: Bounded) -> Bounded:
    if _is(x, 1.0):
        return y
    return x if _is(y, 1.0) else x * y


def _is(x: Bounded, number: float) -> bool:
    return x.value.ndim == 0 and float(x.value) == number and float(x.error) == 0.0
