"""What the camera sees: receivers and caster through the depth test, and the world position of every pixel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.clip import clip_triangles
from ibr_ref.pipeline.lighting import unit
from ibr_ref.pipeline.triangles import set_up, shifted
from ibr_ref.pipeline.visibility import interpolate, visible
from ibr_ref.shadows.vertex import to_clip


class Object(NamedTuple):
    """A mesh in world space."""

    vertices: Floats
    """(V, 3)."""
    triangles: NDArray[np.int32]
    """(T, 3)."""
    color: Floats
    """(3,), or (V, 3)."""


class Surface(NamedTuple):
    """The visible fragments of a picture."""

    depth: Floats
    """(H, W) window depth; 1 where nothing is."""
    triangle: NDArray[np.int32]
    """(H, W) index among the triangles of all objects, in the order in which they are drawn; -1 none."""
    varyings: Floats
    """(H, W, 3) world position, or (H, W, 6): position and colour; NaN where nothing is."""
    normals: Floats
    """(T, 3) unit normals of all triangles, of either side; 0 where a triangle has no area."""
    colors: Floats
    """(T, 3) the colours of triangles whose mesh has but one; NaN where vertices have colours."""


@kernel
def _normals(vertices: Floats, triangles: Indices, out: Floats) -> None:
    """Of vertices (V, 3) and triangles (T, 3), into (T, 3)."""
    for t in prange(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy, uz = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2]
        vx, vy, vz = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2]
        out[t, 0], out[t, 1], out[t, 2] = unit(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)


@device
def _name_row(winner: Indices, source: Indices, row: int, out: Indices) -> None:
    """A row of `_name`."""
    for column in range(winner.shape[1]):
        t = winner[row, column]
        out[row, column] = source[t] if t >= 0 else -1


@kernel
def _name(winner: Indices, source: Indices, out: Indices) -> None:
    """From clipped triangles (H, W) to those that they were clipped from, source (C,), into (H, W); -1 stays."""
    for row in prange(winner.shape[0]):
        _name_row(winner, source, row, out)


def _varyings(objects: Sequence[Object], vertices: Floats) -> Floats:
    """(V, 3) positions, or (V, 6) with colours, where any mesh has a colour a vertex."""
    if all(o.color.ndim == 1 for o in objects):
        return vertices
    colors = [np.broadcast_to(o.color, o.vertices.shape) for o in objects]
    return np.concatenate([vertices, np.concatenate(colors)], axis=1)


def _plain_colors(objects: Sequence[Object]) -> Floats:
    plain = [o.color if o.color.ndim == 1 else np.full(3, np.nan) for o in objects]
    return np.repeat(np.array(plain), [len(o.triangles) for o in objects], axis=0)


def see(
    objects: Sequence[Object],
    view_from_world: Floats,
    clip_from_view: Floats,
    width: int,
    height: int,
    rows: tuple[int, int],
) -> Surface:
    """Draw objects in order, with the depth test LESS; rows: first and one past the last of the picture that are drawn."""
    starts = np.cumsum([0] + [len(o.vertices) for o in objects])
    vertices = np.concatenate([o.vertices for o in objects])
    triangles = np.concatenate([o.triangles + start for o, start in zip(objects, starts, strict=False)])
    triangles = np.ascontiguousarray(triangles, np.int32)
    clip = to_clip(vertices, view_from_world, clip_from_view)
    drawn = set_up(clip_triangles(clip, _varyings(objects, vertices), triangles, width, height), width, height)
    drawn, count = shifted(drawn, *rows), rows[1] - rows[0]
    seen = visible(drawn, width, count)
    names = np.empty((count, width), np.int32)
    _name(seen.triangle, drawn.source, names)
    normals = np.empty((len(triangles), 3))
    _normals(vertices, triangles, normals)
    return Surface(seen.depth, names, interpolate(drawn, seen.triangle), normals, _plain_colors(objects))
