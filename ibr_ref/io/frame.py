"""What every render returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.images import png_bytes, write_image
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

    def __repr__(self) -> str:
        height, width = self.depth.shape
        stages = list(dict.fromkeys(name.partition(".")[0] for name in self.stages))
        return f"Frame({width} x {height}, {'stages ' + ', '.join(stages) if stages else 'no stages'})"

    def _repr_png_(self) -> bytes:
        """What notebooks show: the picture."""
        return png_bytes(self.color)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the picture, in 8 bits, in the format that the name's ending says."""
        write_image(path, self.color)

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
