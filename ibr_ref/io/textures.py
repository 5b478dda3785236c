"""Images as the maps of a base polygon: colours and normals (heights: `heights`). Every error names the file.

PNG, JPEG, EXR, PFM or TIFF, told apart by content: integers are k / (2^bits - 1), floats linear as they are, in [0, 1].
exif: turn the image as its Exif tag Orientation says (`read_image`); normals stay the vectors that they are.
"""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import images, tiff
from ibr_ref.io.files import contents, naming
from ibr_ref.io.values import decoded, is_exr, is_pfm, is_tiff
from ibr_ref.scene.checks import named


def read_color(path: str | PathLike[str], exif: bool = True) -> NDArray[np.float64]:
    """Read a colour or facade map (H, W, 3): grey is repeated, alpha dropped.

    Raises the errors of `read_image` and `read_values`, and ValueError for floats outside [0, 1].
    """
    image = _image(path, exif)
    if image.ndim == 2 or image.shape[2] == 2:
        return np.repeat(image.reshape(*image.shape[:2], -1)[..., :1], 3, axis=2)
    return image[..., :3].copy()


def read_normal(path: str | PathLike[str], exif: bool = True) -> NDArray[np.float64]:
    """Read a normal map (H, W, 3) in [0, 1], normal = 2 c - 1; an alpha channel is dropped.

    Raises ValueError for a grey image, and the errors of `read_image` and `read_values`.
    """
    image = _image(path, exif)
    if image.ndim == 2 or image.shape[2] == 2:
        raise ValueError(f"{named(path)}: found a grey image, allowed for normals: RGB, or RGB + alpha")
    return image[..., :3].copy()


def read_normal_height(path: str | PathLike[str], exif: bool = True) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Read the packed texture of Yoo & Han 2006: the normal map (H, W, 3) from RGB, the height map (H, W) from alpha.

    Raises ValueError for an image without four channels, and the errors of `read_image` and `read_values`.
    """
    image = _image(path, exif)
    if image.ndim != 3 or image.shape[2] != 4:
        channels = 1 if image.ndim == 2 else image.shape[2]
        raise ValueError(f"{named(path)}: found {channels} channels, allowed for normals with heights: 4, RGB + alpha")
    return image[..., :3].copy(), image[..., 3].copy()


def _image(path: str | PathLike[str], exif: bool) -> NDArray[np.float64]:
    """An image (H, W) or (H, W, C) in [0, 1] of any of the formats."""
    data = contents(path)
    with naming(path):
        if is_exr(data) or is_pfm(data):
            return _unit(decoded(data))
        if is_tiff(data):
            image = tiff.decode(data)
            return _unit(image.samples) if image.white is None else image.samples / float(image.white)
        if images.is_picture(data):
            return images.decoded(data, exif)
    raise ValueError(
        f"{named(path)}: found a file that starts with {data[:8]!r}, allowed: a PNG, JPEG, TIFF, EXR or PFM image"
    )


def _unit(values: NDArray[Any]) -> NDArray[np.float64]:
    """Values that must be in [0, 1]."""
    outside = ~((values >= 0) & (values <= 1))
    if outside.any():
        first = np.argwhere(outside)[0]
        raise ValueError(
            f"found {int(np.count_nonzero(outside))} of {values.size} values outside [0, 1], the first "
            f"{values[tuple(first)]:g} at {first.tolist()}, allowed for colours and normals: linear ones in [0, 1]"
        )
    return values.astype(np.float64)
