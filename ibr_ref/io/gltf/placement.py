"""Where a node stands. Sums from left to right: the same bits on every machine."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.io.gltf.document import Node, refused
from ibr_ref.pipeline.transform import transformed

_UNIT = 1e-3
"""How far the square of a quaternion's length may be from 1."""
_AFFINE = 1e-6


def placement(node: Node, name: str, parent: Floats) -> Floats:
    """(4, 4) world from node, under its parent. Raises ValueError for what is no affine placement."""
    parts = (node.translation, node.rotation, node.scale)
    if node.matrix is None:
        local = _composed(name, *parts)
    elif any(part is not None for part in parts):
        raise refused(name, "a matrix beside translation, rotation or scale", "one of both")
    else:
        local = np.array(node.matrix).reshape(4, 4).T  # column by column
        if np.abs(local[3] - (0.0, 0.0, 0.0, 1.0)).max() > _AFFINE:
            raise refused(f"{name}.matrix", f"the last row {local[3].tolist()}", "0, 0, 0, 1")
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite, the mesh refuses
        return np.vstack([transformed(parent[:3], local.T).T, (0.0, 0.0, 0.0, 1.0)])


def _composed(
    name: str, translation: list[float] | None, rotation: list[float] | None, scale: list[float] | None
) -> Floats:
    """Scaled, then turned by a quaternion x, y, z, w, then moved."""
    x, y, z, w = rotation or (0.0, 0.0, 0.0, 1.0)
    square = x * x + y * y + z * z + w * w
    if not abs(square - 1.0) <= _UNIT:
        raise refused(f"{name}.rotation", rotation, "a quaternion of length 1")
    s = 2.0 / square
    turn = np.array(
        [
            [1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
            [s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w)],
            [s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y)],
        ]
    )
    local = np.eye(4)
    local[:3, :3] = turn * (scale or (1.0, 1.0, 1.0))
    local[:3, 3] = translation or (0.0, 0.0, 0.0)
    return local


def moved(points: Floats, matrix: Floats) -> Floats:
    """(V, 3) points in the world."""
    with np.errstate(over="ignore", invalid="ignore"):
        return transformed(matrix[:3], points)


def is_mirrored(matrix: Floats) -> bool:
    """Whether left becomes right."""
    (a, b, c), (d, e, f), (g, h, i) = matrix[:3, :3].tolist()
    return bool(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0)
