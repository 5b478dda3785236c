"""PFM images (portable float map): a header in words, then 32-bit floats, the bottom row first.

Where from: Debevec's HDR Shop and the netpbm page of the format, which agree: `PF` (three channels) or `Pf` (one), width,
height, and a number whose sign says the byte order (negative: little-endian). Its size is a hint for viewers, and all
sets of stereo images leave it out of account, as here.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.io.sizes import check_size

SIGNATURES = (b"PF", b"Pf")

_HEADER = re.compile(rb"(P[Ff])\s+(\d{1,9})\s+(\d{1,9})\s+([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?:\r\n|\s)")
_LONGEST_HEADER = 200
_BYTES = 4


def decode(data: bytes) -> NDArray[np.float32]:
    """The values of a PFM file as they are stored, row 0 on top: (H, W), or (H, W, 3) RGB; NaN and infinities stay.

    Raises ValueError for a header that is none, more than 2^28 pixels, and a file that is too short or too long for them.
    """
    header = _HEADER.match(data[:_LONGEST_HEADER])
    if header is None:
        raise ValueError(f"found a PFM header {data[:40]!r}, allowed: PF or Pf, width, height and a scale, in words")
    width, height = int(header[2]), int(header[3])
    check_size(width, height)
    shape = (height, width, 3) if header[1] == b"PF" else (height, width)
    needed, there = _BYTES * int(np.prod(shape)), len(data) - header.end()
    if there != needed:
        raise ValueError(f"found {there} bytes of PFM values, {needed} needed for the {width} x {height} of its header")
    order = "<" if header[4].startswith(b"-") else ">"
    stored = np.frombuffer(data, f"{order}f4", offset=header.end()).reshape(shape)
    return stored[::-1].astype(np.float32)


def encode(image: ArrayLike) -> bytes:
    """A little-endian PFM file of (H, W) or (H, W, 3) values, row 0 on top."""
    values = np.asarray(image)
    word = "PF" if values.ndim == 3 else "Pf"
    return f"{word}\n{values.shape[1]} {values.shape[0]}\n-1.0\n".encode() + values[::-1].astype("<f4").tobytes()
