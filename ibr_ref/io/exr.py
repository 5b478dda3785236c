"""OpenEXR images: the values of one channel, or of R, G and B, as they are; OpenEXR's own library reads and writes.

It says what it dislikes on the process's standard error and output, past Python, and makes an image of no parts of what it
cannot read: it is silenced, and asked for the header first.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from io import BytesIO, StringIO
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.io.extras import needed
from ibr_ref.io.sizes import check_size
from ibr_ref.scene.checks import one_line

SIGNATURE = b"\x76\x2f\x31\x01"

_FILES = "EXR files"
_COLOR = ("R", "G", "B")
_NO_VALUES = ("A", *_COLOR)
"""Channels beside R, G and B that may be left out: how much is covered."""
_MOST_CHANNELS = 64
_MOST_BYTES_PER_BYTE = 2**16
"""What a byte of the file may stand for: a map that is one value all over, in blocks of 256 rows, is far below."""
_BYTES = 4


def check_installed() -> None:
    """Raise ValueError where OpenEXR is not installed."""
    needed("OpenEXR", _FILES)


def decode(data: bytes, channel: str | None = None) -> NDArray[Any]:
    """The values of an EXR file, row 0 on top, as float16, float32 or uint32: (H, W), or (H, W, 3) RGB, linear.

    channel: the one to read, such as "Z" or "ViewLayer.Depth.Z". Without: R, G and B, alpha left out, or the only one.

    Raises ValueError for a file that is damaged, cut off, too large, of several parts or deep; where pixels are missing
    (a data window that is not the display's) or subsampled; and for other channels than these.
    """
    library = needed("OpenEXR", _FILES)
    part = _part(library, data, header_only=True)
    size, names = _size(part), _names(part)
    check_size(*size)
    if size[0] * size[1] * _BYTES * len(names) > _MOST_BYTES_PER_BYTE * len(data):
        raise ValueError(
            f"found {size[0]} x {size[1]} pixels of {len(names)} channels in {len(data)} bytes of EXR image, allowed: at "
            f"most {_MOST_BYTES_PER_BYTE} bytes of them a byte"
        )
    wanted = _wanted(names, channel)
    channels = _part(library, data, header_only=False).channels
    planes = [channels[name].pixels for name in wanted]
    if any(plane.shape != size[::-1] for plane in planes):
        raise ValueError(f"found EXR channels of {planes[0].shape}, {size[::-1]} needed")
    return np.ascontiguousarray(planes[0]) if len(planes) == 1 else np.stack(planes, axis=2)


def encode(image: ArrayLike) -> bytes:
    """An EXR file of 32-bit floats, ZIP-compressed: channel Y of (H, W), R, G and B of (H, W, 3). Row 0 is on top."""
    library = needed("OpenEXR", _FILES)
    values = np.ascontiguousarray(image, np.float32)
    header = {"compression": library.ZIP_COMPRESSION, "type": library.scanlineimage}
    stream = BytesIO()
    library.File(header, {"RGB" if values.ndim == 3 else "Y": values}).write(stream)
    return stream.getvalue()


def _part(library: Any, data: bytes, header_only: bool) -> Any:
    """The only part of a file."""
    try:
        with _silenced():
            parts = library.File(BytesIO(data), separate_channels=True, header_only=header_only).parts
    except (RuntimeError, ValueError, TypeError):  # what it makes of damaged files
        parts = []
    if not parts:
        raise ValueError(f"found a truncated or damaged EXR image of {len(data)} bytes, allowed: a whole one")
    if len(parts) > 1:
        raise ValueError(f"found an EXR image of {len(parts)} parts, allowed: one")
    if parts[0].header.get("type") not in (library.scanlineimage, library.tiledimage):
        raise ValueError("found a deep EXR image, allowed: scan lines or tiles, one value a pixel")
    return parts[0]


def _size(part: Any) -> tuple[int, int]:
    """Width and height."""
    (first, last), shown = part.header["dataWindow"], part.header["displayWindow"]
    if not (np.array_equal(first, shown[0]) and np.array_equal(last, shown[1])):
        windows = [np.asarray(window).tolist() for window in ((first, last), shown)]
        raise ValueError(f"found an EXR image with pixels in {windows[0]} of {windows[1]}, all needed")
    return int(last[0]) - int(first[0]) + 1, int(last[1]) - int(first[1]) + 1


def _names(part: Any) -> list[str]:
    """Of all channels."""
    channels = part.header["channels"]
    if not 1 <= len(channels) <= _MOST_CHANNELS:
        raise ValueError(f"found {len(channels)} EXR channels, allowed: 1 to {_MOST_CHANNELS}")
    if any((channel.xSampling, channel.ySampling) != (1, 1) for channel in channels):
        raise ValueError("found an EXR image with subsampled channels, allowed: one sample a pixel")
    try:
        return [channel.name for channel in channels]
    except UnicodeDecodeError:
        raise ValueError("found an EXR channel whose name is no UTF-8, allowed: text") from None


def _wanted(names: list[str], channel: str | None) -> list[str]:
    """Names of the channels that are read."""
    shown = one_line(", ".join(sorted(names)))
    if channel is not None:
        if channel not in names:
            raise ValueError(f"found the EXR channels {shown}, {one_line(channel)} needed")
        return [channel]
    if set(_COLOR) <= set(names) <= set(_NO_VALUES):
        return list(_COLOR)
    if len(names) != 1:
        raise ValueError(
            f"found the EXR channels {shown}, allowed: R, G, B (and A), or one, or its name beside the path"
        )
    return names


@contextmanager
def _silenced() -> Iterator[None]:
    """Standard output and error, Python's and the process's, lead nowhere meanwhile."""
    kept = {}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            for descriptor in (1, 2):
                with suppress(OSError):  # closed: nothing is said there
                    kept[descriptor] = os.dup(descriptor)
                    os.dup2(nowhere, descriptor)
            yield
    finally:
        for descriptor, before in kept.items():
            os.dup2(before, descriptor)
            os.close(before)
        os.close(nowhere)
