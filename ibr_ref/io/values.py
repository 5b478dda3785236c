"""Images of numbers that are no colours: depths, disparities, heights in metres, light."""

from __future__ import annotations

from os import PathLike
from typing import Any

from numpy.typing import NDArray

from ibr_ref.io import exr, pfm, tiff
from ibr_ref.io.files import contents, naming


def read_values(path: str | PathLike[str], channel: str | None = None) -> NDArray[Any]:
    """Read an EXR, PFM or TIFF image, told apart by content: the numbers as they are stored, row 0 on top.

    channel: of an EXR file, such as "Z"; without, R, G and B or the only one.

    Returns (H, W), or (H, W, 3) (TIFF: (H, W, C), C up to 4), in the file's own type: floats of 16, 32 or 64 bits,
    integers of 8 to 64. NaN and infinities stay. EXR and TIFF need the extra `ibr_ref[io]`.

    Raises OSError or ValueError, in one line that starts with the path, for what cannot be read, is not such an image, is
    not all there, has no pixels or more than 2^28, or lacks the channel.
    """
    data = contents(path)
    with naming(path):
        return decoded(data, channel)


def decoded(data: bytes, channel: str | None = None) -> NDArray[Any]:
    """What `read_values` returns of a file's bytes. Raises ValueError without the path."""
    if is_exr(data):
        return exr.decode(data, channel)
    if channel is not None:
        raise ValueError(f"found a file that is no EXR image, {channel!r} is a channel of EXR images, allowed: none")
    if is_pfm(data):
        return pfm.decode(data)
    if is_tiff(data):
        return tiff.decode(data).samples
    raise ValueError(f"found a file that starts with {data[:8]!r}, allowed: an EXR, PFM or TIFF image")


def is_exr(data: bytes) -> bool:
    """Whether a file starts as an OpenEXR image."""
    return data.startswith(exr.SIGNATURE)


def is_pfm(data: bytes) -> bool:
    """Whether a file starts as a PFM image."""
    return data.startswith(pfm.SIGNATURES)


def is_tiff(data: bytes) -> bool:
    """Whether a file starts as a TIFF or BigTIFF image."""
    return data.startswith(tiff.SIGNATURES)
