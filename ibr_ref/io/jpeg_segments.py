"""The segments of a JPEG file (ISO/IEC 10918-1, annex B), and whether all scans are there that its frame needs.

A decoder is content with the scans that it finds: of a progressive image of which some are missing it makes a blurred or
grey one, and says nothing.
"""

from __future__ import annotations

import re
from typing import NamedTuple

_SOI, _EOI, _SOS, _TEM = 0xD8, 0xD9, 0xDA, 0x01
_RESTARTS = range(0xD0, 0xD8)
_FRAMES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
"""Markers of frame headers: C4, C8 and CC have other meanings."""
_HUFFMAN = {0xC0, 0xC1, 0xC2}
"""Baseline, extended sequential, progressive."""
_PROGRESSIVE = 0xC2
_COEFFICIENTS = 64
_AFTER_SCAN = re.compile(rb"\xff[\x01-\xcf\xd8-\xfe]")
"""Ends the bits of a scan: a marker that is neither a stuffed byte nor a restart."""


class Segment(NamedTuple):
    """A marker and what belongs to it."""

    marker: int
    body: bytes
    """Without the two bytes of its length."""
    start: int
    """Of its first byte in the file."""
    end: int


class Frame(NamedTuple):
    """A frame header."""

    bits: int
    height: int
    width: int
    components: bytes
    """Their identifiers."""


def truncated() -> ValueError:
    """The error for a file that is not all there."""
    return ValueError("found a truncated JPEG image, allowed: one with all of its scans, up to its end marker")


def segments(data: bytes) -> list[Segment]:
    """All segments from the first to the end marker; what follows it, such as further pictures, is not looked at.

    Raises ValueError for a file that is cut off, or has something else where a marker should be.
    """
    found, place = [Segment(_SOI, b"", 0, 2)], 2
    while found[-1].marker != _EOI:
        start = place
        while data[place : place + 2] == b"\xff\xff":  # fill bytes
            place += 1
        if place + 2 > len(data):
            raise truncated()
        marker = data[place + 1]
        if data[place] != 0xFF or marker in (0x00, _SOI, *_RESTARTS):
            raise ValueError(f"found a damaged JPEG image (no marker at byte {start}), allowed: whole segments")
        end, body = place + 2, b""
        if marker not in (_EOI, _TEM):
            end += int.from_bytes(data[end : end + 2])
            body = data[place + 4 : end]
            if end > len(data) or end < place + 4:
                raise truncated()
        found.append(Segment(marker, body, start, end))
        place = _end_of_bits(data, end) if marker == _SOS else end
    return found


def _end_of_bits(data: bytes, start: int) -> int:
    """Where the segment after a scan begins."""
    found = _AFTER_SCAN.search(data, start)
    if found is None:
        raise truncated()
    end = found.start()
    while data[end - 1] == 0xFF and end > start:  # fill bytes are part of what follows
        end -= 1
    return end


def frame(found: list[Segment]) -> Frame:
    """The header of the one frame. Raises ValueError for none or several, and for coding that cannot be checked."""
    frames = [segment for segment in found if segment.marker in _FRAMES]
    if len(frames) != 1:
        raise ValueError(f"found {len(frames)} JPEG frame headers, allowed: one")
    marker, body = frames[0].marker, frames[0].body
    if marker not in _HUFFMAN:
        # Of arithmetic coding, zeros at the end may be left out: whether bits are missing cannot be known.
        raise ValueError(f"found JPEG coding of type {marker - 0xC0}, allowed: 0, 1 or 2, Huffman-coded and lossy")
    if len(body) < 6 or len(body) != 6 + 3 * body[5]:
        raise ValueError(f"found a JPEG frame header of {len(body)} bytes, allowed: 6, and 3 a component")
    header = Frame(body[0], int.from_bytes(body[1:3]), int.from_bytes(body[3:5]), body[6::3])
    if header.bits != 8:
        raise ValueError(f"found {header.bits} bits a sample of JPEG, allowed: 8")
    return header


def is_progressive(found: list[Segment]) -> bool:
    """Whether scans bring some of the coefficients, or some of their bits."""
    return any(segment.marker == _PROGRESSIVE for segment in found)


def check_scans(found: list[Segment]) -> None:
    """Raise ValueError unless the scans bring every coefficient of every component, down to its last bit."""
    progressive = is_progressive(found)
    missing = {component: set(range(_COEFFICIENTS)) for component in frame(found).components}
    for scan in (segment.body for segment in found if segment.marker == _SOS):
        count = scan[0] if scan else 0
        if len(scan) != 4 + 2 * count:
            raise ValueError(f"found a JPEG scan header of {len(scan)} bytes, allowed: 4, and 2 a component")
        first, last, approximation = scan[-3:] if progressive else (0, _COEFFICIENTS - 1, 0)
        for component in scan[1:-3:2]:
            if component in missing and approximation & 15 == 0:
                missing[component] -= set(range(first, last + 1))
    if any(missing.values()):
        raise truncated()
