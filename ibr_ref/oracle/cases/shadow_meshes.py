"""Small meshes by formula, for the cases of shadows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.scene import Mesh
from ibr_ref.scene.trigonometry import sine_cosine

_QUADS = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


def plate(half: float, z: float, **more: Any) -> Mesh:
    """A square in a plane z."""
    corners = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
    return Mesh(vertices=corners, triangles=[(0, 1, 2), (0, 2, 3)], **more)


def block(half: float, **more: Any) -> Mesh:
    """A cube about the origin."""
    return bar((-half, -half, -half), (half, half, half), **more)


def bar(low: Sequence[float], high: Sequence[float], **more: Any) -> Mesh:
    """A closed box between two corners, its triangles turned outwards."""
    ends = list(zip(low, high, strict=True))
    corners = [(x, y, z) for x in ends[0] for y in ends[1] for z in ends[2]]
    return Mesh(vertices=corners, triangles=np.concatenate([_QUADS[:, :3], _QUADS[:, [0, 2, 3]]]), **more)


def ball(radius: float, rings: int) -> Mesh:
    """A sphere about the origin by meridians and parallels."""
    points = []
    for i in range(rings + 1):
        for j in range(rings):
            (sine, cosine), (sine_j, cosine_j) = (sine_cosine(a) for a in (math.pi * i / rings, math.tau * j / rings))
            points.append((sine * cosine_j, sine * sine_j, cosine))
    triangles = []
    for i in range(rings):
        for j in range(rings):
            p, q = i * rings + j, i * rings + (j + 1) % rings
            triangles += [
                t for t, there in (((p, p + rings, q + rings), i < rings - 1), ((p, q + rings, q), i > 0)) if there
            ]
    return Mesh(vertices=radius * np.array(points), triangles=triangles)


def wall(x: float) -> Mesh:
    """Beside the caster, leaning, and wound away from it."""
    corners = [(x, -1.5, -0.98), (x, 1.5, -0.98), (x + 0.3, 1.5, 1.5), (x + 0.3, -1.5, 1.5)]
    return Mesh(vertices=corners, triangles=[(0, 1, 2), (0, 2, 3)], color=(0.9, 0.5, 0.4))


def moved(mesh: Mesh, by: ArrayLike, **more: Any) -> Mesh:
    """Somewhere else, and painted anew."""
    return Mesh(vertices=np.asarray(mesh.vertices) + np.asarray(by), triangles=mesh.triangles, **more)


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """As one mesh."""
    sizes = [len(np.asarray(mesh.vertices)) for mesh in meshes]
    starts = np.cumsum([0, *sizes[:-1]])
    return Mesh(
        vertices=np.concatenate([np.asarray(mesh.vertices) for mesh in meshes]),
        triangles=np.concatenate([np.asarray(m.triangles) + s for m, s in zip(meshes, starts, strict=True)]),
    )


def painted(mesh: Mesh, seed: int) -> Mesh:
    """With a colour of its own for every vertex."""
    vertices: Floats = np.asarray(mesh.vertices)
    colors = np.random.RandomState(seed).random_sample(vertices.shape)
    return Mesh(vertices=vertices, triangles=mesh.triangles, color=colors)


def stool() -> Mesh:
    """A painted box with a ball on it: closed, not convex, not symmetric."""
    return painted(joined([moved(block(0.3), (0.1, 0.0, -0.2)), moved(ball(0.35, 12), (-0.1, 0.05, 0.42))]), 3)


def rack() -> Mesh:
    """Thin bars across each other: half a texel, or a pixel, wide."""
    along = [bar((-0.7, y, -0.02), (0.7, y + 0.03, 0.02)) for y in (-0.4, -0.13, 0.17, 0.41)]
    across = [bar((x, -0.6, 0.05), (x + 0.02, 0.6, 0.09)) for x in (-0.5, -0.23, 0.11, 0.38)]
    return painted(joined([*along, *across]), 4)


def grid(seed: int, rows: int, columns: int) -> Floats:
    """(3, 3, R, C, 2) grids whose points are moved by less than a quarter of a cell, those of the border along it."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, columns), np.linspace(0.0, 1.0, rows))
    moves = np.random.RandomState(seed).random_sample((3, 3, rows, columns, 2)) - 0.5
    moves *= 0.48 / np.array([columns - 1, rows - 1])
    moves[:, :, [0, -1], :, 1] = 0.0
    moves[:, :, :, [0, -1], 0] = 0.0
    result: Floats = np.stack([u, v], axis=-1) + moves
    return result
