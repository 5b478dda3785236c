"""Stage 5: the winners' colours."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.atlas import Integers
from ibr_ref.oracle.ports.splatting.stage import Stage


class Resolve(Stage):
    """The picture."""

    def color(self, vertices: dict[str, Any], winner: Integers) -> Floats:
        """(H, W, 3)."""
        shown = self.shown(winner)
        color = np.where(shown[:, :, None], self.splat_color(vertices["vertex.color"], winner), self.background())
        return self.alu.color(self.written(color))

    def shown(self, winner: Integers) -> Bools:
        """Where there is a winner."""
        return np.asarray(winner >= 0)

    def splat_color(self, colors: Floats, winner: Integers) -> Floats:
        """(H, W, 3) of the winners; anything where there is none."""
        return np.asarray(colors[winner])

    def background(self) -> Floats:
        """(3,) elsewhere."""
        return self.alu.number(self.scene.background)

    def written(self, color: Floats) -> Floats:
        """What is sent to the frame buffer."""
        return color
