"""Heights as files hold them: stored numbers, and what the file says that they are."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import cos, isqrt, radians
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import geotiff, images, tiff
from ibr_ref.io.sizes import check_size
from ibr_ref.io.values import decoded, is_exr, is_pfm, is_tiff

RAW_ENDINGS = (".raw", ".r8", ".r16", ".r32")

_GREY_TOLERANCE = 4.5 / 255.0
"""Channels that differ by less are one grey, as lossy compression leaves it."""
_RAW_TYPES = {1: "u1", 2: "u2", 4: "f4"}
"""By bytes a sample."""
_HGT_SIDES = (1201, 3601)
_HGT_VOID = -32768.0
_HGT_NAME = re.compile(r"[NS](\d\d)[EW]\d\d\d", re.IGNORECASE)
_METRES_PER_DEGREE = 111_195.0
"""Of the mean sphere, 6,371.0 km."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Elevations:
    """What a height file holds: heights are stored x scale + offset."""

    stored: NDArray[Any]
    """(H, W), row 0 on top."""
    white: float | None = None
    """The largest number that can be stored, of unsigned integers without a scale of their own; they start at 0."""
    nodata: float | None = None
    """The stored number where there is no height."""
    scale: float = 1.0
    offset: float = 0.0
    texel_size: tuple[float, float] | None = None
    """Width and height of a texel in the units of the heights."""


def of_tiff(data: bytes) -> Elevations:
    """Of a TIFF file: one sample a pixel or equal ones, with what GeoTIFF and GDAL say of them."""
    image = tiff.decode(data)
    stored = image.samples
    if stored.ndim == 3:
        stored = _of_channels(stored, 1.0 if image.white is None else float(image.white))
    scale, offset = geotiff.scale_and_offset(image.tags)
    return Elevations(
        stored=stored,
        white=image.white if (scale, offset) == (1.0, 0.0) else None,
        nodata=geotiff.nodata(image.tags),
        scale=scale,
        offset=offset,
        texel_size=geotiff.texel_size(image.tags),
    )


def of_picture(data: bytes, exif: bool) -> Elevations:
    """Of a PNG or JPEG file."""
    white = images.white(data)
    values = images.decoded(data, exif)
    values = values if values.ndim == 2 else _of_channels(values, 1.0)
    return Elevations(stored=np.rint(values * white), white=white)


def of_values(data: bytes) -> Elevations:
    """Of an EXR or PFM file."""
    values = decoded(data)
    return Elevations(stored=values if values.ndim == 2 else _of_channels(values, 1.0))


def of_terrarium(data: bytes) -> Elevations:
    """Of a tile of Terrarium (Mapzen): metres = 256 R + G + B / 256 - 32768, in 8-bit PNG."""
    image, white = images.decoded(data, exif=False), images.white(data)
    if image.ndim != 3 or image.shape[2] < 3 or white != 255.0:
        raise ValueError(f"found an image of shape {image.shape}, allowed for Terrarium tiles: 8-bit RGB")
    return Elevations(stored=np.rint(image[..., :3] * white) @ [256.0, 1.0, 1.0 / 256.0] - 32768.0)


def of_hgt(data: bytes, name: str) -> Elevations:
    """Of a tile of SRTM: big-endian metres, 1 or 3 seconds of arc apart; where it lies is in its name, such as N46E007."""
    side = isqrt(len(data) // 2)
    if side not in _HGT_SIDES or 2 * side * side != len(data):
        sizes = " or ".join(f"{2 * n * n:,} ({n} x {n})" for n in _HGT_SIDES)
        raise ValueError(f"found {len(data):,} bytes of HGT tile, {sizes} needed")
    place, apart = _HGT_NAME.match(name), _METRES_PER_DEGREE / (side - 1)
    middle = None if place is None else int(place[1]) + (0.5 if name[0] in "Nn" else -0.5)
    return Elevations(
        stored=np.frombuffer(data, ">i2").reshape(side, side),
        nodata=_HGT_VOID,
        texel_size=None if middle is None else (apart * cos(radians(middle)), apart),
    )


def of_raw(data: bytes, size: tuple[int, int] | None, order: str | None) -> Elevations:
    """Of samples and nothing else: 8 or 16 bits unsigned or 32-bit floats, which the file's length says."""
    if size is None:
        raise ValueError(
            f"found {len(data)} bytes of raw samples and no size, their width and height (--height-size) needed"
        )
    check_size(*size)
    width, height = size
    kind = _RAW_TYPES.get(len(data) // (width * height))
    if kind is None or len(data) % (width * height):
        needed = ", ".join(str(width * height * n) for n in _RAW_TYPES)
        raise ValueError(
            f"found {len(data)} bytes of raw samples, {needed} needed for {width} x {height} of 1, 2 or 4 bytes"
        )
    stored = np.frombuffer(data, np.dtype(kind).newbyteorder(">" if order == "big" else "<")).reshape(height, width)
    return Elevations(stored=stored, white=None if kind == "f4" else float(2 ** (8 * stored.itemsize) - 1))


def of_file(
    data: bytes, path: Path, exif: bool, kind: str | None, size: tuple[int, int] | None, order: str | None
) -> Elevations:
    """Of a file of any kind: by its content, HGT and raw samples by the ending of its name, or as `kind` says."""
    ending = path.suffix.lower()
    if kind == "raw" or (kind is None and ending in RAW_ENDINGS):
        return of_raw(data, size, order)
    if size is not None or order is not None:
        given = "a size" if size is not None else "a byte order"
        raise ValueError(
            f"found {given} for a file that says its own, allowed: for raw samples ({', '.join(RAW_ENDINGS)})"
        )
    if kind == "hgt" or (kind is None and ending == ".hgt"):
        return of_hgt(data, path.name)
    if kind == "terrarium":
        return of_terrarium(data)
    if is_tiff(data):
        return of_tiff(data)
    if is_exr(data) or is_pfm(data):
        return of_values(data)
    if images.is_picture(data):
        return of_picture(data, exif)
    raise ValueError(
        f"found a file that starts with {data[:8]!r}, allowed: a PNG, JPEG, TIFF, EXR or PFM image, .hgt, or raw samples "
        f"({', '.join(RAW_ENDINGS)})"
    )


def _of_channels(image: NDArray[Any], white: float) -> NDArray[Any]:
    """The heights (H, W) of an image (H, W, C) whose white is 1 in its colours and its alpha.

    Grey + alpha: the grey. RGB whose channels are equal, but for 4 / 255 of white: the green one. RGB + alpha: the alpha
    of a normal map with the heights packed into it (Yoo & Han 2006).
    """
    if image.shape[2] == 2:
        return image[..., 0].copy()
    if np.ptp(image[..., :3], axis=2).max() < _GREY_TOLERANCE * white:
        return image[..., 1].copy()
    if image.shape[2] == 4 and image[..., 3].min() < white:
        return image[..., 3].copy()
    raise ValueError(
        "found a colour picture, allowed for heights: grey, RGB with equal channels, or a normal map with the heights in "
        "its alpha"
    )
