"""The vertex stage's transforms for whole arrays of vertices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def transformed(matrix: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(V, rows) a matrix (rows, 4) applied to points (V, 4), or (V, 3) with w = 1; each row summed from left to right."""
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    if points.shape[1] == 3:
        return np.stack([row[0] * x + row[1] * y + row[2] * z + row[3] for row in matrix], axis=1)
    w = points[:, 3]
    return np.stack([row[0] * x + row[1] * y + row[2] * z + row[3] * w for row in matrix], axis=1)
