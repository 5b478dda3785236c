"""JPEG images, refused where they are cut off: simplejpeg decodes, and takes each warning of libjpeg-turbo for an error.

Pillow, imageio and OpenCV drop those warnings: of a file that was cut in half and closed with an end marker they make a
picture whose lower half is grey. Wrong bits in a file that is whole may still go unnoticed: JPEG has no checksums.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io import jpeg_segments
from ibr_ref.io.jpeg_segments import Segment
from ibr_ref.io.orientation import PREFIX
from ibr_ref.io.sizes import check_size

SIGNATURE = b"\xff\xd8\xff"

_SOS, _JFIF, _EXIF, _ADOBE = 0xDA, 0xE0, 0xE1, 0xEE
_KEPT = {*range(0xC0, 0xE0), _JFIF, _ADOBE}
"""Tables and headers; JFIF and Adobe, which colour space the samples are in. No thumbnails, profiles or comments."""
_MAX_PIXELS_PER_BYTE = 512
"""A Huffman-coded scan spends at least one bit on each block of 8 x 8 pixels."""
_USUAL = "4:4:4, 4:2:2, 4:2:0, 4:4:0 or 4:1:1"
_COLOR_SPACES = {1: "GRAY", 3: "RGB"}


def decode(data: bytes) -> NDArray[np.float64]:
    """Decode a JPEG file, k / 255, to (H, W) grey or (H, W, 3) RGB, in the rows that are stored.

    Raises ValueError for a file that is damaged, cut off, too large, or neither grey nor RGB.
    """
    import simplejpeg  # here, so that importing ibr_ref.io stays cheap

    segments = jpeg_segments.segments(data)
    frame = jpeg_segments.frame(segments)
    check_size(frame.width, frame.height)
    if frame.width * frame.height > _MAX_PIXELS_PER_BYTE * len(data):
        raise ValueError(
            f"found {frame.width} x {frame.height} pixels in {len(data)} bytes of JPEG image, allowed: at most "
            f"{_MAX_PIXELS_PER_BYTE} a byte"
        )
    if len(frame.components) not in _COLOR_SPACES:
        kind = "CMYK" if len(frame.components) == 4 else f"{len(frame.components)} components"
        raise ValueError(f"found a JPEG image in {kind}, allowed: grey or RGB")
    jpeg_segments.check_scans(segments)
    stream = _pixels_only(data, segments)
    try:
        simplejpeg.decode_jpeg_header(stream, strict=False)
    except ValueError:
        raise ValueError(
            f"found a JPEG header with sampling factors or tables that no one uses, allowed: {_USUAL}"
        ) from None
    try:
        image = simplejpeg.decode_jpeg(stream, _COLOR_SPACES[len(frame.components)], strict=True)
    except ValueError:
        raise ValueError("found a truncated or damaged JPEG image, allowed: one whose bits are all there") from None
    pixels: NDArray[np.uint8] = image[..., 0] if image.shape[2] == 1 else image
    return pixels / 255.0


def exif(data: bytes) -> bytes | None:
    """The Exif tags of a file that `decode` accepts."""
    bodies = (segment.body for segment in jpeg_segments.segments(data) if segment.marker == _EXIF)
    return next((body.removeprefix(PREFIX) for body in bodies if body.startswith(PREFIX)), None)


def _pixels_only(data: bytes, segments: list[Segment]) -> bytes:
    """What the pixels are made of, and nothing that the decoder would warn of though it decodes it well."""
    progressive = jpeg_segments.is_progressive(segments)
    parts = [data[:2]]
    for segment, following in pairwise(segments[1:]):
        if segment.marker in _KEPT:
            body = _usual(segment, progressive)
            parts += [bytes((0xFF, segment.marker)), (len(body) + 2).to_bytes(2), body]
        if segment.marker == _SOS:
            parts.append(data[segment.end : following.start])
    return b"".join([*parts, b"\xff\xd9"])


def _usual(segment: Segment, progressive: bool) -> bytes:
    """The body without oddities of real files: a newer JFIF, an unknown Adobe transform, a band where there is none."""
    body = segment.body
    if segment.marker == _JFIF and body[:5] == b"JFIF\0":
        return body[:5] + b"\1" + body[6:]
    if segment.marker == _ADOBE and body[:5] == b"Adobe" and len(body) >= 12 and body[11] > 1:
        return body[:11] + b"\1" + body[12:]
    if segment.marker == _SOS and not progressive:
        return body[:-3] + b"\0\x3f\0"
    return body
