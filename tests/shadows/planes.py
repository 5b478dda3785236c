"""Scenes in which caster, receiver and light lie in parallel planes: there convolution and filter are exact."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.scene import Camera, Mesh
from ibr_ref.shadows import AreaLight, Params, Scene, SoftParams, render, render_soft
from tests.shadows.scenes import Array, plate

CORNERS = [(-0.35, -0.2, 0.0), (0.3, -0.3, 0.0), (0.1, 0.35, 0.0), (-0.1, 0.05, 0.0)]
"""A dart: not convex, no edge along an axis."""

ROTATION = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3.0


def dart() -> Mesh:
    return Mesh(vertices=CORNERS, triangles=[(0, 1, 3), (1, 2, 3)])


def turned(points: Any) -> Array:
    return np.asarray(points, np.float64) @ ROTATION.T


def turned_mesh(mesh: Mesh) -> Mesh:
    return Mesh(vertices=turned(mesh.vertices), triangles=mesh.triangles)


def tilted_scene(caster: Mesh, half_edges: Any = ((0.4, 0.1, 0.0), (-0.2, 0.3, 0.0)), size: int = 48) -> Scene:
    """The caster in z = 0, under a parallelogram in z = 4, over the floor z = -1, all turned about; seen from below it."""
    camera = Camera.orthographic(
        eye=turned((0.1, 0.05, -0.5)),
        target=turned((0.1, 0.05, -1.0)),
        up=turned((0, 1, 0)),
        view_height=1.2,
        near=0.1,
        far=5,
        width=size,
        height=size,
    )
    light = AreaLight(
        position=turned((0.1, -0.1, 4.0)),
        target=turned((0.5, 0.3, 0.0)),  # it does not look straight at the floor: no one map of the warp's would do
        up=turned((0, 1, 0)),
        vertical_fov=40.0,
        near=0.5,
        far=9.0,
        half_edges=turned(half_edges),
    )
    return Scene(
        receivers=[turned_mesh(plate(6.0, -1.0))],
        caster=turned_mesh(caster),
        offset_axes=turned(((1, 0, 0), (0, 1, 0))),
        offset_range=((-0.5, 0.5), (-0.5, 0.5)),
        offset=(0.1, 0.05),
        light=light,
        camera=camera,
    )


def soft_shadow_by(scene: Scene, **changes: Any) -> Array:
    """(H, W)."""
    if changes.get("method") == "pcss":
        return np.asarray(render(scene, Params(**changes)).stages["accumulate.shadow"], np.float64)
    return np.asarray(render_soft(scene, SoftParams(**changes)).stages["soft.shadow"], np.float64)
