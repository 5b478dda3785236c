"""Colours as ports hand them in, in bytes or in floats."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Floats


def as_numbers(array: Any) -> Floats:
    """Any array in float64: bytes k as k/255, from 0 to 1, other numbers as they are."""
    scale = 255.0 if np.asarray(array).dtype == np.uint8 else 1.0
    return np.asarray(array, np.float64) / scale
