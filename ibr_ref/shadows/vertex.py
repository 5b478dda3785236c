"""Vertex stage: world (or model) space -> view -> clip, for the camera and for the light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import kernel, prange


@kernel
def _place(vertices, axes, x, y, out):
    for i in prange(len(vertices)):
        for k in range(3):
            out[i, k] = vertices[i, k] + x * axes[0, k] + y * axes[1, k]


@kernel
def _transform(vertices, view_from_world, clip_from_view, clip):
    for i in prange(len(vertices)):
        x, y, z = vertices[i, 0], vertices[i, 1], vertices[i, 2]
        m = view_from_world
        view_x = m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3]
        view_y = m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3]
        view_z = m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3]
        view_w = m[3, 0] * x + m[3, 1] * y + m[3, 2] * z + m[3, 3]
        m = clip_from_view
        for k in range(4):
            clip[i, k] = m[k, 0] * view_x + m[k, 1] * view_y + m[k, 2] * view_z + m[k, 3] * view_w


def place(vertices: NDArray[np.float64], axes: NDArray[np.float64], offset: NDArray[np.float64]) -> NDArray[np.float64]:
    """The caster's vertices (V, 3) in world space, v + x a + y b, for its offset (x, y) along the axes (2, 3)."""
    out = np.empty((len(vertices), 3))
    _place(vertices, axes, float(offset[0]), float(offset[1]), out)
    return out


def to_clip(
    vertices: NDArray[np.float64], view_from_world: NDArray[np.float64], clip_from_view: NDArray[np.float64]
) -> NDArray[np.float64]:
    """World positions (V, 3) in clip space (V, 4), by one matrix after the other."""
    clip = np.empty((len(vertices), 4))
    _transform(vertices, view_from_world, clip_from_view, clip)
    return clip
