"""Images whose samples stand for depths."""

from __future__ import annotations

from os import PathLike

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import png
from ibr_ref.io.files import contents, naming
from ibr_ref.scene.checks import named

_BITS, _BITS_ALLOWED = 24, (8, 16)
"""The byte of a PNG file that holds the bits of a sample."""


def depth_codes(path: str | PathLike[str], alpha: bool = False) -> tuple[NDArray[np.float64], int]:
    """Read whole numbers (H, W), and the largest that they could be: 255 or 65535. With `alpha`, from that channel.

    Raises ValueError for anything but a PNG of 8 or 16 bits, grey or RGB with equal channels (or with alpha): a lossy
    format would make points of the background, and the errors of `read_image`.
    """
    data = contents(path)
    if not data.startswith(png.SIGNATURE):
        raise ValueError(f"{named(path)}: found a file that starts with {data[:8]!r}, allowed for depths: a PNG image")
    with naming(path):
        image = png.decode(data)
        if data[_BITS] not in _BITS_ALLOWED:
            raise ValueError(f"found {data[_BITS]} bits, allowed for depths: 8 or 16")
        last = 2 ** data[_BITS] - 1
        channels = 1 if image.ndim == 2 else image.shape[2]
        if alpha:
            if channels not in (2, 4):
                raise ValueError("found no alpha channel, allowed for depths without an image of their own: one")
            return np.rint(image[..., -1] * last), last
        if channels not in (1, 3):
            raise ValueError(f"found {channels} channels, allowed for depths: grey, or RGB with equal channels")
        codes = np.rint(image * last).reshape(*image.shape[:2], channels)
        bad = (codes != codes[..., :1]).any(axis=2)
        if bad.any():
            row, column = np.argwhere(bad)[0].tolist()
            found = codes[row, column].astype(int).tolist()
            raise ValueError(f"found {found} at row {row}, column {column}, allowed for depths: equal channels")
        return codes[..., 0].copy(), last
