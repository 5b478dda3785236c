"""Images as the maps of a base polygon: heights, colours, normals. Every error names the file.

exif: turn the image as its Exif tag Orientation says (`read_image`); normals stay the vectors that they are.
"""

from __future__ import annotations

from os import PathLike

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.images import read_image
from ibr_ref.scene.checks import named

_GREY_TOLERANCE = 4.5 / 255.0
"""Channels that differ by less are one grey, as lossy compression leaves it."""


def read_height(path: str | PathLike[str], exif: bool = True) -> NDArray[np.float64]:
    """Read a height map (H, W) in [0, 1].

    Grey: as it is. RGB whose channels are equal, but for 4 / 255: the green one. RGB + alpha: the alpha of a normal map
    with the heights packed into it (Yoo & Han 2006); but where the colours are grey, hence no normals, again the green
    one, and alpha is left out. Raises ValueError for a colour picture, and the errors of `read_image`.
    """
    image = read_image(path, exif)
    if image.ndim == 2:
        return image
    if image.shape[2] == 2:
        return image[..., 0].copy()
    if np.ptp(image[..., :3], axis=2).max() < _GREY_TOLERANCE:
        return image[..., 1].copy()
    if image.shape[2] == 4 and image[..., 3].min() < 1.0:
        return image[..., 3].copy()
    raise ValueError(
        f"{named(path)}: found a colour picture, allowed for heights: grey, RGB with equal channels, or a normal map with "
        "the heights in its alpha"
    )


def read_color(path: str | PathLike[str], exif: bool = True) -> NDArray[np.float64]:
    """Read a colour or facade map (H, W, 3): grey is repeated, alpha dropped. Raises the errors of `read_image`."""
    image = read_image(path, exif)
    if image.ndim == 2 or image.shape[2] == 2:
        return np.repeat(image.reshape(*image.shape[:2], -1)[..., :1], 3, axis=2)
    return image[..., :3].copy()


def read_normal(path: str | PathLike[str], exif: bool = True) -> NDArray[np.float64]:
    """Read a normal map (H, W, 3) in [0, 1], normal = 2 c - 1; an alpha channel is dropped.

    Raises ValueError for a grey image, and the errors of `read_image`.
    """
    image = read_image(path, exif)
    if image.ndim == 2 or image.shape[2] == 2:
        raise ValueError(f"{named(path)}: found a grey image, allowed for normals: RGB, or RGB + alpha")
    return image[..., :3].copy()


def read_normal_height(path: str | PathLike[str], exif: bool = True) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Read the packed texture of Yoo & Han 2006: the normal map (H, W, 3) from RGB, the height map (H, W) from alpha.

    Raises ValueError for an image without four channels, and the errors of `read_image`.
    """
    image = read_image(path, exif)
    if image.ndim != 3 or image.shape[2] != 4:
        channels = 1 if image.ndim == 2 else image.shape[2]
        raise ValueError(f"{named(path)}: found {channels} channels, allowed for normals with heights: 4, RGB + alpha")
    return image[..., :3].copy(), image[..., 3].copy()
