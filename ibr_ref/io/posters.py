"""Pictures larger than memory: tiled TIFF files that are written band by band as they are drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.extras import needed
from ibr_ref.io.outputs import atomic
from ibr_ref.io.parts import Rows
from ibr_ref.io.samples import checked, quantized

_TILE = 256
"""Pixels a side of a tile; in very wide pictures tiles are lower."""
_MOST_PIXELS = 2**22
"""Of a band."""


def write_poster(
    path: str | PathLike[str],
    draw: Callable[[Rows], NDArray[np.float64]],
    width: int,
    height: int,
    bits: int = 8,
    progress: Callable[[str, int, int], None] | None = None,
) -> None:
    """Write a picture of `width` x `height` pixels as a tiled TIFF (BigTIFF, Deflate) without having all of it at once.

    draw((first, stop)) gives these rows, (stop - first, width, 3), in [0, 1]: `lambda rows: render(scene, stages=False,
    rows=rows).color`. It is called for one band after another, of at most 256 rows and 4 million pixels. Samples are
    floor(c (2^bits - 1) + 0.5) of what is clamped to [0, 1], bits 8 or 16, as `write_image` has them. progress(words, done,
    total) is called with rows. Needs ibr_ref[io]. Raises OSError for a path that cannot be written, ValueError for bands
    that are none.
    """
    tifffile = needed("tifffile", "TIFF files")
    tile = (_band_rows(width), _TILE, 3)
    tiles = _tiles(path, draw, width, height, bits, tile, progress)
    with atomic(path) as file, tifffile.TiffWriter(_named(tifffile, file), bigtiff=True) as writer:
        writer.write(
            tiles,
            shape=(height, width, 3),
            dtype=np.uint8 if bits == 8 else np.uint16,
            tile=tile[:2],
            photometric="rgb",
            compression="zlib",
            software=False,
            metadata=None,
        )


def poster_bands(width: int, height: int) -> list[Rows]:
    """The rows that `write_poster` asks for, one band after another."""
    step = _band_rows(width)
    return [(first, min(height, first + step)) for first in range(0, height, step)]


def _band_rows(width: int) -> int:
    return min(_TILE, max(16, _MOST_PIXELS // width // 16 * 16))


def _named(tifffile: Any, file: Any) -> Any:
    """An open file with a name, which tifffile asks for: a temporary one has none."""
    return tifffile.FileHandle(file, name="picture.tif", size=0)


def _tiles(
    path: Any, draw: Any, width: int, height: int, bits: int, tile: tuple[int, int, int], progress: Any
) -> Iterator[NDArray[Any]]:
    """Row by row of tiles, from left to right; those at the right and lower edges filled up with black."""
    for first in range(0, height, tile[0]):
        rows = (first, min(height, first + tile[0]))
        band = checked(path, draw(rows))
        if band.shape != (rows[1] - rows[0], width, 3):
            found, allowed = band.shape, (rows[1] - rows[0], width, 3)
            raise ValueError(f"rows {rows[0]} to {rows[1] - 1}: found an array {found}, allowed: {allowed}")
        if progress is not None:
            progress("rows", rows[1], height)
        for left in range(0, width, tile[1]):
            part = quantized(band[:, left : left + tile[1]], bits)
            whole = np.zeros(tile, part.dtype)
            whole[: part.shape[0], : part.shape[1]] = part
            yield whole
