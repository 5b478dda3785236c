"""One warp of an image from the grid G to the grid G' (section 3.2.1).

For each cell of the grid, row by row, the triangles (r,c), (r,c+1), (r+1,c+1) and (r,c), (r+1,c+1), (r+1,c) are drawn with
corners at G' and texture coordinates G: what is drawn later overwrites. Coverage is that of all triangles here: S G'
snapped to 1/256 texel, exact integer edge functions, top-left rule, both orientations. Attributes come from the same
snapped corners: with l_i = E_i / (E_0 + E_1 + E_2), a texture coordinate is (l_0 a_0 + l_1 a_1) + l_2 a_2. Fetches are
bilinear, with clamp.

Two images that are warped to the same grid and mixed are drawn together: one rasterization, two fetches. Where all that
would be fetched is blank nothing is: the result is the same to the last bit.

What kernels take: texels and levels as in `Image`; window (T, 3, 2), uv (2, S), u and v (n,) as in `rasterize`; index (4, n)
and fraction (2, n) of footprints, spare (S,) room; out (S, S) the map and out_spans (S, 2) its spans, of a row texels (n,).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices, Ints
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.bands import stride_of
from ibr_ref.pipeline.sampling import footprint, lerp
from ibr_ref.pipeline.triangles import SUBPIXELS
from ibr_ref.shadows.rasterize import Mesh, Source, in_rows, rasterize, set_up

BAND_ROWS = 8
"""Rows of the map that a thread draws at a time."""


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


def grid_triangles(grid: Floats) -> Floats:
    """(2 (R-1) (C-1), 3, 2) corners of a grid's triangles, in the order in which they are drawn."""
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    return np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3, 2)


@device
def _texel(texels: NDArray[np.generic], levels: Floats | None, i: int) -> float:
    return texels[i] if levels is None else levels[texels[i]]


@device
def _fetch(
    texels: NDArray[np.generic],
    levels: Floats | None,
    size: float,
    u: Floats,
    v: Floats,
    index: NDArray[np.uint32],
    fraction: Floats,
    out: Floats,
) -> None:
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
def _fill(
    source: Source,
    other: Source | None,
    share: float,
    size: float,
    uv: Floats,
    other_uv: Floats,
    begin: int,
    end: int,
    index: NDArray[np.uint32],
    fraction: Floats,
    spare: Floats,
    outside: float,
    out: Floats,
) -> None:
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
def _trimmed(texels: Floats, first: int, stop: int, blank: float) -> tuple[int, int]:
    """The part of [first, stop) that begins and ends with what is not blank; nothing: (S, 0)."""
    while first < stop and texels[first] == blank:
        first += 1
    while first < stop and texels[stop - 1] == blank:
        stop -= 1
    return (first, stop) if first < stop else (len(texels), 0)


@device
def _draw_band(
    source: Source,
    other: Source | None,
    share: float,
    mesh: Mesh,
    outside: float,
    first_row: int,
    last_row: int,
    out: Floats,
    out_spans: Indices,
) -> None:
    size = out.shape[1]
    uv, other_uv, spare = np.empty((2, size)), np.empty((2, size)), np.empty(size)
    index, fraction = np.empty((4, size), np.uint32), np.empty((2, size))
    near = np.empty(len(mesh.box), np.int64)
    chosen = near[: in_rows(mesh.box, first_row, last_row, near)]
    for row in range(first_row, last_row):
        a, b = rasterize(mesh, chosen, source, other, row, uv, other_uv)
        out[row, : min(a, b)] = outside
        if a < b:
            scratch = index, fraction, spare
            _fill(source, other, share, np.float64(size), uv, other_uv, a, b, *scratch, outside, out[row, a:b])
        out[row, b:] = outside
        out_spans[row, 0], out_spans[row, 1] = _trimmed(out[row], a, b, outside)


@kernel
def _draw(
    source: Source, other: Source | None, share: float, window: Ints, outside: float, out: Floats, out_spans: Indices
) -> None:
    """Warp an image to a grid. other: None, or a second image of the same type, of which `share` is mixed in."""
    size, count = len(out), len(window)
    mesh = Mesh(np.empty((count, 12), np.int64), np.empty((count, 4), np.int64), np.empty(count, np.bool_))
    set_up(window, np.float64(size), source, other, mesh)
    bands = (size + BAND_ROWS - 1) // BAND_ROWS
    stride = stride_of(bands)
    for turn in prange(bands):
        first_row = turn * stride % bands * BAND_ROWS
        last_row = min(size, first_row + BAND_ROWS)
        _draw_band(source, other, share, mesh, outside, first_row, last_row, out, out_spans)


def _source(image: Image) -> Source:
    return Source(image.texels, image.levels, image.spans, grid_triangles(image.grid))


def draw(
    first: Image, second: Image | None, share: float, target: Floats, outside: float, out: Floats
) -> NDArray[np.int32]:
    """Warp an image from its grid to the grid `target`, into out (S, S); `outside`, 0 or 1, where no triangle is.

    second: an image that is warped to the same grid and mixed with the first one: 1 - share of that, share of this.
    Gives the spans of what is drawn.
    """
    drawn = np.empty((len(out), 2), np.int32)
    window = np.rint(grid_triangles(target) * len(out) * SUBPIXELS).astype(np.int64)
    other = None if second is None else _source(second)
    _draw(_source(first), other, share, window, outside, out, drawn)
    return drawn
