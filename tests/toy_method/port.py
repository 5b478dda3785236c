"""The method as someone ports it, and with a bug."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.faults.kinds import Mutant, Variant


class Port:
    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        self.camera, self.tint, self.gain = scene.camera, np.float32(scene.tint), np.float32(params.gain)

    def place(self) -> NDArray[np.float32]:
        rows, columns = np.mgrid[: self.camera.height, : self.camera.width].astype(np.float32)
        return rows + columns

    def render(self) -> dict[str, NDArray[np.generic]]:
        level = self.gain * (self.place() / np.float32(self.camera.width + self.camera.height))
        depth = np.full(level.shape, 0.5, np.float32)
        return {"shade.level": level, "color": level[..., None] * self.tint, "depth": depth}


class Centres(Port):
    def place(self) -> NDArray[np.float32]:
        return super().place() + np.float32(1.0)


VARIANTS = (Variant("float32", Policy(), "ieee32"),)
MUTANTS = (Mutant("pixels' centres", "takes the level at the centre, not at the corner", "shade", Centres),)
