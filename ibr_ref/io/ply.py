"""PLY, text and binary of both byte orders: vertices, polygons or triangle strips, vertex colours.

Not left to trimesh, which refuses binary files with polygons of several sizes and makes fans of concave ones; plyfile is
under the GPL, and reads binary numbers one by one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.ply_header import Element, decode_header
from ibr_ref.io.ply_rows import Lists, Table, binary_tables, text_tables
from ibr_ref.io.polygons import check_corners, strip, triangulated
from ibr_ref.scene import Mesh, checks

_COLORS = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"))
_WHITE = {"u1": 255.0, "u2": 65535.0, "f4": 1.0, "f8": 1.0}
"""The largest number of a colour, for the types that colours have."""
_CORNERS = ("vertex_indices", "vertex_index")


def decode(data: bytes) -> Mesh:
    """Read `vertex`, `face` and `tristrips`; other elements, `edge` among them, are checked and left out.

    Numbers have the types that the header says. Raises ValueError for a header that is none, data that are fewer or more
    than it says, types that colours and corners cannot have, polygons of two corners or less.
    """
    header, body = decode_header(data)
    tables = (text_tables if header.text else binary_tables)(header, body)
    if "vertex" not in tables:
        raise ValueError("found no element vertex, allowed: a mesh with vertices x, y, z")
    vertices = _columns(header.element("vertex"), tables["vertex"], ("x", "y", "z"))
    colors = _colors(header.element("vertex"), tables["vertex"])
    triangles = [np.empty((0, 3), np.int64)]
    if "face" in tables:
        triangles.append(_faces(vertices, _corners(header.element("face"), tables["face"])))
    if "tristrips" in tables:
        triangles.append(_strips(_corners(header.element("tristrips"), tables["tristrips"]), len(vertices)))
    fields: dict[str, Any] = {} if colors is None else {"color": colors}
    return Mesh(vertices=vertices, triangles=np.concatenate(triangles), **fields)


def _columns(element: Element, table: Table, names: tuple[str, ...]) -> NDArray[np.float64]:
    """(count, len(names)) float64."""
    for name in names:
        if name not in table or isinstance(table[name], Lists):
            raise ValueError(f"found no number {name} in element {element.name}, allowed: {', '.join(names)}")
    return np.stack([np.asarray(table[name], np.float64) for name in names], axis=1)


def _colors(element: Element, table: Table) -> NDArray[np.float64] | None:
    """(V, 3) in [0, 1], or None where there are none."""
    for names in _COLORS:
        if any(name in table for name in names):
            columns = _columns(element, table, names)
            types = [element.property(name).type for name in names]
            if len(set(types)) > 1 or types[0] not in _WHITE:
                raise checks.reject("the type of red, green, blue", " ".join(types), " | ".join(_WHITE))
            return columns / _WHITE[types[0]]
    return None


def _corners(element: Element, table: Table) -> Lists:
    """The one list of corners."""
    lists = [table[name] for name in _CORNERS if name in table]
    if len(lists) != 1 or not isinstance(lists[0], Lists) or lists[0].items.dtype.kind not in "iu":
        raise ValueError(f"found no one list of whole numbers in element {element.name}, allowed: {_CORNERS[0]}")
    return lists[0]


def _faces(vertices: NDArray[np.float64], corners: Lists) -> NDArray[np.int64]:
    few = np.flatnonzero(corners.counts < 3)
    if len(few):
        raise ValueError(f"found {corners.counts[few[0]]} corners in face {few[0] + 1}, allowed: 3 or more")
    return triangulated(vertices, corners.items.astype(np.int64), corners.counts)


def _strips(corners: Lists, count: int) -> NDArray[np.int64]:
    """-1 ends a strip, as do the ends of the lists."""
    parts: list[NDArray[np.int64]] = [np.empty((0, 3), np.int64)]
    for row in np.split(corners.items.astype(np.int64), np.cumsum(corners.counts)[:-1]):
        ends = np.flatnonzero(row == -1)
        for begin, end in zip([0, *(ends + 1)], [*ends, len(row)], strict=True):
            check_corners(row[begin:end], count)
            if end - begin in (1, 2):
                raise ValueError(f"found a strip of {end - begin} corners, allowed: 3 or more")
            parts.append(strip(row[begin:end]))
    return np.concatenate(parts)
