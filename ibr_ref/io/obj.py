"""Wavefront OBJ: positions, polygons and vertex colours.

Not left to trimesh, which renumbers the vertices of files with texture coordinates or normals, counts relative indices
back from the end of the file instead of from the line they stand in, and takes corner 0, which does not exist, for 1.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

Triangle = tuple[int, int, int]

_MAX_CORNER = 2**31
"""Meshes count in 32 bits."""


class Polygons(NamedTuple):
    """Vertices and triangles in the order of the file."""

    vertices: list[list[float]]
    triangles: list[Triangle]
    colors: list[list[float]]
    """As many as vertices, or none."""


def decode(data: bytes) -> Polygons:
    """Read `v x y z [r g b]` and `f`, polygons fanned from their first corner; all other statements are skipped.

    Raises ValueError, with the line, for a statement that is cut off or garbled, and for corners that do not exist.
    """
    mesh = Polygons([], [], [])
    for number, words in _statements(data):
        try:
            if words[0] == "v":
                _add_vertex(mesh, words[1:])
            elif words[0] == "f":
                _add_polygon(mesh, words[1:])
        except ValueError as error:
            raise ValueError(f"found {' '.join(words)[:60]!r} in line {number}, allowed: {error}") from None
    if mesh.colors and len(mesh.colors) != len(mesh.vertices):
        raise ValueError(
            f"found {len(mesh.colors)} vertex colours, allowed: {len(mesh.vertices)}, one a vertex, or none"
        )
    return mesh


def _statements(data: bytes) -> Iterator[tuple[int, list[str]]]:
    """Yield line number and words; after a backslash a line goes on in the next. Any encoding will do for names."""
    before: list[str] = []
    for number, line in enumerate(data.decode("latin-1").split("\n"), 1):
        text = line.split("#", 1)[0].rstrip()
        words = before + text.removesuffix("\\").split()
        before = words if text.endswith("\\") else []
        if words and not before:
            yield number, words


def _add_vertex(mesh: Polygons, words: list[str]) -> None:
    """Three coordinates; a fourth is a weight, which polygons do not use; three more are a colour."""
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) not in (3, 4, 6, 7):
        raise ValueError("v and 3 numbers, or 6 with a colour")
    mesh.vertices.append(numbers[:3])
    if len(numbers) > 4:
        mesh.colors.append(numbers[-3:])


def _add_polygon(mesh: Polygons, words: list[str]) -> None:
    """Corners are `vertex[/texture[/normal]]`, counted from 1, or back from the vertex read last."""
    if len(words) < 3:
        raise ValueError("f and 3 corners or more")
    corners = [_corner(mesh, word.split("/", 1)[0]) for word in words]
    mesh.triangles.extend((corners[0], *pair) for pair in pairwise(corners[1:]))


def _corner(mesh: Polygons, word: str) -> int:
    try:
        index = int(word)
    except ValueError:
        index = 0
    if index == 0 or not -len(mesh.vertices) <= index <= _MAX_CORNER:
        raise ValueError("whole numbers from 1 up, or back from -1, as corners")
    return index - 1 if index > 0 else len(mesh.vertices) + index
