"""Boxes around points."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats


def box_corners(points: ArrayLike) -> Floats:
    """(8, 3) corners of the box, along the axes, around points (N, 3)."""
    points = np.asarray(points, np.float64)
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)])
