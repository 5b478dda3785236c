"""What every render returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.files import atomic
from ibr_ref.io.images import write_image


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """A picture, its depth, and the arrays of all stages that led to it."""

    color: NDArray[np.float64]
    """(H, W, 3) linear, in [0, 1]; row 0 on top."""
    depth: NDArray[np.float64]
    """(H, W) window depth: 0 at the near plane, 1 at the far plane and where nothing is shown."""
    stages: dict[str, NDArray[np.generic]] = field(default_factory=dict)
    """Arrays by name, "stage.array"; empty if the frame was rendered with stages=False."""

    def save(self, path: str | PathLike[str]) -> None:
        """Write the picture, in 8 bits, in the format that the name's ending says."""
        write_image(path, self.color)

    def save_stages(self, path: str | PathLike[str]) -> None:
        """Write the stages, and `color` and `depth` with them, as a NumPy archive (.npz, no pickles)."""
        arrays = {"color": self.color, "depth": self.depth, **self.stages}
        with atomic(path) as file:
            np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
