"""Bugs in stage 1. Ports light with the case's normals, so the picture shows none of them."""
# An override does what its parent says, but for the fault in the class's docstring.
# ruff: noqa: D102

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.mutants.seeded import mutant
from ibr_ref.oracle.ports.splatting.normals import Normals
from ibr_ref.oracle.ports.splatting.stage import Vector

_HIDDEN = "the light falls on the case's normals, not on the port's own"


class ForwardDifferences(Normals):
    """The right and lower neighbours count wherever they are usable, not the nearer ones."""

    def prefers_next(self, next_gap: Floats, last_gap: Floats) -> Bools:
        return np.ones_like(next_gap, bool)


class TiesToTheLeft(Normals):
    """Of neighbours equally near in depth the left and upper ones count."""

    def prefers_next(self, next_gap: Floats, last_gap: Floats) -> Bools:
        return next_gap < last_gap


class JumpOfFiveHundredths(Normals):
    """A neighbour is off the surface at 0.05 world units, not at 0.05 of the depth."""

    def usable(self, gap: Floats, depth: Floats) -> Bools:
        return gap <= self.alu.number(0.05)


class NormalsOfBothSides(Normals):
    """Normals are not turned to the camera."""

    def faces_away(self, cosine: Floats) -> Bools:
        return np.zeros_like(cosine, bool)


class NormalsFaceTheView(Normals):
    """Normals are turned to the eye of the view, not of the reference camera."""

    def seen_from(self, camera: Any) -> ArrayLike:
        eye: ArrayLike = self.scene.camera.eye
        return eye


class HalfByteNormals(Normals):
    """Codes are floor(127.5 n + 128): [-1, 1] to [0, 255] with no code for zero."""

    def encode(self, value: Floats) -> Floats:
        return np.minimum(np.floor(self.alu.dot([127.5, 128.0], [value, 1.0])), 255.0)


class LoneNormalsUp(Normals):
    """A point without neighbours has the normal (0, 0, 1), not the direction to the camera."""

    def without_neighbours(self, towards: Vector) -> Vector:
        return [0.0 * towards[0], 0.0 * towards[1], 0.0 * towards[2] + 1.0]


MUTANTS = (
    mutant(ForwardDifferences, hidden=_HIDDEN),
    mutant(TiesToTheLeft, hidden=_HIDDEN),
    mutant(JumpOfFiveHundredths, hidden=_HIDDEN),
    mutant(NormalsOfBothSides, hidden=_HIDDEN),
    mutant(NormalsFaceTheView, hidden=_HIDDEN),
    mutant(HalfByteNormals, hidden=_HIDDEN),
    mutant(LoneNormalsUp, hidden=_HIDDEN),
)
