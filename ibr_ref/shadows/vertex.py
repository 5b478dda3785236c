"""Vertex stage: model space -> world -> view -> clip, for the camera and for the light."""

from __future__ import annotations

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.transform import transformed


def place(vertices: Floats, axes: Floats, offset: Floats) -> Floats:
    """The caster's vertices (V, 3) in world space, v + x a + y b, for its offset (x, y) along the axes (2, 3)."""
    world: Floats = vertices + offset[0] * axes[0] + offset[1] * axes[1]
    return world


def to_clip(vertices: Floats, view_from_world: Floats, clip_from_view: Floats) -> Floats:
    """World positions (V, 3) in clip space (V, 4), by one matrix after the other."""
    return transformed(clip_from_view, transformed(view_from_world, vertices))
