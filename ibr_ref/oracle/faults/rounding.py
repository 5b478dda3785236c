"""Numbers of fewer bits, which broken ports keep theirs in."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Floats


def half(x: Any) -> Floats:
    """A float of 16 bits."""
    return np.asarray(x, np.float16).astype(np.float64)
