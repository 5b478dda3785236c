"""Vertex stage: model space -> world -> view -> clip, for the camera and for the light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.pipeline.transform import transformed

Array = NDArray[np.float64]


def place(vertices: Array, axes: Array, offset: Array) -> Array:
    """The caster's vertices (V, 3) in world space, v + x a + y b, for its offset (x, y) along the axes (2, 3)."""
    world: Array = vertices + offset[0] * axes[0] + offset[1] * axes[1]
    return world


def to_clip(vertices: Array, view_from_world: Array, clip_from_view: Array) -> Array:
    """World positions (V, 3) in clip space (V, 4), by one matrix after the other."""
    return transformed(clip_from_view, transformed(view_from_world, vertices))
