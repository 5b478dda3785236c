"""PNG images, to the last bit, and only whole ones.

Pillow decodes, with two things added. It drops the low byte of every 16-bit sample that is not plain grey (imageio asks
Pillow, and does the same; pypng keeps it, but unfilters in Python, and its last release is of 2022). And where the
compressed pixels end too soon, it returns what it has got and black below, without a look at the checksums. Nor does it
write colours of 16 bits.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.sizes import check_size

SIGNATURE = b"\x89PNG\r\n\x1a\n"

_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
"""Samples per pixel in the file by colour type: grey, RGB, palette, grey + alpha, RGB + alpha."""
_BITS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
"""The bit depths that the standard allows for each colour type."""
_ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))
"""The interlaced passes: first column, first row, column step, row step."""
_UP = 2
"""The filter that takes the sample above from each."""
_SLICE = 1 << 14
"""Compressed bytes that are inflated at once: deflate makes at most 1032 times as many of them, 16 MiB."""


class _Header(NamedTuple):
    width: int
    height: int
    bits: int
    color_type: int
    compression: int
    filters: int
    interlace: int


def decode(data: bytes) -> NDArray[np.float64]:
    """Decode a PNG file, k / (2^bits - 1), to (H, W), or (H, W, C): C = 2 grey + alpha, 3 RGB, 4 RGB + alpha.

    The rows are those that are stored.

    Palettes are expanded. A colour key (tRNS without a palette) is not an alpha channel: the stored colours stay.
    Raises ValueError or one of Pillow's errors for a file that is damaged, cut off or too large.
    """
    header = _header(data)
    check_size(header.width, header.height)
    chunks = [(kind, body) for kind, body in _chunks(data) if _makes_pixels(kind, header)]
    kinds = [kind for kind, _ in chunks]
    if kinds.count(b"IHDR") != 1 or kinds.count(b"PLTE") < (header.color_type == 3):
        raise ValueError(f"found the PNG chunks {sorted(set(kinds))}, allowed: one header, and a palette if it says so")
    _check_stream(b"".join(body for kind, body in chunks if kind == b"IDAT"), _stream_size(header))
    return _samples(_joined(chunks), header)


def encode_16(samples: NDArray[np.uint16]) -> bytes:
    """A PNG file of (H, W) grey or (H, W, 3) RGB samples, each row as its difference from the one above."""
    height, width = samples.shape[:2]
    rows = np.ascontiguousarray(samples, ">u2").reshape(height, -1).view(np.uint8)
    filtered = np.full((height, 1 + rows.shape[1]), _UP, np.uint8)
    filtered[:, 1:] = np.diff(rows, axis=0, prepend=np.zeros_like(rows[:1]))
    header = struct.pack(">IIBBBBB", width, height, 16, 2 if samples.ndim == 3 else 0, 0, 0, 0)
    return _joined([(b"IHDR", header), (b"IDAT", zlib.compress(filtered.tobytes())), (b"IEND", b"")])


def bits(data: bytes) -> int:
    """Of the samples of a file that `decode` accepts; of a palette's colours 8."""
    header = _header(data)
    return 8 if header.color_type == 3 else header.bits


def exif(data: bytes) -> bytes | None:
    """The Exif tags of a file that `decode` accepts."""
    return next((body for kind, body in _chunks(data) if kind == b"eXIf"), None)


def _header(data: bytes) -> _Header:
    if len(data) < 33 or data[12:16] != b"IHDR":
        raise ValueError(f"found {len(data)} bytes that start as a PNG image, allowed: its header of 33 bytes first")
    header = _Header(*struct.unpack(">IIBBBBB", data[16:29]))
    if header.bits not in _BITS.get(header.color_type, ()) or header.interlace > 1 or header[4:6] != (0, 0):
        raise ValueError(f"found a PNG header {tuple(header)}, allowed: the combinations of the PNG standard")
    return header


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Type and body of each chunk up to the last, whole and with the checksum that it came with."""
    start, kind = len(SIGNATURE), b""
    while kind != b"IEND":
        length = int.from_bytes(data[start : start + 4])
        end = start + 12 + length
        if end > len(data):
            raise ValueError(
                f"found a truncated PNG image of {len(data)} bytes, allowed: at least {max(end, start + 12)}"
            )
        kind, body = data[start + 4 : start + 8], data[start + 8 : end - 4]
        if zlib.crc32(kind + body) != int.from_bytes(data[end - 4 : end]):
            raise ValueError(f"found a damaged PNG image (chunk {kind!r} at byte {start}), allowed: right checksums")
        yield kind, body
        start = end


def _makes_pixels(kind: bytes, header: _Header) -> bool:
    """Say what Pillow is given to read: no texts that inflate, no Exif, no colour profiles, no animation."""
    return kind in (b"IHDR", b"PLTE", b"IDAT", b"IEND") or (kind == b"tRNS" and header.color_type == 3)


def _joined(chunks: list[tuple[bytes, bytes]]) -> bytes:
    parts = [SIGNATURE]
    for kind, body in chunks:
        parts += [len(body).to_bytes(4), kind, body, zlib.crc32(kind + body).to_bytes(4)]
    return b"".join(parts)


def _stream_size(header: _Header) -> int:
    """Bytes that the header promises: each row of each pass is a filter byte and its packed samples."""
    bits = header.bits * _CHANNELS[header.color_type]
    size = 0
    for x, y, step_x, step_y in _ADAM7 if header.interlace else ((0, 0, 1, 1),):
        columns, rows = (header.width - x + step_x - 1) // step_x, (header.height - y + step_y - 1) // step_y
        size += rows * (1 + (columns * bits + 7) // 8) if columns > 0 else 0
    return size


def _check_stream(compressed: bytes, needed: int) -> None:
    """Inflate without keeping, so that no header makes us allocate an image that is not there.

    The stream must come to its end, and its checksum be right; what goes on beyond the pixels is not looked at.
    """
    inflate, view, size = zlib.decompressobj(), memoryview(compressed), 0
    try:
        for start in range(0, len(view), _SLICE):
            size += len(inflate.decompress(view[start : start + _SLICE]))
            if size > needed or (size == needed and inflate.eof):
                return
    except zlib.error:
        raise ValueError("found a damaged PNG image, allowed: compressed pixels with a right checksum") from None
    if size < needed:
        raise ValueError(f"found {size} bytes of PNG pixels, {needed} needed for the size in its header")
    raise ValueError("found a truncated PNG image, allowed: one whose compressed pixels come to their end")


def _samples(data: bytes, header: _Header) -> NDArray[np.float64]:
    from PIL.PngImagePlugin import PngImageFile  # here, so that importing ibr_ref.io stays cheap

    # The plugin's class, not Image.open: its limit on sizes is a warning, and lower than ours.
    image = PngImageFile(BytesIO(data))
    if header.bits == 16:
        return _samples_16(data, image, header) / 65535.0
    if header.color_type == 3:
        return np.asarray(image.convert("RGBA" if "transparency" in image.info else "RGB")) / 255.0
    if header.color_type == 0:
        return np.asarray(image.convert("L")) / 255.0  # 1, 2 and 4 bits: k 255 / (2^bits - 1)
    return np.asarray(image) / 255.0


def _samples_16(data: bytes, image: object, header: _Header) -> NDArray[np.uint16]:
    """Return the samples as they are in the file.

    Pillow keeps the high byte of each; told that the same bytes are little-endian, it keeps the low one. Grey + alpha
    takes the four bytes of a pixel for four channels.
    """
    if header.color_type == 0:
        return np.asarray(image).astype(np.uint16)
    if header.color_type == 4:
        return _unpacked(data, "RGBA").view(">u2").astype(np.uint16)
    mode = "RGB" if header.color_type == 2 else "RGBA"
    high, low = _unpacked(data, f"{mode};16B"), _unpacked(data, f"{mode};16L")
    return np.stack((high, low), axis=-1).view(">u2")[..., 0].astype(np.uint16)


def _unpacked(data: bytes, raw_mode: str) -> NDArray[np.uint8]:
    from PIL.PngImagePlugin import PngImageFile

    image = PngImageFile(BytesIO(data))
    image.tile = [tile._replace(args=raw_mode) for tile in image.tile]
    return np.array(image)
