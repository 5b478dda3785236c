"""Where a grid's triangles are in the window of a map, row by row: the texture coordinates of what is to be fetched.

What kernels take: window (T, 3, 2) corners in the window, in 1/256 texel; corners (T, 3, 2) texture coordinates; box, edges
and solid as in `Mesh`; uv (2, S) the coordinates of a row of the map, u and v (n,) of a run of its columns; other_... the
same of a second image.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices, Ints
from ibr_ref.jit import device
from ibr_ref.pipeline.triangles import SUBPIXELS, Edges, columns_in_row, edges_in_row, fall_of
from ibr_ref.shadows.spans import live_columns, solid_range

SHORT_RUN = 32
"""Columns. A run of no more is fetched whole where its triangle is solid anywhere: sooner than asking which part is."""


class Mesh(NamedTuple):
    """The triangles of a grid in the window of a map."""

    edges: NDArray[np.int64]
    """(T, 12) the edge functions in row 0, as in `Edges`, and by how much they are larger in the next row."""
    box: NDArray[np.int64]
    """(T, 4) first and last row, first and last column that the triangle may cover."""
    solid: NDArray[np.bool_]
    """(T,) whether any of its fetches may read what is not blank."""


class Source(NamedTuple):
    """An image as the kernel takes it: texels, levels and spans as in `Image`."""

    texels: NDArray[np.generic]
    levels: Floats | None
    spans: NDArray[np.int32]
    corners: Floats
    """(T, 3, 2) texture coordinates of the triangles."""


@device
def _may_be_solid(source: Source, size: float, t: int) -> bool:
    """Whether fetches in a triangle may read what is not blank."""
    u, v = source.corners[t, :, 0], source.corners[t, :, 1]
    least, most = solid_range(source.spans, min(v) * size - 0.5, max(v) * size - 0.5)
    return max(u) * size - 0.5 >= least and min(u) * size - 0.5 <= most


@device
def set_up(window: Ints, size: float, source: Source, other: Source | None, mesh: Mesh) -> None:
    """Fill the mesh from the corners of its triangles."""
    edges, box, solid = mesh
    for t in range(len(window)):
        x, y = window[t, :, 0], window[t, :, 1]
        here, fall = edges_in_row(x, y, 0), fall_of(x, y)
        for k in range(9):
            edges[t, k] = here[k]
        for k in range(3):
            edges[t, 9 + k] = fall[k]
        box[t, 0], box[t, 1] = min(y) // SUBPIXELS, max(y) // SUBPIXELS
        box[t, 2], box[t, 3] = min(x) // SUBPIXELS, max(x) // SUBPIXELS
        solid[t] = _may_be_solid(source, size, t)
        if other is not None:
            solid[t] |= _may_be_solid(other, size, t)


@device
def in_rows(box: Ints, first_row: int, last_row: int, chosen: Ints) -> int:
    """The triangles that may cover these rows, into `chosen`; gives their number."""
    count = 0
    for t in range(len(box)):
        if box[t, 0] < last_row and box[t, 1] >= first_row:
            chosen[count] = t
            count += 1
    return count


@device
def _edges(edges: Ints, t: int, row: int) -> Edges:
    """Triangle t's edge functions in a row."""
    return Edges(
        edges[t, 0] + row * edges[t, 9],
        edges[t, 1] + row * edges[t, 10],
        edges[t, 2] + row * edges[t, 11],
        edges[t, 3],
        edges[t, 4],
        edges[t, 5],
        edges[t, 6],
        edges[t, 7],
        edges[t, 8],
    )


@device
def _interpolate(
    edges: Edges,
    t: int,
    first: int,
    stop: int,
    corners: Floats,
    u: Floats,
    v: Floats,
    other_corners: Floats | None,
    other_u: Floats,
    other_v: Floats,
) -> None:
    """Texture coordinates of triangle t's columns [first, stop), in one image or in two.

    The edge functions as floats are exact: integers below 2^53.
    """
    total = np.float64(edges.e0 + edges.e1 + edges.e2)
    e0, step0 = np.float64(edges.e0), np.float64(edges.step0)
    e1, step1 = np.float64(edges.e1), np.float64(edges.step1)
    e2, step2 = np.float64(edges.e2), np.float64(edges.step2)
    u0, u1, u2 = corners[t, 0, 0], corners[t, 1, 0], corners[t, 2, 0]
    v0, v1, v2 = corners[t, 0, 1], corners[t, 1, 1], corners[t, 2, 1]
    if other_corners is not None:
        a0, a1, a2 = other_corners[t, 0, 0], other_corners[t, 1, 0], other_corners[t, 2, 0]
        b0, b1, b2 = other_corners[t, 0, 1], other_corners[t, 1, 1], other_corners[t, 2, 1]
    for i in range(np.uintp(first), np.uintp(stop)):
        column = np.float64(np.int32(i))
        l0 = (e0 + step0 * column) / total
        l1 = (e1 + step1 * column) / total
        l2 = (e2 + step2 * column) / total
        u[i] = l0 * u0 + l1 * u1 + l2 * u2
        v[i] = l0 * v0 + l1 * v1 + l2 * v2
        if other_corners is not None:
            other_u[i] = l0 * a0 + l1 * a1 + l2 * a2
            other_v[i] = l0 * b0 + l1 * b1 + l2 * b2


@device
def _texel_at(edges: Edges, column: int, scale: float, corners: Floats, t: int) -> tuple[float, float]:
    """Where triangle t fetches in a column, in texels; scale: size over area."""
    l0 = np.float64(edges.e0 + edges.step0 * column) * scale
    l1 = np.float64(edges.e1 + edges.step1 * column) * scale
    l2 = np.float64(edges.e2 + edges.step2 * column) * scale
    return (
        l0 * corners[t, 0, 0] + l1 * corners[t, 1, 0] + l2 * corners[t, 2, 0] - 0.5,
        l0 * corners[t, 0, 1] + l1 * corners[t, 1, 1] + l2 * corners[t, 2, 1] - 0.5,
    )


@device
def _live_run(
    edges: Edges, first: int, stop: int, size: float, spans: Indices, corners: Floats, t: int
) -> tuple[int, int]:
    """The columns of a run whose fetches may read what is not blank."""
    scale = size / np.float64(edges.e0 + edges.e1 + edges.e2)
    x0, y0 = _texel_at(edges, first, scale, corners, t)
    x1, y1 = _texel_at(edges, stop - 1, scale, corners, t)
    begin, end = live_columns(spans, x0, y0, x1, y1, stop - first)
    return first + begin, first + end


@device
def _joined(a: int, b: int, c: int, d: int) -> tuple[int, int]:
    """The least range that holds [a, b) and [c, d), of which either may be empty."""
    if c >= d:
        return a, b
    if a >= b:
        return c, d
    return min(a, c), max(b, d)


@device
def rasterize(
    mesh: Mesh, chosen: Ints, source: Source, other: Source | None, row: int, uv: Floats, other_uv: Floats
) -> tuple[int, int]:
    """Texture coordinates of a row of the map, of all chosen triangles in order; NaN where none is or all is blank.

    Gives the columns [begin, end) beside which they are all NaN.
    """
    # Taken apart before the loop: what is taken out of a tuple or an array in it is counted, two atomic operations each.
    edges, box, solid = mesh
    spans, corners = source.spans, source.corners
    other_spans: Any = None if other is None else other.spans  # read where there is another alone
    other_corners: Any = None if other is None else other.corners
    u, v, other_u, other_v = uv[0], uv[1], other_uv[0], other_uv[1]
    width = len(u)
    begin, end = width, 0
    u[:] = np.nan
    for n in range(len(chosen)):
        t = chosen[n]
        if row < box[t, 0] or row > box[t, 1] or not (solid[t] or (box[t, 3] >= begin and box[t, 2] < end)):
            continue
        here = _edges(edges, t, row)
        if here.e0 + here.e1 + here.e2 == 0:  # a triangle without an area covers nothing
            continue
        first, stop = columns_in_row(here, width)
        if first == stop:
            continue
        a, b = first, stop if solid[t] else first
        if b - a > SHORT_RUN:
            a, b = _live_run(here, first, stop, np.float64(width), spans, corners, t)
            if other is not None:
                c, d = _live_run(here, first, stop, np.float64(width), other_spans, other_corners, t)
                a, b = _joined(a, b, c, d)
        if first < end and stop > begin:
            for i in range(np.uintp(first), np.uintp(stop)):
                u[i] = np.nan
        if a < b:
            _interpolate(here, t, a, b, corners, u, v, other_corners, other_u, other_v)
            begin, end = min(begin, a), max(end, b)
    return begin, end
