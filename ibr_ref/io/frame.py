"""What every render returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.images import png_bytes, write_image
from ibr_ref.io.outputs import atomic
from ibr_ref.scene import Camera, DepthImage


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

    def save(self, path: str | PathLike[str], bits: int = 8) -> None:
        """Write the picture as `write_image` does: .png in 8 or 16 bits, .jpg, or .exr with the colours as they are."""
        write_image(path, self.color, bits)

    def depth_image(self, camera: Camera) -> DepthImage:
        """The picture as a reference image of splatting: of the camera that it was drawn for, where anything is shown.

        Depths are the inverse of the camera's window depth, hence as near as float64 has them between near and far.
        Raises ValueError for a camera for pictures of another size.
        """
        near, far, shown = camera.near, camera.far, self.depth < 1.0
        if camera.perspective:
            depth = near * far / (far - self.depth * (far - near))
        else:
            depth = near + self.depth * (far - near)
        return DepthImage(color=self.color, depth=depth, camera=camera, mask=shown & (depth > 0.0))

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
