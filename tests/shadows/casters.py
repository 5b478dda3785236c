"""Casters of many kinds for the quality of warped shadows: solid, thin, in parts, and with holes."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ibr_ref import io, models
from ibr_ref.scene import Mesh

DATA = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "models"
"""The cow and the teapot lie beside the repository."""


def cow() -> Mesh:
    """The cow on its feet: the file's y points up."""
    mesh = io.read_mesh(DATA / "cow.obj")
    x, y, z = np.asarray(mesh.vertices).T
    return Mesh(vertices=np.stack([x, -z, y], axis=1), triangles=mesh.triangles)


def teapot() -> Mesh:
    """Newell's teapot."""
    return io.read_mesh(DATA / "teapot.bpt")


def joined(*meshes: Mesh) -> Mesh:
    """Several meshes as one."""
    starts = np.cumsum([0] + [len(np.asarray(mesh.vertices)) for mesh in meshes])
    return Mesh(
        vertices=np.concatenate([np.asarray(mesh.vertices) for mesh in meshes]),
        triangles=np.concatenate([np.asarray(m.triangles) + start for m, start in zip(meshes, starts, strict=False)]),
    )


def moved(mesh: Mesh, by: tuple[float, float, float], scale: float = 1.0) -> Mesh:
    return Mesh(vertices=np.asarray(mesh.vertices) * scale + np.array(by), triangles=mesh.triangles)


def block(low: tuple[float, float, float], high: tuple[float, float, float]) -> Mesh:
    """A box between two corners."""
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    quads = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    return Mesh(vertices=corners, triangles=np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]))


def turned_outline(outline: list[tuple[float, float]], sides: int = 48) -> Mesh:
    """A closed outline (radius, height), turned around the z axis."""
    angles = 2.0 * math.pi * np.arange(sides) / sides
    vertices = [(r * math.cos(a), r * math.sin(a), z) for a in angles for r, z in outline]
    n, triangles = len(outline), []
    for i in range(sides):
        for k in range(n):
            a, b = i * n + k, i * n + (k + 1) % n
            c, d = (i + 1) % sides * n + k, (i + 1) % sides * n + (k + 1) % n
            triangles += [(a, c, d), (a, d, b)]
    return Mesh(vertices=vertices, triangles=triangles)


def ring() -> Mesh:
    """A flat, thin band that stands upright: its shadow is open in the middle."""
    lying = turned_outline([(0.40, -0.04), (0.5, -0.04), (0.5, 0.04), (0.40, 0.04)])
    x, y, z = np.asarray(lying.vertices).T
    return Mesh(vertices=np.stack([x, z, y], axis=1), triangles=lying.triangles)


def torus() -> Mesh:
    """Lying, thick."""
    circle = [(0.35 + 0.15 * math.cos(a), 0.15 * math.sin(a)) for a in 2.0 * math.pi * np.arange(24) / 24]
    return turned_outline(circle)


def tree() -> Mesh:
    """A trunk with branches that end in balls."""
    random = np.random.RandomState(8)
    parts = [block((-0.04, -0.04, 0.0), (0.04, 0.04, 0.6))]
    for _ in range(14):
        angle, height, reach = (
            random.uniform(0.0, 2.0 * math.pi),
            random.uniform(0.45, 0.95),
            random.uniform(0.05, 0.35),
        )
        at = (reach * math.cos(angle), reach * math.sin(angle), height)
        parts.append(moved(models.sphere(1.0, 16), at, random.uniform(0.07, 0.13)))
    return joined(*parts)


def two_objects() -> Mesh:
    """A box and a ball apart from each other, at different heights."""
    return joined(block((-0.5, -0.25, 0.0), (-0.15, 0.1, 0.5)), moved(models.sphere(1.0, 32), (0.3, 0.15, 0.7), 0.2))


def plate_with_holes() -> Mesh:
    """A lying plate of 5 x 5 squares, the four at odd places missing."""
    step, parts = 0.2, []
    for i in range(5):
        for j in range(5):
            if not (i % 2 and j % 2):
                x, y = -0.5 + i * step, -0.5 + j * step
                parts.append(block((x, y, 0.3), (x + step, y + step, 0.34)))
    return joined(*parts)


def thin_bar() -> Mesh:
    """A hundredth as thick as long, and leaning."""
    straight = block((-0.5, -0.005, 0.0), (0.5, 0.005, 0.01))
    x, y, z = np.asarray(straight.vertices).T
    return Mesh(vertices=np.stack([x * 0.9 - y * 0.3, x * 0.3 + y * 0.9, z + 0.3 * (x + 0.5)], axis=1),
                triangles=straight.triangles)  # fmt: skip


CASTERS: dict[str, Callable[[], Mesh]] = {
    "cow": cow, "teapot": teapot, "chair": models.chair, "ring": ring, "torus": torus, "tree": tree,
    "two objects": two_objects, "plate with holes": plate_with_holes, "thin bar": thin_bar,
}  # fmt: skip
FROM_FILES = ("cow", "teapot")
