"""Points of depth images as a PLY file, which MeshLab, CloudCompare and Open3D show."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

import numpy as np

from ibr_ref.io.outputs import atomic
from ibr_ref.scene import DepthImage, checks

_ROW = np.dtype([(axis, "<f8") for axis in "xyz"] + [(channel, "u1") for channel in ("red", "green", "blue")])
_HEADER = """ply
format binary_little_endian 1.0
element vertex {count}
{properties}
end_header
"""


def write_point_cloud(path: str | PathLike[str], images: Sequence[DepthImage]) -> None:
    """Write the points of all valid pixels, in the order of image, row and column: a binary PLY file.

    Positions are in world space, doubles; colours bytes, floor(255 c + 0.5). Raises ValueError, with the path, for what is
    no sequence of DepthImages, and for one without a valid pixel; OSError where it cannot be written.
    """
    if not isinstance(images, Sequence) or not all(isinstance(image, DepthImage) for image in images):
        found = type(images).__name__
        raise ValueError(f"{checks.named(path)}: images: found {found}, allowed: a sequence of DepthImages")
    count = sum(int(image.arrays[2].sum()) for image in images)
    if not count:
        raise ValueError(
            f"{checks.named(path)}: found {len(images)} images without a valid pixel, allowed: at least one"
        )
    properties = "\n".join(f"property {'double' if name in 'xyz' else 'uchar'} {name}" for name in _ROW.names or ())
    with atomic(path) as file:
        file.write(_HEADER.format(count=count, properties=properties).encode())
        for image in images:
            color, _, mask = image.arrays
            rows = np.empty(int(mask.sum()), _ROW)
            for axis, values in zip("xyz", image.points.T, strict=True):
                rows[axis] = values
            for channel, levels in zip(("red", "green", "blue"), np.floor(255.0 * color[mask] + 0.5).T, strict=True):
                rows[channel] = levels
            file.write(rows.tobytes())
