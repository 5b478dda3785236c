"""Stage vertex: the corners of the drawn faces (section 3.2) and what becomes of them up to the rasterizer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement import Params
from ibr_ref.oracle.accept.bounded import Bounded, exact, lerp
from ibr_ref.oracle.referees.displacement.arrays import joined, stacked
from ibr_ref.oracle.referees.displacement.constants import Constants, Vector, clip_point

Ints = NDArray[np.int64]

BASE = 0
QUADS = np.array(
    [
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
        [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)],
        [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)],
        [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
        [(0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)],
        [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    ],
    np.float64,
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Faces:
    """The drawn quads of one polygon, in the order of their numbers."""

    numbers: Ints
    """(F,)."""
    patch: Bounded
    """(4 F, 3)."""
    clip: Bounded
    """(4 F, 4)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Triangles:
    """What the rasterizer gets of one polygon, after clipping."""

    face: Ints
    """(T,) face number."""
    clip: Bounded
    """(T, 3, 4)."""
    patch: Bounded
    """(T, 3, 3)."""


def faces_of(constants: Constants, params: Params) -> Faces:
    """The quads that the reference draws. Which they are hangs on the eye alone, far from a tie in any decent case."""
    eye, w = [float(x.value) for x in constants.eye], constants.eye_w
    turned = [eye[2] > 0.0, eye[0] > 0.0, eye[0] < w, eye[1] > 0.0, eye[1] < w]
    turned.append(eye[2] < w and params.interval == "volume")
    numbers = np.flatnonzero(turned)
    if params.faces == "extended":
        numbers, patch = np.array([BASE]), _extended_base(constants)
    else:
        numbers = numbers[numbers == BASE] if params.faces == "base" else numbers
        patch = exact(QUADS[numbers].reshape(-1, 3), constants.device)
    clip = stacked(clip_point(constants, [patch[:, i] for i in range(3)]))
    return Faces(numbers=numbers.astype(np.int64), patch=patch, clip=clip)


def _extended_base(constants: Constants) -> Bounded:
    """The rectangle around the polygon and what the eye sees the top's corners on (section 3.2.1), (4, 3)."""
    device, eye = constants.device, constants.eye
    top = exact(QUADS[5], device)
    w = exact(constants.eye_w, device)
    up = eye[2] - w * top[:, 2]
    sides = []
    for axis in range(2):
        ends = top[:, axis] - (eye[axis] - w * top[:, axis]) * (top[:, 2] / up)
        low, high = (
            Bounded(pick(ends.value, other), pick(ends.high, other) - pick(ends.low, other), device)
            for pick, other in ((_least, 0.0), (_most, 1.0))
        )
        sides.append((low, high))
    (u0, u1), (v0, v1) = sides
    zero = exact(0.0, device)
    return joined([stacked([u, v, zero])[None] for u, v in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))])


def _least(values: NDArray[np.float64], other: float) -> NDArray[np.float64]:
    return np.asarray(np.minimum(values.min(), other))


def _most(values: NDArray[np.float64], other: float) -> NDArray[np.float64]:
    return np.asarray(np.maximum(values.max(), other))


def triangles_of(faces: Faces) -> Triangles:
    """Each quad (a, b, c, d) as abc and acd, clipped at the near, then at the far plane; fans from their first vertex."""
    numbers, clips, patches = [], [], []
    for quad, number in enumerate(faces.numbers):
        for corners in ((0, 1, 2), (0, 2, 3)):
            index = [4 * quad + corner for corner in corners]
            polygon = [stacked([*_components(faces.clip[i]), *_components(faces.patch[i])]) for i in index]
            for plane in (_near, _far):
                polygon = _cut(polygon, plane)
            for second, third in pairwise(polygon[1:]):
                corner_rows = joined([vertex[None] for vertex in (polygon[0], second, third)])
                numbers.append(number)
                clips.append(corner_rows[None, :, :4])
                patches.append(corner_rows[None, :, 4:])
    if not numbers:
        nothing = exact(np.empty((0, 3, 4)), faces.clip.device)
        return Triangles(face=np.empty(0, np.int64), clip=nothing, patch=nothing[..., :3])
    return Triangles(face=np.array(numbers), clip=joined(clips), patch=joined(patches))


def _components(vector: Bounded) -> Vector:
    return [vector[i] for i in range(len(vector.value))]


def _near(vertex: Bounded) -> Bounded:
    return vertex[2]


def _far(vertex: Bounded) -> Bounded:
    return vertex[3] - vertex[2]


def _cut(polygon: list[Bounded], distance: Callable[[Bounded], Bounded]) -> list[Bounded]:
    """One step of Sutherland and Hodgman, as the reference takes it: a crossing is computed from inside to outside.

    A corner on the plane may count as inside or outside: the polygon is the same but for its rounding.
    """
    result = []
    for here, there in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        d_here, d_there = distance(here), distance(there)
        if d_here.value >= 0.0:
            result.append(here)
        if (d_here.value >= 0.0) != (d_there.value >= 0.0):
            inside, outside, d_in, d_out = (
                (here, there, d_here, d_there) if d_here.value >= 0.0 else (there, here, d_there, d_here)
            )
            result.append(lerp(inside, outside, d_in / (d_in - d_out)))
    return result
