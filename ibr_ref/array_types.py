"""Names for the arrays of annotations, by what they hold, and for what compiled functions hand on as scalars."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Indices = NDArray[np.int32]
"""Of vertices, texels and steps, as kernels keep them."""
Bytes = NDArray[np.uint8]
"""Codes of colours, counts of samples."""

Texels = NDArray[np.float64]
"""(rows * columns,) or (rows * columns * 3,): a texture as kernels read it, flat, rows from v = 0."""
Lanes = NDArray[np.float64]
"""(LANES,): one number for each fragment of a wave."""
Wrap = bool | None
"""Of a texture: None clamps, True repeats; a type to the compiler, which leaves the other way out."""

Vector3 = tuple[float, float, float]
"""A point, a direction or a colour as scalars: compiled code keeps no small arrays."""
Vector4 = tuple[float, float, float, float]
"""A homogeneous point or direction, or a row of a (4, 4) matrix."""

Whole = Any
"""An integer that NumPy makes. To mypy it is no int, nor is what is reckoned with it."""
