"""Quadtree displacement mapping (Drobot 2009) on a maximum mipmap (Tevs et al. 2008): first intersections, few fetches.

Level 0 holds, for each cell between four texel centres, the largest of the four heights; each further level halves the
resolution. The ray starts in the coarsest cell. Above a cell's maximum it goes down to that height, or past the cell, and a
level up there; at or below, a level down. In a cell of level 0 it meets the bilinear patch itself, as in Tevs et al., by the
quadratic of `exact`; Drobot's point-sampled leaves show texels as blocks. A read of the quadtree counts as a fetch, and the
four texels of a patch as one (a gather).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement.below import keep, view_ray
from ibr_ref.displacement.exact import clip_unit, next_line, upward_crossing
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import fetch

_MOST_FETCHES = 1 << 24  # a repeated, nearly empty plane seen at a grazing angle is given up there


class Quadtree(NamedTuple):
    """All levels, one after the other, the finest first."""

    values: NDArray[np.float64]
    """Flat."""
    offsets: NDArray[np.int64]
    """(L,) start of each level in `values`."""
    columns: NDArray[np.int64]
    """(L,) cells in a row of each level; the last level is one cell."""
    rows: NDArray[np.int64]
    """(L,)."""


def build(heights: NDArray[np.float64], repeat: bool) -> Quadtree:
    """The quadtree of a height map (H, W): H + 1 by W + 1 cells, the outer ones in half texels; of a repeated one H by W."""
    widths = [(0, 1), (0, 1)] if repeat else [(1, 1), (1, 1)]
    texels = np.pad(heights, widths, mode="wrap" if repeat else "edge")
    corners = texels[:-1, :-1], texels[:-1, 1:], texels[1:, :-1], texels[1:, 1:]
    levels = [np.maximum.reduce(corners)]
    while levels[-1].size > 1:
        fine = levels[-1]
        fine = np.pad(fine, [(0, fine.shape[0] % 2), (0, fine.shape[1] % 2)], constant_values=0.0)
        levels.append(fine.reshape(fine.shape[0] // 2, 2, fine.shape[1] // 2, 2).max(axis=(1, 3)))
    sizes = np.array([level.size for level in levels])
    return Quadtree(
        np.concatenate([level.reshape(-1) for level in levels]),
        np.cumsum(sizes) - sizes,
        np.array([level.shape[1] for level in levels]),
        np.array([level.shape[0] for level in levels]),
    )


@device
def _node(cell, size, level):
    """The first cell of the node around a cell, the one after its last, the node's own index; cells repeat after `size`."""
    period = cell // size * size
    index = (cell - period) >> level
    return period + (index << level), period + min((index + 1) << level, size), index


@device
def _below(repeat, texels, columns, rows, u, v, along_u, along_v, d):
    """d - D at depth d: positive inside the solid."""
    return d - (1.0 - fetch(texels, columns, rows, repeat, u - along_u * d, v - along_v * d))


@device
def _patch_hit(repeat, texels, columns, rows, u, v, along_u, along_v, first, last):
    """Depth at which the ray meets the bilinear patch between two depths; 2 if it does not."""
    start = _below(repeat, texels, columns, rows, u, v, along_u, along_v, first)
    if start > 0.0:
        return first
    half = _below(repeat, texels, columns, rows, u, v, along_u, along_v, 0.5 * (first + last))
    end = _below(repeat, texels, columns, rows, u, v, along_u, along_v, last)
    curvature = 2.0 * (end - 2.0 * half + start)
    s = upward_crossing(start, end - start - curvature, curvature, end)
    return first + s * (last - first) if s <= 1.0 else 2.0


@device
def _stays(x, first, stop):
    """The cell of x, inside a node."""
    return min(max(np.int64(np.floor(x)), first), stop - 1)


@device
def _descend(repeat, texels, columns, rows, tree, u, v, along_u, along_v, last):
    """Depth of the first intersection before depth `last`, 2 if there is none; and how many fetches that took."""
    shift = 0.5 if repeat is None else -0.5  # the outer cells of a map that ends are counted too
    x, y, dx, dy = u * columns + shift, v * rows + shift, -along_u * columns, -along_v * rows
    across, down, top = tree.columns[0], tree.rows[0], len(tree.offsets) - 1
    column, row = np.int64(np.floor(x)), np.int64(np.floor(y))
    if repeat is None:
        column, row = _stays(x, 0, across), _stays(y, 0, down)
    level, d, fetches = top, 0.0, 0
    while fetches < _MOST_FETCHES:
        left, right, node_column = _node(column, across, level)
        above, under, node_row = _node(row, down, level)
        highest = tree.values[tree.offsets[level] + node_row * tree.columns[level] + node_column]
        fetches += 1
        out_x = next_line(x, dx, 1.0 * left) if dx < 0.0 else next_line(x, dx, right - 1.0)
        out_y = next_line(y, dy, 1.0 * above) if dy < 0.0 else next_line(y, dy, under - 1.0)
        out = max(d, min(out_x, out_y, last))
        leaves = 1.0 - highest >= out
        if not leaves and level > 0:
            if 1.0 - highest > d:
                d = 1.0 - highest
                column, row = _stays(x + dx * d, left, right), _stays(y + dy * d, above, under)
            level -= 1
            continue
        if not leaves:
            fetches += 1
            hit = _patch_hit(repeat, texels, columns, rows, u, v, along_u, along_v, d, out)
            if hit <= 1.0:
                return hit, fetches
        if not out < last:
            return 2.0, fetches
        d = out
        next_column, next_row = _stays(x + dx * d, left, right), _stays(y + dy * d, above, under)
        if out_x <= out:
            next_column = right if dx > 0.0 else left - 1
        if out_y <= out:
            next_row = under if dy > 0.0 else above - 1
        column, row, level = next_column, next_row, min(level + 1, top)
    return 2.0, fetches


@device
def _trace(repeat, points, pixel, eye, texels, columns, rows, tree, found, fetches):
    u, v, along_u, along_v, seen = view_ray(points, pixel, eye)
    if not seen:
        return
    last = 1.0
    if repeat is None:
        _, last = clip_unit(u, -along_u, 0.0, 1.0)
        _, last = clip_unit(v, -along_v, 0.0, last)
    d, fetches[pixel] = _descend(repeat, texels, columns, rows, tree, u, v, along_u, along_v, last)
    if d <= 1.0 or last == 1.0:
        d = min(d, 1.0)
        keep(found, pixel, 0, u - along_u * d, v - along_v * d, d, False)


@kernel
def maximum_mipmap_search(repeat, points, eye, texels, columns, rows, tree, found, fetches):
    """Hits of all pixels."""
    for pixel in prange(len(fetches)):
        _trace(repeat, points, pixel, eye, texels, columns, rows, tree, found, fetches)


def search(s: Sought) -> None:
    """Hits of a polygon."""
    tree = s.prepared(("quadtree",), lambda: build(s.heights, s.repeat is not None))
    maximum_mipmap_search(s.repeat, s.points, s.constants.eye, *s.height, tree, *s.found)
