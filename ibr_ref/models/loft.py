"""Surfaces drawn through rings of points, the one way in which the built-in meshes are made.

All winding is outward: a ring runs counter-clockwise as seen from where the rings go to. Only additions,
multiplications, square roots and the package's own sine and cosine are used: the same bits on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats, Ints
from ibr_ref.scene import Mesh
from ibr_ref.scene.trigonometry import sine_cosine


@cache
def turn(count: int) -> Floats:
    """(count, 2) cosine and sine of a full turn in equal steps, from angle 0."""
    pairs = [sine_cosine(2.0 * math.pi * k / count) for k in range(count)]
    result = np.array([(cosine, sine) for sine, cosine in pairs])
    result.setflags(write=False)
    return result


def capped(rings: Floats, first_pole: ArrayLike, last_pole: ArrayLike, color: ArrayLike) -> Mesh:
    """The closed surface through S rings of M points, (S, M, 3), and a pole at either end: 2 S M triangles.

    color: (3,), or (S, 3), one a ring (a pole has its neighbour's). Vertices: pole, rings one after the other, pole.
    """
    count, size = rings.shape[:2]
    here, then = _around(size)
    pole, top = np.zeros_like(here), 1 + (count - 1) * size
    first = np.stack([pole, 1 + then, 1 + here], axis=1)
    last = np.stack([top + here, top + then, pole + top + size], axis=1)
    strips = [_strip(1 + k * size, 1 + (k + 1) * size, size) for k in range(count - 1)]
    return Mesh(
        vertices=np.concatenate([[first_pole], rings.reshape(-1, 3), [last_pole]]),
        triangles=np.concatenate([first, *strips, last]),
        color=_ring_colors(color, count, size, poles=True),
    )


def looped(rings: Floats, color: ArrayLike) -> Mesh:
    """The closed surface through S rings of M points, (S, M, 3), the last joined to the first: 2 S M triangles.

    color: (3,), or (S, 3), one a ring.
    """
    count, size = rings.shape[:2]
    strips = [_strip(k * size, (k + 1) % count * size, size) for k in range(count)]
    return Mesh(
        vertices=rings.reshape(-1, 3),
        triangles=np.concatenate(strips),
        color=_ring_colors(color, count, size, poles=False),
    )


def joined(parts: Sequence[Mesh]) -> Mesh:
    """All parts as one mesh, in their order; nothing is merged."""
    vertices = [np.asarray(part.vertices) for part in parts]
    starts = np.cumsum([0, *(len(part) for part in vertices[:-1])])
    return Mesh(
        vertices=np.concatenate(vertices),
        triangles=np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)]),
        color=np.concatenate([np.broadcast_to(part.color, np.shape(part.vertices)) for part in parts]),
    )


def _around(size: int) -> tuple[Ints, Ints]:
    """Each point of a ring, and the next."""
    here = np.arange(size)
    return here, (here + 1) % size


def _strip(lower: int, upper: int, size: int) -> Ints:
    """(2 size, 3) the quads between two rings that start at the vertices `lower` and `upper`."""
    here, then = _around(size)
    quads = [lower + here, lower + then, upper + then], [lower + here, upper + then, upper + here]
    return np.stack([np.stack(triangle, axis=1) for triangle in quads], axis=1).reshape(-1, 3)


def _ring_colors(color: ArrayLike, count: int, size: int, poles: bool) -> Floats:
    """(V, 3) from one colour, or one a ring."""
    rings = np.broadcast_to(np.asarray(color, np.float64), (count, 3))
    repeats = np.full(count, size)
    if poles:
        repeats[0] += 1
        repeats[-1] += 1
    return np.repeat(rings, repeats, axis=0)
