"""The light, or the eye of its highlights, somewhere else."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.programs.splatting.case import Image
from ibr_ref.oracle.programs.splatting.case import Vector as Components
from ibr_ref.scene.vectors import unit


def lit_from(port: type[Any], place: Floats) -> type[Any]:
    """A program with another place of the lamp, or another direction (3,), whose length says nothing."""

    class LitFrom(port):  # type: ignore[misc]
        def towards_light(self, world: Components) -> Components:
            w = self.scene.light.homogeneous[3]
            return self.towards(np.append(place if w else unit(place), w), world)

    return LitFrom


def seen_from(port: type[Any], place: Floats) -> type[Any]:
    """A program whose highlights are for another eye (3,)."""

    class SeenFrom(port):  # type: ignore[misc]
        def eye(self, image: Image) -> Any:
            return np.append(place, self.scene.camera.eye[3])

    return SeenFrom
