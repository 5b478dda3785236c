"""The light of colours, or the eye that normals are turned to, somewhere else."""

from __future__ import annotations

from typing import Any

from ibr_ref.array_types import Floats
from ibr_ref.oracle.programs.program import Vector as Components


def lit_from(port: type[Any], place: Floats) -> type[Any]:
    """A program with another place (3,) of the light, in colours alone."""

    class LitFrom(port):  # type: ignore[misc]
        def toward_light(self, world: Components) -> Components:
            return self.do.unit([self.do.subtract(at, p) for p, at in zip(world, self.do.number(place), strict=True)])

    return LitFrom


def turned_to(port: type[Any], place: Floats) -> type[Any]:
    """A program whose normals are turned to another eye (3,)."""

    class TurnedTo(port):  # type: ignore[misc]
        def toward_eye(self, world: Components) -> Components:
            return [self.do.subtract(at, p) for p, at in zip(world, self.do.number(place), strict=True)]

    return TurnedTo
