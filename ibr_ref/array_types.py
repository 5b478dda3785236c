"""Names for the arrays of annotations, by what they hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Indices = NDArray[np.int32]
"""Of vertices, texels and steps, as kernels keep them."""
Bytes = NDArray[np.uint8]
"""Codes of colours, counts of samples."""
