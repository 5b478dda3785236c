"""Stage warp: the map for a place of the object, between the nine prepared ones (sections 3.2.1 and 3.2.2).

One warp of an image from the grid G to the grid G' draws, for each cell of the grid row by row, the triangles
(r,c), (r,c+1), (r+1,c+1) and (r,c), (r+1,c+1), (r+1,c) with corners at G' and texture coordinates G: what is drawn
later overwrites. Coverage is that of all triangles here: S G' snapped to 1/256 texel, exact integer edge functions,
top-left rule, both orientations. Attributes come from the same snapped corners: with l_i = E_i / (E_0 + E_1 + E_2), a
texture coordinate is (l_0 a_0 + l_1 a_1) + l_2 a_2. Fetches are bilinear, with clamp.

Two images that are warped to the same grid and mixed are drawn together: one rasterization, two fetches.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline import memory
from ibr_ref.pipeline.sampling import footprint, lerp
from ibr_ref.pipeline.triangles import SUBPIXELS, columns_in_row, edges_in_row

Array = NDArray[np.float64]

BAND_ROWS = 8
"""Rows of the map that a thread draws at a time."""


class Image(NamedTuple):
    """A square image to fetch from, and its control points."""

    texels: NDArray[np.generic]
    """(S S) flat: bytes, or float64 where `levels` is None."""
    levels: Array | None
    """(256,) the values of the bytes; None: the texels are the values."""
    grid: Array
    """(R, C, 2) control points (u, v) in [0, 1]^2."""


class Mesh(NamedTuple):
    """Where a grid's triangles are in the window of a map."""

    x: NDArray[np.int64]
    """(T, 3) in 1/256 texel."""
    y: NDArray[np.int64]
    """(T, 3)."""
    rows: NDArray[np.int64]
    """(T, 2) first and last row that the triangle may cover."""


class Warped(NamedTuple):
    """The arrays of the stage, for one place of the object."""

    cell: NDArray[np.int32]
    """(2,) cell of the 3 x 3 positions, x first."""
    fraction: Array
    """(2,) s and t, the place within the cell."""
    row_grids: Array
    """(2, R, C, 2) lerp(G00, G10, s) and lerp(G01, G11, s)."""
    rows: Array
    """(2, S, S) top and bottom."""
    grid: Array
    """(R, C, 2) lerp of the row grids by t."""
    image: Array
    """(S, S)."""


# --- One warp --------------------------------------------------------------------------------------------------------


def grid_triangles(grid: Array) -> Array:
    """(2 (R-1) (C-1), 3, 2) corners of a grid's triangles, in the order in which they are drawn."""
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    return np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3, 2)


@device
def _interpolate(edges, first, corners, u, v):
    """Texture coordinates of the columns from `first`, for a triangle with those of `corners` (3, 2).

    The edge functions as floats are exact: integers below 2^53.
    """
    total = np.float64(edges.e0 + edges.e1 + edges.e2)
    e0, step0 = np.float64(edges.e0 + edges.step0 * first), np.float64(edges.step0)
    e1, step1 = np.float64(edges.e1 + edges.step1 * first), np.float64(edges.step1)
    e2, step2 = np.float64(edges.e2 + edges.step2 * first), np.float64(edges.step2)
    u0, u1, u2 = corners[0, 0], corners[1, 0], corners[2, 0]
    v0, v1, v2 = corners[0, 1], corners[1, 1], corners[2, 1]
    for i in range(len(u)):
        column = np.float64(np.int32(i))
        l0 = (e0 + step0 * column) / total
        l1 = (e1 + step1 * column) / total
        l2 = (e2 + step2 * column) / total
        u[i] = l0 * u0 + l1 * u1 + l2 * u2
        v[i] = l0 * v0 + l1 * v1 + l2 * v2


@device
def _rasterize(mesh, corners, other_corners, row, uv, other_uv):
    """Texture coordinates of a row of the map: of all triangles, in order; NaN where none is."""
    uv[:] = np.nan
    for t in range(len(mesh.rows)):
        if mesh.rows[t, 0] <= row <= mesh.rows[t, 1]:
            edges = edges_in_row(mesh.x[t], mesh.y[t], row)
            if edges.e0 + edges.e1 + edges.e2 != 0:  # a triangle without an area covers nothing
                first, stop = columns_in_row(edges, uv.shape[1])
                _interpolate(edges, first, corners[t], uv[0, first:stop], uv[1, first:stop])
                if other_corners is not None:
                    other = other_corners[t]
                    _interpolate(edges, first, other, other_uv[0, first:stop], other_uv[1, first:stop])


@device
def _texel(texels, levels, i):
    return texels[i] if levels is None else levels[texels[i]]


@device
def _fetch(texels, levels, uv, index, fraction, out):
    """A row of bilinear fetches, in two loops: with the gathers in the first one too, it is not vectorized."""
    size = np.float64(len(out))
    for i in range(len(out)):
        i00, i10, i01, i11, fx, fy = footprint(uv[0, i], uv[1, i], size, size, None)
        index[0, i], index[1, i], index[2, i], index[3, i] = i00, i10, i01, i11
        fraction[0, i], fraction[1, i] = fx, fy
    for i in range(len(out)):
        top = lerp(_texel(texels, levels, index[0, i]), _texel(texels, levels, index[1, i]), fraction[0, i])
        bottom = lerp(_texel(texels, levels, index[2, i]), _texel(texels, levels, index[3, i]), fraction[0, i])
        out[i] = lerp(top, bottom, fraction[1, i])


@device
def _draw_band(texels, levels, corners, other, other_corners, share, mesh, outside, first_row, last_row, out):
    size = out.shape[1]
    uv, other_uv, spare = np.empty((2, size)), np.empty((2, size)), np.empty(size)
    index, fraction = np.empty((4, size), np.uint32), np.empty((2, size))
    for row in range(first_row, last_row):
        _rasterize(mesh, corners, other_corners, row, uv, other_uv)
        _fetch(texels, levels, uv, index, fraction, out[row])
        if other is not None:
            _fetch(other, levels, other_uv, index, fraction, spare)
            for i in range(size):
                out[row, i] = lerp(out[row, i], spare[i], share)
        for i in range(size):
            out[row, i] = outside if np.isnan(uv[0, i]) else out[row, i]


@kernel
def _draw(texels, levels, corners, other, other_corners, share, mesh, outside, out):
    """Warp an image to a mesh. other: None, or a second image of the same type, of which `share` is mixed in."""
    size = len(out)
    for band in prange((size + BAND_ROWS - 1) // BAND_ROWS):
        first_row = band * BAND_ROWS
        last_row = min(size, first_row + BAND_ROWS)
        _draw_band(texels, levels, corners, other, other_corners, share, mesh, outside, first_row, last_row, out)


def _mesh(target: Array, size: int) -> Mesh:
    """The triangles of a grid in the window of an S x S map, snapped."""
    window = np.rint(grid_triangles(target) * size * SUBPIXELS).astype(np.int64)
    x, y = np.ascontiguousarray(window[..., 0]), np.ascontiguousarray(window[..., 1])
    return Mesh(x, y, np.stack([y.min(axis=1), y.max(axis=1)], axis=1) // SUBPIXELS)


def warp(image: Image, target: Array, outside: float, out: Array) -> None:
    """Warp an image from its grid to the grid `target`, into out (S, S); `outside` where no triangle is."""
    mesh = _mesh(target, len(out))
    _draw(image.texels, image.levels, grid_triangles(image.grid), None, None, 0.0, mesh, outside, out)


def warp_and_mix(first: Image, second: Image, share: float, target: Array, outside: float, out: Array) -> None:
    """Warp two images to the grid `target` and mix them: 1 - share of the first, share of the second."""
    mesh = _mesh(target, len(out))
    corners, other = grid_triangles(first.grid), grid_triangles(second.grid)
    _draw(first.texels, first.levels, corners, second.texels, other, share, mesh, outside, out)


# --- The stage -------------------------------------------------------------------------------------------------------


def locate(positions: Array, offset: Array) -> tuple[NDArray[np.int32], Array]:
    """The cell (2,) of the positions (3, 3, 2) that holds an offset, and the fractions in it; the upper cell on a line."""
    axes = positions[0, :, 0], positions[:, 0, 1]
    cell = np.array([int(o >= axis[1]) for axis, o in zip(axes, offset, strict=True)], np.int32)
    fraction = [(o - axis[i]) / (axis[i + 1] - axis[i]) for axis, o, i in zip(axes, offset, cell, strict=True)]
    return cell, np.array(fraction)


def between(first: Array, second: Array, share: float) -> Array:
    """Two grids' lerp."""
    return first * (1.0 - share) + second * share


def grids_at(controls: Array, cell: NDArray[np.int32], fraction: Array) -> tuple[Array, Array]:
    """The row grids (2, R, C, 2) and the grid (R, C, 2) of a place, from the controls (3, 3, R, C, 2)."""
    (i, j), (s, t) = cell.tolist(), fraction.tolist()
    rows = np.stack([between(controls[j + k, i], controls[j + k, i + 1], s) for k in range(2)])
    return rows, between(rows[0], rows[1], t)


def warp_stage(
    texels: NDArray[np.generic],
    levels: Array | None,
    controls: Array,
    cell: NDArray[np.int32],
    fraction: Array,
    nearest: bool,
    outside: float,
) -> Warped:
    """The map for a place within a cell, from texels (3, 3, S, S).

    nearest: each of the three warps takes the nearer image alone (section 3.2.2 speaks of three warps, as in bilinear
    interpolation); otherwise each mixes two, warped to one grid: six warps.
    """
    size = texels.shape[2]
    (i, j), (s, t) = cell.tolist(), fraction.tolist()
    row_grids, grid = grids_at(controls, cell, fraction)
    rows, image = memory.arrays([(np.float64, (2, size, size)), (np.float64, (size, size))])
    for k in range(2):
        pair = [Image(texels[j + k, i + n].reshape(-1), levels, controls[j + k, i + n]) for n in range(2)]
        _warp_pair(pair, s, row_grids[k], nearest, outside, rows[k])
    pair = [Image(rows[k].reshape(-1), None, row_grids[k]) for k in range(2)]
    _warp_pair(pair, t, grid, nearest, outside, image)
    return Warped(cell, fraction, row_grids, rows, grid, image)


def _warp_pair(pair: list[Image], share: float, target: Array, nearest: bool, outside: float, out: Array) -> None:
    if nearest:
        warp(pair[0] if share < 0.5 else pair[1], target, outside, out)
    else:
        warp_and_mix(pair[0], pair[1], share, target, outside, out)
