"""8-bit PNG images of cases and submissions, by size before they are decoded."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import png
from ibr_ref.io.files import contents, naming
from ibr_ref.oracle.files.problem import UnusableError

MOST_BYTES = 64
"""Of a PNG file, for each byte of its pixels, and beyond the first MiB: what is larger is something else."""


def read_bytes(path: Path, shapes: Sequence[tuple[int, ...]], name: object = None) -> NDArray[np.uint8]:
    """The samples of a PNG of one of the shapes, (H, W) or (H, W, C), all with the same H and W.

    Raises UnusableError, or ValueError with the path, for other files, other sizes, and samples finer than 8 bits.
    """
    name = path if name is None else name
    height, width = shapes[0][:2]
    most = 2**20 + MOST_BYTES * height * width
    if path.stat().st_size > most:
        raise UnusableError(name, f"{path.stat().st_size} bytes", f"at most {most} for {height} x {width} pixels")
    data = contents(path)
    if not data.startswith(png.SIGNATURE) or len(data) < 33:
        raise UnusableError(name, f"{len(data)} bytes that start with {data[:8]!r}", "a PNG image")
    size = struct.unpack(">II", data[16:24])[::-1]
    if size != (height, width):
        raise UnusableError(
            name, f"{size[0]} rows of {size[1]} pixels{turned(size, (height, width))}", f"{height} rows of {width}"
        )
    with naming(path):
        image = png.decode(data)
    if image.shape not in shapes:
        raise UnusableError(name, f"an image of shape {image.shape}", " or ".join(map(str, shapes)))
    codes = np.rint(255.0 * image).astype(np.uint8)
    if not (codes / 255.0 == image).all():
        raise UnusableError(name, "samples of 16 bits", "8 bits a sample")
    return codes


def turned(found: tuple[int, ...], allowed: tuple[int, ...]) -> str:
    """A remark on shapes that have rows and columns exchanged."""
    same_rest = len(found) == len(allowed) >= 2 and found[2:] == allowed[2:]
    exchanged = same_rest and found[:2] == (allowed[1], allowed[0]) != allowed[:2]
    return " (rows and columns exchanged?)" if exchanged else ""
