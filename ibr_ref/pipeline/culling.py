"""Why something is not in a picture: which clip plane, or side of the picture, or pixel centre a primitive misses.

For those who ask why a picture is empty; drawing does not come by here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats
from ibr_ref.jit import routine
from ibr_ref.pipeline.clip import GUARD, clip_triangles
from ibr_ref.pipeline.triangles import Triangles, columns_in_row, edges_in_row, set_up

NEAR, FAR, OUTSIDE, SMALL, DRAWN = range(5)
"""Fates: wholly before the near plane, wholly beyond the far one, beside the picture, between the pixels' centres, or
none of these. In this order: of two parts of one thing the greater one counts."""


class Culled(NamedTuple):
    """How many of a picture's primitives are in it, and why the others are not, before the depth test."""

    what: str
    """"face" | "point" | "triangle"."""
    total: int
    away: int
    """Not drawn because they face the other way (faces of displaced volumes)."""
    near: int
    """Wholly in front of the near plane, or behind the eye."""
    far: int
    """Wholly beyond the far plane."""
    outside: int
    """Between the planes, beside the picture."""
    small: int
    """In the picture, but they cover no pixel's centre."""
    drawn: int
    """They cover at least one."""

    def words(self) -> str:
        """Such as "of 3 faces 3 lie beyond the far plane"."""
        reasons = (
            (self.away, "turned away from the eye"),
            (self.near, "in front of the near plane or behind the eye"),
            (self.far, "beyond the far plane"),
            (self.outside, "outside the picture"),
            (self.small, "too small to cover a pixel's centre"),
            (self.drawn, "in the picture"),
        )
        found = ", ".join(f"{count:,} {reason}" for count, reason in reasons if count)
        return f"of {self.total:,} {self.what}{'' if self.total == 1 else 's'}: {found}"


def culled(what: str, fates: NDArray[np.integer], away: int = 0) -> Culled:
    """The counts of fates (N,), and of those that were turned away before."""
    counts = np.bincount(fates, minlength=5).tolist()
    return Culled(what, len(fates) + away, away, *counts)


def fates_of_triangles(clip: Floats, indices: NDArray[np.int32], width: int, height: int) -> NDArray[np.int64]:
    """(T,) fates of triangles with corners in clip space, in a picture of `width` x `height`."""
    z, w = clip[:, 2][indices], clip[:, 3][indices]
    fates = np.full(len(indices), OUTSIDE)
    # A guard band as large as the picture cuts at its sides: what is left of a triangle is in it.
    fates[clip_triangles(clip, np.empty((len(clip), 0)), indices, int(GUARD), int(GUARD)).source] = SMALL
    covering = set_up(clip_triangles(clip, np.empty((len(clip), 0)), indices, width, height), width, height)
    drawn = np.zeros(len(indices), np.bool_)
    _mark_covering(covering, width, drawn)
    fates[drawn] = DRAWN
    fates[(z > w).all(axis=1)] = FAR
    fates[(z < 0.0).all(axis=1)] = NEAR
    return fates


@routine
def _mark_covering(triangles: Triangles, width: int, drawn: Bools) -> None:
    """Set drawn (T,) where a part of the triangle covers a pixel's centre."""
    for t in range(len(triangles.rows)):
        for row in range(triangles.rows[t, 0], triangles.rows[t, 1]):
            first, stop = columns_in_row(edges_in_row(triangles.x[t], triangles.y[t], row), width)
            if stop > first:
                drawn[triangles.source[t]] = True
                break


def cut_triangles(clip: Floats, indices: NDArray[np.int32]) -> tuple[int, int, int, int]:
    """How many triangles the frustum does not hold wholly; and how many leave it by the near plane, the far one, a side."""
    x, y, z, w = clip.T
    near, far, beside = z < 0.0, z > w, (np.abs(x) > w) | (np.abs(y) > w)
    by = [where[indices].any(axis=1) for where in (near, far, beside & ~near)]
    return int(np.any(by, axis=0).sum()), int(by[0].sum()), int(by[1].sum()), int(by[2].sum())
