"""Vertex stage: the faces of the displaced volume that are drawn (section 3.2), and their corners in clip space."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.displacement.buffers import Uniforms
from ibr_ref.jit import routine

BASE, U0, U1, V0, V1, TOP = range(6)

_QUADS = np.array(
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


class Faces(NamedTuple):
    """Drawn quads in submission order: numbers (F,), corners in patch space (4 F, 3) and clip space (4 F, 4)."""

    numbers: NDArray[np.int32]
    patch: Floats
    clip: Floats

    @property
    def triangles(self) -> NDArray[np.int32]:
        """(2 F, 3) vertex indices: each quad (a, b, c, d) as abc, acd."""
        quads = 4 * np.arange(len(self.numbers), dtype=np.int32)[:, None, None]
        return (quads + np.array([[0, 1, 2], [0, 2, 3]], np.int32)).reshape(-1, 3)


def away_faces(eye: Floats, interval: str) -> list[int]:
    """Numbers of the faces of the unit cube that are turned away from the eye (4,) in patch space.

    A view ray that goes down through the volume leaves it through one of them. The top only counts with
    interval="volume": rays that look up.
    """
    u, v, h, w = eye
    turned = [(BASE, h > 0.0), (U0, u > 0.0), (U1, u < w), (V0, v > 0.0), (V1, v < w)]
    if interval == "volume":
        turned.append((TOP, h < w))
    return [number for number, away in turned if away]


def extended_base(eye: Floats) -> Floats:
    """The base enlarged as in section 3.2.1: (4, 3) corners of the rectangle that covers all the volume's projections.

    The eye must be above the top of the volume: its projection onto the base is infinite otherwise.
    """
    u, v = [0.0, 1.0], [0.0, 1.0]
    for corner in _QUADS[TOP]:
        towards = eye[:3] - eye[3] * corner
        u.append(corner[0] - towards[0] * (1.0 / towards[2]))
        v.append(corner[1] - towards[1] * (1.0 / towards[2]))
    low, high = (min(u), min(v)), (max(u), max(v))
    return np.array(
        [(low[0], low[1], 0), (high[0], low[1], 0), (high[0], high[1], 0), (low[0], high[1], 0)], np.float64
    )


@routine
def transform(
    patch: Floats, corner: Floats, axes: Floats, view_from_world: Floats, clip_from_view: Floats, clip: Floats
) -> None:
    """Patch -> world -> view -> clip, one after the other, for each vertex: patch (V, 3), clip (V, 4).

    corner (3,), axes (3, 3) and the two matrices (4, 4) as in `Uniforms`.
    """
    for i in range(len(patch)):
        u, v, h = patch[i, 0], patch[i, 1], patch[i, 2]
        x = corner[0] + u * axes[0, 0] + v * axes[1, 0] + h * axes[2, 0]
        y = corner[1] + u * axes[0, 1] + v * axes[1, 1] + h * axes[2, 1]
        z = corner[2] + u * axes[0, 2] + v * axes[1, 2] + h * axes[2, 2]
        m = view_from_world
        view_x = m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3]
        view_y = m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3]
        view_z = m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3]
        view_w = m[3, 0] * x + m[3, 1] * y + m[3, 2] * z + m[3, 3]
        m = clip_from_view
        for j in range(4):
            clip[i, j] = m[j, 0] * view_x + m[j, 1] * view_y + m[j, 2] * view_z + m[j, 3] * view_w


def vertex_stage(constants: Uniforms, faces: str, interval: str) -> Faces:
    """The faces of one polygon that are drawn."""
    if faces == "extended":
        numbers, quads = [BASE], extended_base(constants.eye)
    else:
        numbers = away_faces(constants.eye, interval)
        if faces == "base":
            numbers = [number for number in numbers if number == BASE]
        quads = _QUADS[numbers]
    patch = np.ascontiguousarray(quads.reshape(-1, 3))
    clip = np.empty((len(patch), 4))
    transform(patch, constants.corner, constants.axes, constants.view_from_world, constants.clip_from_view, clip)
    return Faces(np.array(numbers, np.int32), patch, clip)
