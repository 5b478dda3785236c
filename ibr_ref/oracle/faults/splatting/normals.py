"""Bugs of the normals' preparation. Ports light with the case's normals, so the picture shows none of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.kinds import PlainPort
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Vector
from ibr_ref.oracle.programs.splatting.normals import JUMP, Preparation
from ibr_ref.oracle.programs.splatting.port import Port


class Prepared(Bugs):
    """Bugs of the preparation, in ports that are right but for it."""

    def port(self, kind: type[Any]) -> type[PlainPort]:
        """With it."""
        return type(kind.__name__, (Port,), {"preparation": kind})


NORMALS = Prepared("normals")
_HIDDEN = "the light falls on the case's normals, not on the port's own"


@NORMALS.add("forward-differences", hidden=_HIDDEN)
class _ForwardDifferences(Preparation):
    """The right and lower neighbours count wherever they are usable, not the nearer ones."""

    def prefers_next(self, next_gap: Floats, last_gap: Floats, alike: Bools) -> Bools:
        return np.ones(np.shape(next_gap), np.bool_)


@NORMALS.add("ties-to-the-left", hidden=_HIDDEN)
class _TiesToTheLeft(Preparation):
    """Of neighbours equally near in depth the left and upper ones count."""

    def prefers_next(self, next_gap: Floats, last_gap: Floats, alike: Bools) -> Bools:
        return (next_gap < last_gap) & ~alike


@NORMALS.add("jump-of-five-hundredths", hidden=_HIDDEN)
class _JumpOfFiveHundredths(Preparation):
    """A neighbour is off the surface at 0.05 world units, not at 0.05 of the depth."""

    def usable(self, gap: Floats, depth: Floats) -> Bools:
        return gap <= self.do.number(JUMP)


@NORMALS.add("normals-of-both-sides", hidden=_HIDDEN)
class _NormalsOfBothSides(Preparation):
    """Normals are not turned to the camera."""

    def faces_away(self, cosine: Floats) -> Bools:
        return np.zeros(np.shape(cosine), np.bool_)


@NORMALS.add("normals-face-the-view", hidden=_HIDDEN)
class _NormalsFaceTheView(Preparation):
    """Normals are turned to the eye of the view, not of the reference camera."""

    def seen_from(self, camera: Any) -> Any:
        return self.scene.camera.eye


@NORMALS.add("half-byte-normals", hidden=_HIDDEN)
class _HalfByteNormals(Preparation):
    """Codes are floor(127.5 n + 128): [-1, 1] to [0, 255] with no code for zero."""

    def encode(self, value: Floats) -> Floats:
        return np.minimum(np.floor(self.do.dot([127.5, 128.0], [value, 1.0])), 255.0)


@NORMALS.add("lone-normals-up", hidden=_HIDDEN)
class _LoneNormalsUp(Preparation):
    """A point without neighbours has the normal (0, 0, 1), not the direction to the camera."""

    def without_neighbours(self, towards: Vector) -> Vector:
        return [self.do.in_lanes(x, towards[0]) for x in (0.0, 0.0, 1.0)]
