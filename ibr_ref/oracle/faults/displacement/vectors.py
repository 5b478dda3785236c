"""The light, or the eye of its highlights, somewhere else."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.programs.displacement.case import Patch
from ibr_ref.oracle.programs.displacement.case import Vector as Components


def lit_from(port: type[Any], place: Floats) -> type[Any]:
    """A program with another place of the lamp, or another direction (3,); where shadows fall is right."""

    class LitFrom(port):  # type: ignore[misc]
        def light_way(self, patch: Patch, world: Components) -> Components:
            return self.towards(self.upload(np.append(place, self.scene.light.homogeneous[3])), world)

    return LitFrom


def seen_from(port: type[Any], place: Floats) -> type[Any]:
    """A program whose highlights are for another eye (3,)."""

    class SeenFrom(port):  # type: ignore[misc]
        def eye_way(self, patch: Patch, world: Components) -> Components:
            return self.towards(self.upload(np.append(place, self.scene.camera.eye[3])), world)

    return SeenFrom
