"""What every render returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.images import write_image
from ibr_ref.io.outputs import atomic


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """A picture, its depth, and the arrays of all stages that led to it."""

    color: NDArray[np.float64]
    """(H, W, 3) linear, in [0, 1]; row 0 on top."""
    depth: NDArray[np.float64]
    """(H, W) window depth: 0 at the near plane, 1 at the far plane and where nothing is shown."""
    stages: dict[str, Any] = field(default_factory=dict)
    """Arrays by name, "stage.array" (of an atlas: a tuple of them, one a page); empty with stages=False."""

    def save(self, path: str | PathLike[str], bits: int = 8) -> None:
        """Write the picture as `write_image` does: .png in 8 or 16 bits, .jpg, or .exr with the colours as they are."""
        write_image(path, self.color, bits)

    def save_stages(self, path: str | PathLike[str]) -> None:
        """Write the stages, and `color` and `depth` with them, as a NumPy archive (.npz, no pickles).

        A stage of several arrays is written as "stage.array.0", "stage.array.1" and so on.
        """
        arrays: dict[str, Any] = {"color": self.color, "depth": self.depth}
        for name, stage in self.stages.items():
            if isinstance(stage, tuple):
                arrays.update({f"{name}.{i}": array for i, array in enumerate(stage)})
            else:
                arrays[name] = stage
        with atomic(path) as file:
            np.savez_compressed(file, **arrays)
