"""JPEG images, refused where they are cut off.

Wrong bits inside a whole file may go unnoticed: JPEG has no checksums, and libjpeg's warnings do not reach Pillow.
"""

from __future__ import annotations

from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.sizes import check_size

SIGNATURE = b"\xff\xd8\xff"

_SCAN, _END = 0xDA, b"\xff\xd9"
_STANDALONE = {0x01, *range(0xD0, 0xD9)}
"""Markers that no length follows."""
_KEPT_APPS = {0xE0, 0xEE}
"""JFIF and Adobe: which colour space the samples are in."""
_MAX_PIXELS_PER_BYTE = 512
"""A Huffman-coded scan spends at least one bit on each block of 8 x 8 pixels."""


def decode(data: bytes) -> NDArray[np.float64]:
    """Decode a JPEG file, k / 255, to (H, W) grey or (H, W, 3) RGB, as stored: an Exif orientation is not applied.

    Raises ValueError or one of Pillow's errors for a file that is damaged, cut off, too large, or neither grey nor RGB.
    """
    # Here, so that importing ibr_ref.io stays cheap; the plugin's class, not imageio, whose Image.open has a lower limit
    # on sizes than ours.
    from PIL.JpegImagePlugin import JpegImageFile

    image = JpegImageFile(BytesIO(_pixels_only(data)))
    check_size(image.width, image.height)
    if image.width * image.height > _MAX_PIXELS_PER_BYTE * len(data):
        raise ValueError(f"found {len(data)} bytes of JPEG image, too few for {image.width} x {image.height} pixels")
    if image.mode not in ("L", "RGB"):
        raise ValueError(f"found a JPEG image in {image.mode}, allowed: grey or RGB")
    return np.asarray(image) / 255.0


def _pixels_only(data: bytes) -> bytes:
    """Drop thumbnails, Exif, profiles and comments: Pillow would parse them, and warn of what is odd there.

    The end marker must be there: where only the last rows are missing, Pillow may return the image without them.
    """
    parts, start = [data[:2]], 2
    while start + 4 <= len(data) and data[start] == 0xFF:
        marker = data[start + 1]
        if marker == _SCAN:
            if data.find(_END, start) < 0:
                break
            return b"".join([*parts, data[start:]])
        if marker == 0xFF or marker in _STANDALONE:
            start += 1 if marker == 0xFF else 2
            continue
        end = start + 2 + int.from_bytes(data[start + 2 : start + 4])
        if marker < 0xE0 or marker in _KEPT_APPS:
            parts.append(data[start:end])
        start = end
    raise ValueError(f"found {len(data)} bytes that start as a JPEG image, but not all of it up to its end marker")
