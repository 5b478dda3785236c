"""Quadtree displacement mapping (Drobot 2009) on a maximum mipmap (Tevs et al. 2008): first intersections, few fetches.

The ray starts in the coarsest cell of the quadtree. Above a cell's maximum it goes down to that height, or past the cell,
and a level up there; at or below, a level down. In a cell of level 0 it meets the bilinear patch itself, as in Tevs et al.,
by the quadratic of `exact`; Drobot's point-sampled leaves show texels as blocks. A read of the quadtree counts as a fetch,
and the four texels of a patch as one (a gather).

Rays step in waves, each lane in its own cell. Their lengths differ, so that a lane whose ray has ended takes the next one:
else half of them would wait. Cells are counted in floats, which hold them exactly: integers have no SIMD division.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Floats, Indices, Lanes, Texels, Wrap
from ibr_ref.displacement.below import keep, view_ray
from ibr_ref.displacement.buffers import Hits
from ibr_ref.displacement.exact import clip_unit, upward_crossing
from ibr_ref.displacement.quadtree import Quadtree, build
from ibr_ref.displacement.sought import Sought
from ibr_ref.jit import LANES, device, inlined, kernel, prange
from ibr_ref.pipeline.sampling import clamped, fetch
from ibr_ref.pipeline.waves import gather, index_lanes, lanes, largest, smallest

_MOST_FETCHES = 1 << 24  # a repeated, nearly empty plane seen at a grazing angle is given up there
_BLOCK = 64 * LANES
"""Points that a thread takes at a time."""


class Levels(NamedTuple):
    """The quadtree as kernels read it: its numbers as floats, which name its places exactly."""

    values: Floats
    """All levels, one after the other."""
    offsets: Floats
    """(L,) start of each level in `values`."""
    columns: Floats
    """(L,) nodes in a row of each level."""
    across: float
    """Cells of level 0 along u, after which they repeat."""
    down: float
    """Along v."""


class Rays(NamedTuple):
    """The view rays of a wave's lanes (`below`)."""

    u: Lanes
    v: Lanes
    along_u: Lanes
    along_v: Lanes


class Walks(NamedTuple):
    """A wave's rays on their way; at depth d they are at (x + d dx, y + d dy), in cells of level 0."""

    x: Lanes
    y: Lanes
    dx: Lanes
    dy: Lanes
    last: Lanes
    """Depth at which the map ends, or the volume."""
    depth: Lanes
    """Reached so far."""
    column: Lanes
    """The cell of level 0 there."""
    row: Lanes
    level: Lanes
    size: Lanes
    """Cells of level 0 along a side of a node of that level: 2^level."""
    hit: Lanes
    """Depth of the intersection: -1 not known yet, 2 there is none."""
    fetches: Lanes


class Nodes(NamedTuple):
    """The nodes that a wave's rays are in: from the first cell to the one after the last."""

    left: Lanes
    right: Lanes
    above: Lanes
    under: Lanes
    surface: Lanes
    """Depth of the highest there."""
    out_x: Lanes
    """Depths at which the rays leave their nodes along u and along v, and either, by the end of the map at the latest."""
    out_y: Lanes
    out: Lanes
    meets: Lanes
    """1 where the ray is to be met with a bilinear patch, else 0."""


@device
def _below(repeat: Wrap, texels: Texels, columns: float, rows: float, u: float, v: float, d: float) -> float:
    """d - D at depth d: positive inside the solid."""
    return d - (1.0 - fetch(texels, columns, rows, repeat, u, v))


@device
def _patch_hit(
    repeat: Wrap, texels: Texels, columns: float, rows: float,
    u: float, v: float, along_u: float, along_v: float, first: float, last: float,
) -> float:  # fmt: skip
    """Depth at which the ray meets the bilinear patch between two depths; 2 if it does not."""
    start = _below(repeat, texels, columns, rows, u - along_u * first, v - along_v * first, first)
    if start > 0.0:
        return first
    middle = 0.5 * (first + last)
    half = _below(repeat, texels, columns, rows, u - along_u * middle, v - along_v * middle, middle)
    end = _below(repeat, texels, columns, rows, u - along_u * last, v - along_v * last, last)
    curvature = 2.0 * (end - 2.0 * half + start)
    s = upward_crossing(start, end - start - curvature, curvature, end)
    return first + s * (last - first) if s <= 1.0 else 2.0


@device
def _node(repeat: Wrap, cell: float, size: float, whole: float) -> tuple[float, float, float]:
    """The first cell of the node around a cell, the one after its last, the node's index; cells repeat after `whole`."""
    period = 0.0 if repeat is None else np.floor(cell / whole) * whole
    index = np.floor((cell - period) / size)
    return period + index * size, period + min((index + 1.0) * size, whole), index


@device
def _leaves_at(x: float, dx: float, first: float, stop: float) -> float:
    """Depth at which x + d dx leaves the cells [first, stop)."""
    ahead = (first if dx < 0.0 else stop) - x
    return ahead / dx if dx != 0.0 else np.inf


@device
def _stays(x: float, first: float, stop: float) -> float:
    """The cell of x, inside a node."""
    return clamped(np.floor(x), first, stop - 1.0)


@inlined
def _read(repeat: Wrap, levels: Levels, walks: Walks, nodes: Nodes) -> None:
    """The wave's nodes, and how high the surface is there at most."""
    index, offset, columns, place = index_lanes(), lanes(), lanes(), index_lanes()
    for lane in range(LANES):
        index[lane] = np.int32(walks.level[lane])
    gather(levels.offsets, index, offset)
    gather(levels.columns, index, columns)
    most = len(levels.values) - 1.0
    for lane in range(LANES):
        size = walks.size[lane]
        nodes.left[lane], nodes.right[lane], column = _node(repeat, walks.column[lane], size, levels.across)
        nodes.above[lane], nodes.under[lane], row = _node(repeat, walks.row[lane], size, levels.down)
        place[lane] = np.int32(clamped(offset[lane] + row * columns[lane] + column, 0.0, most))  # NaN of what is done
    gather(levels.values, place, nodes.surface)


@inlined
def _ahead(walks: Walks, nodes: Nodes) -> None:
    """Where the rays leave their nodes."""
    for lane in range(LANES):
        out_x = _leaves_at(walks.x[lane], walks.dx[lane], nodes.left[lane], nodes.right[lane])
        out_y = _leaves_at(walks.y[lane], walks.dy[lane], nodes.above[lane], nodes.under[lane])
        out, depth, last = (out_x if out_x < out_y else out_y), walks.depth[lane], walks.last[lane]
        out = out if out < last else last
        out = out if out > depth else depth
        surface, goes_on = 1.0 - nodes.surface[lane], walks.hit[lane] < 0.0
        nodes.out_x[lane], nodes.out_y[lane], nodes.out[lane], nodes.surface[lane] = out_x, out_y, out, surface
        nodes.meets[lane] = 1.0 if goes_on & (walks.level[lane] == 0.0) & (surface < out) else 0.0
        walks.fetches[lane] += 1.0 + nodes.meets[lane] if goes_on else 0.0


@inlined
def _advance(top: float, walks: Walks, nodes: Nodes) -> None:
    """Down to the surface's bound and a level down; past what is below the ray or was missed, and a level up."""
    for lane in range(LANES):
        left, right, above, under = nodes.left[lane], nodes.right[lane], nodes.above[lane], nodes.under[lane]
        level, size, depth, out = walks.level[lane], walks.size[lane], walks.depth[lane], nodes.out[lane]
        dx, dy, surface = walks.dx[lane], walks.dy[lane], nodes.surface[lane]
        past, lower = (surface >= out) | (level == 0.0), surface > depth
        reached = out if past else (surface if lower else depth)
        column = _stays(walks.x[lane] + dx * reached, left, right)
        row = _stays(walks.y[lane] + dy * reached, above, under)
        column = (right if dx > 0.0 else left - 1.0) if past & (nodes.out_x[lane] <= out) else column
        row = (under if dy > 0.0 else above - 1.0) if past & (nodes.out_y[lane] <= out) else row
        walks.column[lane] = column if past | lower else walks.column[lane]
        walks.row[lane] = row if past | lower else walks.row[lane]
        walks.depth[lane] = reached
        up = past & (level < top)
        walks.level[lane] = level + 1.0 if up else (level if past else level - 1.0)
        walks.size[lane] = size * 2.0 if up else (size if past else size * 0.5)
        ends = past & (out >= walks.last[lane]) | (walks.fetches[lane] >= _MOST_FETCHES)
        walks.hit[lane] = 2.0 if ends & (walks.hit[lane] < 0.0) else walks.hit[lane]


@device
def _start(repeat: Wrap, columns: float, rows: float, levels: Levels, lane: int, rays: Rays, walks: Walks) -> None:
    """A lane's ray goes off, from the polygon and the coarsest node."""
    u, v, along_u, along_v = rays.u[lane], rays.v[lane], rays.along_u[lane], rays.along_v[lane]
    shift = 0.5 if repeat is None else -0.5  # the outer cells of a map that ends are counted too
    x, y, last = u * columns + shift, v * rows + shift, 1.0
    column, row, top = np.floor(x), np.floor(y), len(levels.offsets) - 1
    if repeat is None:
        _, last = clip_unit(u, -along_u, 0.0, 1.0)
        _, last = clip_unit(v, -along_v, 0.0, last)
        column, row = _stays(x, 0.0, levels.across), _stays(y, 0.0, levels.down)
    walks.x[lane], walks.y[lane], walks.dx[lane], walks.dy[lane] = x, y, -along_u * columns, -along_v * rows
    walks.column[lane], walks.row[lane], walks.level[lane], walks.size[lane] = column, row, 1.0 * top, 1.0 * (1 << top)
    walks.last[lane], walks.depth[lane], walks.fetches[lane], walks.hit[lane] = last, 0.0, 0.0, -1.0


@device
def _next_ray(points: Floats, first: int, stop: int, eye: Floats, lane: int, rays: Rays) -> int:
    """The first point of [first, stop) with a view ray, which the lane takes; `stop` if there is none."""
    for i in range(first, stop):
        u, v, along_u, along_v, seen = view_ray(points, i, eye)
        if seen:
            rays.u[lane], rays.v[lane], rays.along_u[lane], rays.along_v[lane] = u, v, along_u, along_v
            return i
    return stop


@device
def _finish(i: int, lane: int, rays: Rays, walks: Walks, found: Hits, fetches: Indices) -> None:
    """Point i's ray is at its end: keep what it has found."""
    fetches[i] = np.int32(walks.fetches[lane])
    d = walks.hit[lane]
    if d <= 1.0 or walks.last[lane] == 1.0:
        d = min(d, 1.0)
        keep(found, i, 0, rays.u[lane] - rays.along_u[lane] * d, rays.v[lane] - rays.along_v[lane] * d, d, False)


@device
def _meet(repeat: Wrap, texels: Texels, columns: float, rows: float, rays: Rays, walks: Walks, nodes: Nodes) -> None:
    """Patches, lane by lane: few lanes come to one at a time."""
    for lane in range(LANES if largest(nodes.meets) > 0.0 else 0):
        if nodes.meets[lane] > 0.0:
            u, v, along_u, along_v = rays.u[lane], rays.v[lane], rays.along_u[lane], rays.along_v[lane]
            first, last = walks.depth[lane], nodes.out[lane]
            hit = _patch_hit(repeat, texels, columns, rows, u, v, along_u, along_v, first, last)
            walks.hit[lane] = hit if hit <= 1.0 else walks.hit[lane]


@device
def _trace(
    repeat: Wrap, points: Floats, first: int, stop: int, eye: Floats, texels: Texels, columns: float, rows: float,
    levels: Levels, found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """The points [first, stop): a lane whose ray has ended takes the next one."""
    rays, point = Rays(lanes(), lanes(), lanes(), lanes()), index_lanes()
    nodes = Nodes(lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes())
    walks = Walks(
        lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes(),
    )  # fmt: skip
    for lane in range(LANES):
        rays.u[lane] = rays.v[lane] = rays.along_u[lane] = rays.along_v[lane] = 0.0
        _start(repeat, columns, rows, levels, lane, rays, walks)
        point[lane], walks.hit[lane] = -1, 2.0
    while True:
        for lane in range(LANES if largest(walks.hit) >= 0.0 else 0):
            if walks.hit[lane] >= 0.0 and point[lane] >= 0:
                _finish(point[lane], lane, rays, walks, found, fetches)
                point[lane] = -1
            if walks.hit[lane] >= 0.0 and first < stop:
                first = _next_ray(points, first, stop, eye, lane, rays)
                if first < stop:
                    point[lane], first = first, first + 1
                    _start(repeat, columns, rows, levels, lane, rays, walks)
        if smallest(walks.hit) >= 0.0:
            break
        _read(repeat, levels, walks, nodes)
        _ahead(walks, nodes)
        _meet(repeat, texels, columns, rows, rays, walks, nodes)
        _advance(len(levels.offsets) - 1.0, walks, nodes)


@kernel
def maximum_mipmap_search(
    repeat: Wrap, points: Floats, eye: Floats, texels: Texels, columns: float, rows: float, levels: Levels,
    found: Hits, fetches: Indices,
) -> None:  # fmt: skip
    """Hits of all points, (3, P)."""
    count = len(fetches)
    for block in prange((count + _BLOCK - 1) // _BLOCK):
        first, stop = block * _BLOCK, min(count, (block + 1) * _BLOCK)
        _trace(repeat, points, first, stop, eye, texels, columns, rows, levels, found, fetches)


def _levels(tree: Quadtree) -> Levels:
    offsets, columns = tree.offsets.astype(np.float64), tree.columns.astype(np.float64)
    return Levels(tree.values, offsets, columns, float(tree.columns[0]), float(tree.rows[0]))


def search(s: Sought) -> None:
    """Hits of a polygon."""
    tree = s.prepared(("quadtree",), lambda: build(s.heights, s.repeat is not None))
    maximum_mipmap_search(s.repeat, s.points, s.constants.eye, *s.height, _levels(tree), *s.found)
