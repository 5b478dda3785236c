"""STL, text and binary: three vertices a triangle. Normals and attributes are not read.

Not left to trimesh or numpy-stl, which read a text as far as it goes: after a lost vertex all triangles are scrambled.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.words import real, shown
from ibr_ref.scene import Mesh

_HEADER = 84
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
_LINE = re.compile(rb"\r\n|\n|\r")

_FACET = (
    (b"facet", b"normal", 3),
    (b"outer", b"loop", 0),
    (b"vertex", None, 3),
    (b"vertex", None, 3),
    (b"vertex", None, 3),
    (b"endloop", None, 0),
    (b"endfacet", None, 0),
)
"""The lines of a triangle: their words, and how many numbers follow."""


def decode(data: bytes) -> Mesh:
    """Read either kind: binary where the size is that of the triangles in the header, whatever this begins with.

    Raises ValueError for what is neither, and for a text whose lines are not those of whole triangles, with the line.
    """
    count = struct.unpack_from("<I", data, _HEADER - 4)[0] if len(data) >= _HEADER else 0
    needed = _HEADER + _TRIANGLE.itemsize * count
    if len(data) >= _HEADER and len(data) == needed:
        vertices = np.frombuffer(data, _TRIANGLE, offset=_HEADER)["corners"].reshape(-1, 3).astype(np.float64)
    elif data.split(maxsplit=1)[:1] and data.split(maxsplit=1)[0].lower() == b"solid":
        vertices = _from_text(data)
    else:
        raise ValueError(
            f"found {len(data)} bytes, allowed: a text from `solid` to `endsolid`, or binary STL: "
            f"{needed} bytes for the {count} triangles in its header"
        )
    return Mesh(vertices=vertices, triangles=np.arange(len(vertices)).reshape(-1, 3))


def _from_text(data: bytes) -> NDArray[np.float64]:
    """(3 T, 3) the vertices of one solid or more."""
    lines = _lines(data)
    vertices: list[list[float]] = []
    inside = False
    for number, words in lines:
        first = words[0].lower()
        if inside and first == b"facet":
            vertices.extend(_facet(number, words, lines))
        elif first != (b"endsolid" if inside else b"solid"):
            allowed = "facet normal or endsolid" if inside else "solid"
            raise ValueError(f"found {shown(words)} in line {number}, allowed: {allowed}")
        else:
            inside = not inside
    if inside:
        raise ValueError("found the end of the file, allowed: facet normal or endsolid")
    return np.reshape(np.array(vertices, np.float64), (-1, 3))


def _lines(data: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Yield number and words of the lines that are not blank."""
    for number, line in enumerate(_LINE.split(data), 1):
        if words := line.split():
            yield number, words


def _facet(number: int, words: list[bytes], lines: Iterator[tuple[int, list[bytes]]]) -> Iterator[list[float]]:
    """Yield three vertices. The normal's numbers are not looked at: exporters write what they like there."""
    for place, (first, second, amount) in enumerate(_FACET):
        if place:
            number, words = next(lines, (0, []))
        names = [first] if second is None else [first, second]
        allowed = f"{b' '.join(names).decode()} and {amount} numbers" if amount else b" ".join(names).decode()
        if not words:
            raise ValueError(f"found the end of the file, allowed: {allowed}")
        try:
            if [word.lower() for word in words[: len(names)]] != names or len(words) != len(names) + amount:
                raise ValueError
            if first == b"vertex":
                yield [real(word) for word in words[1:]]
        except ValueError:
            raise ValueError(f"found {shown(words)} in line {number}, allowed: {allowed}") from None
