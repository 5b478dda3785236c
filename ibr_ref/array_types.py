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

Integer = int | np.int32 | np.int64 | np.uint32
"""A scalar that some callers have as a plain int, others in one of NumPy's widths."""

Texels = NDArray[np.float64]
"""(rows * columns,) or (rows * columns * 3,): a texture as kernels read it, flat, rows from v = 0."""
Lanes = NDArray[np.float64]
"""(LANES,): one number for each fragment of a wave."""
IndexLanes = NDArray[np.int32]
"""(LANES,): one index for each fragment of a wave."""
Wrap = bool | None
"""Of a texture: None clamps, True repeats; a type to the compiler, which leaves the other way out."""
