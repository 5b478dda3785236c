"""Stage 5: the winners' colours."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.programs.splatting.case import Bools, Case, Floats, Ints


class Resolve(Case):
    """The picture."""

    def resolve(self, colors: Floats, winner: Ints) -> Floats:
        """(H, W, 3), of the points' colours (V, 3) and the winners (H, W)."""
        row, column = np.indices(winner.shape)
        shown = self.shown(winner) & self.drawn(row, column)
        return self.rows(self.picture(colors, winner[self.read_at(row, column)], shown))

    def read_at(self, row: Ints, column: Ints) -> tuple[Ints, Ints]:
        """The pixels whose winners' colours are fetched: their own."""
        return row, column

    def shown(self, winner: Ints) -> Bools:
        """Where there is a winner."""
        return winner >= 0

    def drawn(self, row: Ints, column: Ints) -> Bools:
        """The pixels that the pass over the picture covers: all."""
        return np.ones(np.shape(row), np.bool_)

    def picture(self, colors: Floats, winner: Ints, shown: Bools) -> Floats:
        """(..., 3) what pixels (...) hold in the frame buffer."""
        color = np.where(shown[..., None], self.splat_color(colors, winner), self.background())
        return self.do.color(self.written(color))

    def splat_color(self, colors: Floats, winner: Ints) -> Floats:
        """(..., 3) of the winners; anything where there is none."""
        return colors[winner]

    def background(self) -> Floats:
        """(3,) elsewhere."""
        return self.do.number(self.scene.background)

    def written(self, color: Floats) -> Floats:
        """What is sent to the frame buffer."""
        return color

    def rows(self, picture: Any) -> Any:
        """The colour buffer (H, W, 3) as it is handed in: from the top. A fault's is its own inverse."""
        return picture
