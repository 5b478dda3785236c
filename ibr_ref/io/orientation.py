"""Which way up a camera says that its picture is: the Exif tag Orientation."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

PREFIX = b"Exif\0\0"
"""Before the tags in a JPEG file; a PNG file has them alone."""

_ORIENTATION = 0x0112
_UPRIGHT = 1


def orientation(exif: bytes | None) -> int:
    """The tag's value, 1 to 8, of Exif tags without `PREFIX`; 1, upright, where they are none, damaged or do not say."""
    if not exif:
        return _UPRIGHT
    from PIL import Image  # here, so that importing ibr_ref.io stays cheap

    tags = Image.Exif()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow's, of whatever else is odd in there
            tags.load(PREFIX + exif)
            value = tags.get(_ORIENTATION)
    except Exception:  # as every viewer does: the pixels are whole, whatever is said of them
        return _UPRIGHT
    return value if isinstance(value, int) and 1 <= value <= 8 else _UPRIGHT


def upright(image: NDArray[np.float64], value: int) -> NDArray[np.float64]:
    """The image (H, W) or (H, W, C) turned or mirrored as the tag's value says; 5 to 8 exchange rows and columns."""
    if value >= 5:
        image = np.swapaxes(image, 0, 1)
    if value in (3, 4, 7, 8):
        image = image[::-1]
    if value in (2, 3, 6, 7):
        image = image[:, ::-1]
    return np.ascontiguousarray(image)
