"""One warp of an image from the grid G to the grid G' (section 3.2.1).

For each cell of the grid, row by row, the triangles (r,c), (r,c+1), (r+1,c+1) and (r,c), (r+1,c+1), (r+1,c) are drawn with
corners at G' and texture coordinates G: what is drawn later overwrites. Coverage is that of all triangles here: S G'
snapped to 1/256 texel, exact integer edge functions, top-left rule, both orientations. Attributes come from the same
snapped corners: with l_i = E_i / (E_0 + E_1 + E_2), a texture coordinate is (l_0 a_0 + l_1 a_1) + l_2 a_2. Fetches are
bilinear, with clamp.

Two images that are warped to the same grid and mixed are drawn together: one rasterization, two fetches. Where all that
would be fetched is blank nothing is: the result is the same to the last bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.bands import stride_of
from ibr_ref.pipeline.sampling import footprint, lerp
from ibr_ref.pipeline.triangles import SUBPIXELS, Edges, columns_in_row, edges_in_row, fall_of
from ibr_ref.shadows.spans import live_columns, solid_range

BAND_ROWS = 8
"""Rows of the map that a thread draws at a time."""


SHORT_RUN = 32
"""Columns. A run of no more is fetched whole where its triangle is solid anywhere: sooner than asking which part is."""


class Image(NamedTuple):
    """A square image to fetch from, and its control points."""

    texels: NDArray[np.generic]
    """(S S) flat: bytes, or float64 where `levels` is None."""
    levels: Floats | None
    """(256,) the values of the bytes; None: the texels are the values."""
    spans: NDArray[np.int32]
    """(S, 2) where each row may differ from what is outside of the mesh (`spans.spans`)."""
    grid: Floats
    """(R, C, 2) control points (u, v) in [0, 1]^2."""


class Mesh(NamedTuple):
    """The triangles of a grid in the window of a map."""

    edges: NDArray[np.int64]
    """(T, 12) the edge functions in row 0, as in `Edges`, and by how much they are larger in the next row."""
    box: NDArray[np.int64]
    """(T, 4) first and last row, first and last column that the triangle may cover."""
    solid: NDArray[np.bool_]
    """(T,) whether any of its fetches may read what is not blank."""


class _Source(NamedTuple):
    """An image as the kernel takes it."""

    texels: NDArray[np.generic]
    levels: Floats | None
    spans: NDArray[np.int32]
    corners: Floats
    """(T, 3, 2) texture coordinates of the triangles."""


# --- The mesh --------------------------------------------------------------------------------------------------------


def grid_triangles(grid: Floats) -> Floats:
    """(2 (R-1) (C-1), 3, 2) corners of a grid's triangles, in the order in which they are drawn."""
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    return np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3, 2)


@device
def _may_be_solid(source, size, t):
    """Whether fetches in a triangle may read what is not blank."""
    u, v = source.corners[t, :, 0], source.corners[t, :, 1]
    least, most = solid_range(source.spans, min(v) * size - 0.5, max(v) * size - 0.5)
    return max(u) * size - 0.5 >= least and min(u) * size - 0.5 <= most


@device
def _set_up(window, size, source, other, mesh):
    """Fill the mesh from the corners of its triangles in the window (T, 3, 2), in 1/256 texel."""
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
def _in_rows(box, first_row, last_row, chosen):
    """The triangles that may cover these rows, into `chosen`; gives their number."""
    count = 0
    for t in range(len(box)):
        if box[t, 0] < last_row and box[t, 1] >= first_row:
            chosen[count] = t
            count += 1
    return count


@device
def _edges(edges, t, row):
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


# --- Texture coordinates ---------------------------------------------------------------------------------------------


@device
def _interpolate(edges, t, first, stop, corners, u, v, other_corners, other_u, other_v):
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
def _texel_at(edges, column, scale, corners, t):
    """Where triangle t fetches in a column, in texels; scale: size over area."""
    l0 = np.float64(edges.e0 + edges.step0 * column) * scale
    l1 = np.float64(edges.e1 + edges.step1 * column) * scale
    l2 = np.float64(edges.e2 + edges.step2 * column) * scale
    return (
        l0 * corners[t, 0, 0] + l1 * corners[t, 1, 0] + l2 * corners[t, 2, 0] - 0.5,
        l0 * corners[t, 0, 1] + l1 * corners[t, 1, 1] + l2 * corners[t, 2, 1] - 0.5,
    )


@device
def _live_run(edges, first, stop, size, spans, corners, t):
    """The columns of a run whose fetches may read what is not blank."""
    scale = size / np.float64(edges.e0 + edges.e1 + edges.e2)
    x0, y0 = _texel_at(edges, first, scale, corners, t)
    x1, y1 = _texel_at(edges, stop - 1, scale, corners, t)
    begin, end = live_columns(spans, x0, y0, x1, y1, stop - first)
    return first + begin, first + end


@device
def _joined(a, b, c, d):
    """The least range that holds [a, b) and [c, d), of which either may be empty."""
    if c >= d:
        return a, b
    if a >= b:
        return c, d
    return min(a, c), max(b, d)


@device
def _rasterize(mesh, chosen, source, other, row, uv, other_uv):
    """Texture coordinates of a row of the map, of all chosen triangles in order; NaN where none is or all is blank.

    Gives the columns [begin, end) beside which they are all NaN.
    """
    # Taken apart before the loop: what is taken out of a tuple or an array in it is counted, two atomic operations each.
    edges, box, solid = mesh
    spans, corners = source.spans, source.corners
    other_spans = None if other is None else other.spans
    other_corners = None if other is None else other.corners
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


# --- Texels ----------------------------------------------------------------------------------------------------------


@device
def _texel(texels, levels, i):
    return texels[i] if levels is None else levels[texels[i]]


@device
def _fetch(texels, levels, size, u, v, index, fraction, out):
    """A row of bilinear fetches, in two loops: with the gathers in the first one too, it is not vectorized."""
    for i in range(len(out)):
        i00, i10, i01, i11, fx, fy = footprint(u[i], v[i], size, size, None)
        index[0, i], index[1, i], index[2, i], index[3, i] = i00, i10, i01, i11
        fraction[0, i], fraction[1, i] = fx, fy
    for i in range(len(out)):
        top = lerp(_texel(texels, levels, index[0, i]), _texel(texels, levels, index[1, i]), fraction[0, i])
        bottom = lerp(_texel(texels, levels, index[2, i]), _texel(texels, levels, index[3, i]), fraction[0, i])
        out[i] = lerp(top, bottom, fraction[1, i])


@device
def _fill(source, other, share, size, uv, other_uv, begin, end, index, fraction, spare, outside, out):
    """The texels of columns [begin, end) of a row, from its texture coordinates."""
    u, v = uv[0, begin:end], uv[1, begin:end]
    _fetch(source.texels, source.levels, size, u, v, index, fraction, out)
    if other is not None:
        u2, v2, texels = other_uv[0, begin:end], other_uv[1, begin:end], spare[: end - begin]
        _fetch(other.texels, other.levels, size, u2, v2, index, fraction, texels)
        for i in range(len(out)):
            out[i] = lerp(out[i], texels[i], share)
    for i in range(len(out)):
        out[i] = outside if np.isnan(u[i]) else out[i]


@device
def _trimmed(texels, first, stop, blank):
    """The part of [first, stop) that begins and ends with what is not blank; nothing: (S, 0)."""
    while first < stop and texels[first] == blank:
        first += 1
    while first < stop and texels[stop - 1] == blank:
        stop -= 1
    return (first, stop) if first < stop else (len(texels), 0)


@device
def _draw_band(source, other, share, mesh, outside, first_row, last_row, out, out_spans):
    size = out.shape[1]
    uv, other_uv, spare = np.empty((2, size)), np.empty((2, size)), np.empty(size)
    index, fraction = np.empty((4, size), np.uint32), np.empty((2, size))
    near = np.empty(len(mesh.box), np.int64)
    chosen = near[: _in_rows(mesh.box, first_row, last_row, near)]
    for row in range(first_row, last_row):
        a, b = _rasterize(mesh, chosen, source, other, row, uv, other_uv)
        out[row, : min(a, b)] = outside
        if a < b:
            scratch = index, fraction, spare
            _fill(source, other, share, np.float64(size), uv, other_uv, a, b, *scratch, outside, out[row, a:b])
        out[row, b:] = outside
        out_spans[row, 0], out_spans[row, 1] = _trimmed(out[row], a, b, outside)


@kernel
def _draw(source, other, share, window, outside, out, out_spans):
    """Warp an image to a grid. other: None, or a second image of the same type, of which `share` is mixed in."""
    size, count = len(out), len(window)
    mesh = Mesh(np.empty((count, 12), np.int64), np.empty((count, 4), np.int64), np.empty(count, np.bool_))
    _set_up(window, np.float64(size), source, other, mesh)
    bands = (size + BAND_ROWS - 1) // BAND_ROWS
    stride = stride_of(bands)
    for turn in prange(bands):
        first_row = turn * stride % bands * BAND_ROWS
        last_row = min(size, first_row + BAND_ROWS)
        _draw_band(source, other, share, mesh, outside, first_row, last_row, out, out_spans)


def _source(image: Image | None) -> _Source | None:
    return None if image is None else _Source(image.texels, image.levels, image.spans, grid_triangles(image.grid))


def draw(
    first: Image, second: Image | None, share: float, target: Floats, outside: float, out: Floats
) -> NDArray[np.int32]:
    """Warp an image from its grid to the grid `target`, into out (S, S); `outside`, 0 or 1, where no triangle is.

    second: an image that is warped to the same grid and mixed with the first one: 1 - share of that, share of this.
    Gives the spans of what is drawn.
    """
    drawn = np.empty((len(out), 2), np.int32)
    window = np.rint(grid_triangles(target) * len(out) * SUBPIXELS).astype(np.int64)
    _draw(_source(first), _source(second), share, window, outside, out, drawn)
    return drawn
