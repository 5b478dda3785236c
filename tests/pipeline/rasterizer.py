"""Draws triangles with the pipeline's own stages; and who covers what, said independently."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Floats, Ints
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.clip import clip_triangles
from ibr_ref.pipeline.triangles import Triangles, columns_in_row, edges_in_row, fill_depth, fill_varyings, set_up

Point = tuple[int, int]


class Drawing(NamedTuple):
    """What a picture holds after all triangles have been drawn, without a depth test: the last one stays."""

    count: NDArray[np.int64]
    """(H, W) how many triangles cover the pixel."""
    depth: NDArray[np.float64]
    varyings: NDArray[np.float64]
    """(K, H, W)."""
    triangles: Triangles


@device
def _draw_row(
    xs: Ints,
    ys: Ints,
    zs: Floats,
    ws: Floats,
    varyings: Floats,
    rows: Ints,
    row: int,
    width: int,
    count: Ints,
    depth: Floats,
    out: Floats,
) -> None:
    """A row of all triangles, as in `Triangles`; count, depth (H, W), out (K, H, W)."""
    for t in range(len(xs)):
        if rows[t, 0] <= row < rows[t, 1]:
            edges = edges_in_row(xs[t], ys[t], row)
            first, stop = columns_in_row(edges, width)
            for column in range(first, stop):
                count[row, column] += 1
            fill_depth(edges, first, stop, zs[t], depth[row], first)
            fill_varyings(edges, first, stop, varyings[t], ws[t], out[:, row], first)


@kernel
def _draw(
    xs: Ints,
    ys: Ints,
    zs: Floats,
    ws: Floats,
    varyings: Floats,
    rows: Ints,
    width: int,
    height: int,
    count: Ints,
    depth: Floats,
    out: Floats,
) -> None:
    for row in prange(height):
        _draw_row(xs, ys, zs, ws, varyings, rows, row, width, count, depth, out)


def draw(clip: ArrayLike, indices: ArrayLike, width: int, height: int, varyings: ArrayLike | None = None) -> Drawing:
    """Clip, set up and rasterize triangles with corners clip (V, 4) and varyings (V, K)."""
    clip = np.array(clip, np.float64).reshape(-1, 4)
    values = np.zeros((len(clip), 1)) if varyings is None else np.array(varyings, np.float64)
    clipped = clip_triangles(clip, values, np.array(indices, np.int32).reshape(-1, 3), width, height)
    triangles = set_up(clipped, width, height)
    count = np.zeros((height, width), np.int64)
    depth = np.full((height, width), np.nan)
    out = np.full((values.shape[1], height, width), np.nan)
    x, y, z, w, corner_values, _, rows = triangles
    _draw(x, y, z, w, corner_values, rows, width, height, count, depth, out)
    return Drawing(count, depth, out, triangles)


def at_window(points: Iterable[Point], size: int) -> list[tuple[float, float, float, float]]:
    """Clip coordinates, z = 0.5 and w = 1, whose window coordinates are exactly `points` in 1/256 pixel.

    The picture's size must be a power of two: then nothing is rounded.
    """
    return [(x / (128 * size) - 1, 1 - y / (128 * size), 0.5, 1.0) for x, y in points]


def edge(a: Point, b: Point, p: Point) -> int:
    """Twice the area of a, b, p: exact, in Python integers."""
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def inside(corners: list[Point], p: Point) -> bool:
    """Whether the sample p, moved to the right by e and down by e^2 (e infinitely small), is inside the triangle.

    That is the top-left rule in other words: no sample is on an edge any more. An edge function grows by -dy along x
    and by dx along y, so that its sign is that of the first of (E, -dy, dx) that is not zero.
    """
    signs = []
    for a, b in ((corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])):
        growth = (edge(a, b, p), a[1] - b[1], b[0] - a[0])
        signs.append(next((1 if g > 0 else -1 for g in growth if g), 0))
    return signs in ([1, 1, 1], [-1, -1, -1])


def covered(corners: list[Point], width: int, height: int) -> NDArray[np.int64]:
    """(H, W) 1 where the centre of the pixel is inside the triangle, with corners in 1/256 pixel."""
    if edge(*corners) == 0:
        return np.zeros((height, width), np.int64)
    return np.array(
        [[int(inside(corners, (256 * x + 128, 256 * y + 128))) for x in range(width)] for y in range(height)], np.int64
    )
