"""TIFF images, strips or tiles: the stored numbers, and what GeoTIFF tags say of them (`geotiff`). tifffile decodes.

Pillow reads 8 and 16 bits and 32-bit floats as well (`tests/io/test_tiff.py` compares them), but no 16-bit and 64-bit
floats and no colours of more than 8 bits; compressed big-endian samples come out of it with their bytes exchanged.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.extras import needed
from ibr_ref.io.orientation import upright
from ibr_ref.io.sizes import check_size

SIGNATURES = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
"""The last two: BigTIFF."""

_COMPRESSIONS = {
    1: "none",
    5: "LZW",
    8: "Deflate",
    32946: "Deflate",
    32773: "PackBits",
    34925: "LZMA",
    50000: "Zstandard",
}
"""Without loss, and such that a library that does no more than inflate bytes decodes them."""
_PREDICTORS = (1, 2, 3)
_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB = 0, 1, 2
_ORIENTATION = 274
_FILES = "TIFF files"
_MOST_BYTES_PER_BYTE = 2**16
"""As in `exr`."""


@dataclass(frozen=True, eq=False)
class Tiff:
    """The first image of a file."""

    samples: NDArray[Any]
    """(H, W), or (H, W, C) with C = 2 to 4, as they are stored: unsigned, signed or floats; row 0 on top."""
    white: int | None
    """What white is in unsigned samples, 2^bits - 1; None for others."""
    tags: Mapping[int, Any] = field(default_factory=dict)
    """By number."""


def decode(data: bytes) -> Tiff:
    """Decode the first image of a TIFF or BigTIFF file: 1 to 64 bits, grey or RGB, turned as its tag Orientation says.

    Raises ValueError for a file that is damaged, cut off or too large, and for palettes, CMYK, YCbCr and JPEG within TIFF.
    """
    needed("imagecodecs", _FILES)  # first: tifffile does without for as long as the process lives
    tifffile = needed("tifffile", _FILES)
    logging.getLogger("tifffile").addHandler(logging.NullHandler())  # its warnings are no second line of ours
    try:
        with BytesIO(data) as stream, tifffile.TiffFile(stream) as file:  # closed: its pages and it hold one another
            page = file.pages.first
            _check(page, len(data))
            samples = page.asarray()
            tags = {tag.code: tag.value for tag in page.tags}
    except Exception as error:  # of damaged data: of whatever kind
        if isinstance(error, (MemoryError, ValueError)) and str(error).startswith("found "):
            raise
        raise ValueError(f"found a damaged TIFF image of {len(data)} bytes, allowed: a whole one") from None
    if samples.shape[:2] != (page.imagelength, page.imagewidth) or samples.ndim > 3:
        raise ValueError(f"found a TIFF image of shape {samples.shape}, allowed: rows and columns, 1 to 4 samples each")
    white = 2**page.bitspersample - 1 if samples.dtype.kind in "ub" else None
    samples = samples.astype(np.uint8) if samples.dtype.kind == "b" else samples
    if page.photometric == _WHITE_IS_ZERO and white is not None:
        samples = (white - samples).astype(samples.dtype)
    return Tiff(upright(samples, tags.get(_ORIENTATION, 1)), white, tags)


def _check(page: Any, size: int) -> None:
    """Before anything is decoded: that the image is one of those that are read, and all there in so many bytes."""
    if page.compression not in _COMPRESSIONS or page.predictor not in _PREDICTORS:
        found = f"compression {int(page.compression)}, predictor {int(page.predictor)}"
        raise ValueError(f"found a TIFF image of {found}, allowed: {', '.join(dict.fromkeys(_COMPRESSIONS.values()))}")
    if page.photometric not in (_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB) or not 1 <= page.samplesperpixel <= 4:
        found = f"colours of kind {int(page.photometric)}, {page.samplesperpixel} samples a pixel"
        raise ValueError(f"found a TIFF image with {found}, allowed: grey or RGB, and alpha")
    if page.dtype is None or np.dtype(page.dtype).kind not in "biuf" or page.imagedepth != 1:
        raise ValueError(f"found a TIFF image of {page.bitspersample} bits, format {int(page.sampleformat)}, allowed: "
                         "unsigned and signed integers and floats")  # fmt: skip
    if page.bitspersample % 8 and page.samplesperpixel > 1:
        raise ValueError(f"found a TIFF image of {page.bitspersample} bits a sample and several samples, allowed: one")
    check_size(page.imagewidth, page.imagelength)
    if page.is_tiled:
        check_size(page.tilewidth, page.tilelength)
    if page.nbytes > _MOST_BYTES_PER_BYTE * size:
        raise ValueError(
            f"found {page.imagewidth} x {page.imagelength} pixels in {size} bytes of TIFF image, allowed: at most "
            f"{_MOST_BYTES_PER_BYTE} bytes of them a byte"
        )
    blocks, parts = int(np.prod(page.chunked)), list(zip(page.dataoffsets, page.databytecounts, strict=False))
    end = max((start + count for start, count in parts), default=0)
    if page.is_contiguous:
        end = max(end, page.dataoffsets[0] + page.nbytes)
    if len(parts) < blocks or end > size:
        raise ValueError(
            f"found a truncated TIFF image of {len(parts)} strips or tiles in {size} bytes, {blocks} in {end} needed"
        )
