"""Numbers of fewer bits, which broken ports keep theirs in."""

from __future__ import annotations

from typing import Any

import numpy as np


def half(x: Any) -> Any:
    """A float of 16 bits: of arrays, and of numbers with bounds, which have the same method."""
    return x.astype(np.float16).astype(np.float64)
