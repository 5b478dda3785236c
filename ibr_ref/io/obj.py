"""Wavefront OBJ: positions, polygons and vertex colours.

Not left to trimesh, which renumbers the vertices of files with texture coordinates or normals, counts relative indices
back from the end of the file instead of from the line they stand in, and takes corner 0, which does not exist, for 1.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ibr_ref.io.polygons import triangulated
from ibr_ref.io.words import real, shown, whole
from ibr_ref.scene import Mesh

_MAX_CORNER = 2**31
"""Meshes count in 32 bits."""
_LINE = re.compile(rb"\r\n|\n|\r")
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"

_SKIPPED = frozenset(
    b"vt vn vp g o s mg usemtl mtllib usemap maplib bevel c_interp d_interp lod shadow_obj trace_obj ctech stech".split()
)
"""Names, materials, shading, and what free forms alone use."""


class _Polygons(NamedTuple):
    """What the file holds, in its order."""

    vertices: list[list[float]]
    colors: list[list[float]]
    """As many as vertices, or none."""
    corners: list[int]
    counts: list[int]
    """Corners of each polygon."""


def decode(data: bytes) -> Mesh:
    """Read `v x y z [r g b]` and `f`; what names, groups and shades them is skipped.

    Raises ValueError, with the line, for statements that are cut off, garbled or unknown, corners that do not exist, and
    what no triangles can stand for: points, lines, free forms.
    """
    read = _Polygons([], [], [], [])
    for number, words in _statements(data.removeprefix(_BYTE_ORDER_MARK)):
        try:
            if words[0] == b"v":
                _add_vertex(read, words[1:])
            elif words[0] == b"f":
                _add_polygon(read, words[1:])
            elif words[0] not in _SKIPPED:
                raise ValueError("v, f, and what names, groups or shades them")
        except ValueError as error:
            raise ValueError(f"found {shown(words)} in line {number}, allowed: {error}") from None
    if read.colors and len(read.colors) != len(read.vertices):
        raise ValueError(
            f"found {len(read.colors)} vertex colours, allowed: {len(read.vertices)}, one a vertex, or none"
        )
    return _mesh(read)


def _mesh(read: _Polygons) -> Mesh:
    fields: dict[str, Any] = {"color": read.colors} if read.colors else {}
    vertices = np.reshape(np.array(read.vertices, np.float64), (-1, 3))
    triangles = triangulated(vertices, np.array(read.corners, np.int64), np.array(read.counts, np.int64))
    return Mesh(vertices=vertices, triangles=triangles, **fields)


def _statements(data: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Yield line number and words; after a backslash a line goes on in the next, if there is one."""
    before: list[bytes] = []
    lines = _LINE.split(data)
    for number, line in enumerate(lines, 1):
        text = line.split(b"#", 1)[0].rstrip()
        words = before + text.removesuffix(b"\\").split()
        before = words if text.endswith(b"\\") and number < len(lines) else []
        if words and not before:
            yield number, words


def _add_vertex(read: _Polygons, words: list[bytes]) -> None:
    """Three coordinates; a fourth is a weight, which polygons do not use; three more are a colour."""
    try:
        numbers = [real(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) not in (3, 4, 6, 7):
        raise ValueError("v and 3 numbers, or 6 with a colour")
    read.vertices.append(numbers[:3])
    if len(numbers) > 4:
        read.colors.append(numbers[-3:])


def _add_polygon(read: _Polygons, words: list[bytes]) -> None:
    """Corners are `vertex[/texture[/normal]]`, counted from 1, or back from the vertex read last."""
    if len(words) < 3:
        raise ValueError("f and 3 corners or more")
    read.corners.extend(_corner(len(read.vertices), word) for word in words)
    read.counts.append(len(words))


def _corner(count: int, word: bytes) -> int:
    try:
        vertex, *others = word.split(b"/")
        index = whole(vertex)
        if len(others) > 2 or not all(whole(other) for other in others if other):
            index = 0
    except ValueError:
        index = 0
    if index == 0 or not -count <= index <= _MAX_CORNER:
        raise ValueError("whole numbers from 1 up, or back from -1, as corners")
    return index - 1 if index > 0 else count + index
