"""Colours as they are stored in files: whole numbers of 8 or 16 bits."""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene.checks import named


def checked(path: str | PathLike[str], image: ArrayLike) -> NDArray[Any]:
    """The image as an array of floats or bools."""
    values = np.asarray(image)
    if values.ndim not in (2, 3) or (values.ndim == 3 and values.shape[2] != 3) or not values.size:
        raise ValueError(
            f"{named(path)}: found an image of shape {values.shape}, allowed: (H, W) or (H, W, 3), not empty"
        )
    if values.dtype.kind not in "fb":
        # 0 to 255, most likely: clamped to [0, 1], it would be white all over.
        raise ValueError(f"{named(path)}: found an image of {values.dtype}, allowed: floats in [0, 1]")
    if np.isnan(values).any():
        raise ValueError(f"{named(path)}: found NaN at {np.argwhere(np.isnan(values))[0].tolist()}, allowed: numbers")
    return values


def quantized(values: NDArray[Any], bits: int) -> NDArray[np.unsignedinteger]:
    """Conventions, Numbers: floor(255 c + 0.5) after clamping."""
    levels = float(2**bits - 1)
    steps = np.floor(np.clip(values.astype(np.float64), 0.0, 1.0) * levels + 0.5)
    return steps.astype(np.uint8 if bits == 8 else np.uint16)
