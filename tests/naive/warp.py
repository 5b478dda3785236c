"""shadows/method.md, "Stage warp": an image warped by control points, and the map for any offset."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .raster import Texture, covered, lerp
from .shadow_light import Pair

Point = tuple[float, float]
Grid = list[list[Point]]

OUTSIDE = {"mask": 0.0, "depth": 1.0}
"""What a warped image holds where the mesh does not reach."""


class Warped(NamedTuple):
    """The stage "warp" of one light sample; `shares` is a stage array with interpolation="projective" only."""

    cell: np.ndarray
    fraction: np.ndarray
    shares: np.ndarray
    row_grids: np.ndarray
    rows: np.ndarray
    grid: np.ndarray
    image: np.ndarray


# --- Grids -----------------------------------------------------------------------------------------------------------


def plain_grid(array: Any) -> Grid:
    """Control points (R, C, 2) as plain floats."""
    return [[(float(u), float(v)) for u, v in row] for row in array]


def mixed_grid(a: Grid, b: Grid, f: float) -> Grid:
    """lerp(a, b, f), point by point."""
    return [
        [(lerp(p[0], q[0], f), lerp(p[1], q[1], f)) for p, q in zip(row_a, row_b, strict=True)]
        for row_a, row_b in zip(a, b, strict=True)
    ]


def mesh_triangles(rows: int, columns: int) -> list[tuple[tuple[int, int], ...]]:
    """(row, column) of the three points of all triangles, in drawing order."""
    triangles: list[tuple[tuple[int, int], ...]] = []
    for r in range(rows - 1):
        for c in range(columns - 1):
            triangles.append(((r, c), (r, c + 1), (r + 1, c + 1)))
            triangles.append(((r, c), (r + 1, c + 1), (r + 1, c)))
    return triangles


# --- One warp --------------------------------------------------------------------------------------------------------


def snapped(point: Point, size: int) -> tuple[int, int]:
    """The window position in units of 1/256 pixel, ties to even (conventions.md, "Triangles")."""
    return round(256.0 * (point[0] * size)), round(256.0 * (point[1] * size))


def weighted(weights: list[int], a: float, b: float, c: float) -> float:
    """(l_a a + l_b b) + l_c c with l = edge function / area."""
    area = float(weights[0] + weights[1] + weights[2])
    l_a, l_b, l_c = (float(e) / area for e in weights)
    return (l_a * a + l_b * b) + l_c * c


def warp_image(image: np.ndarray, source: Grid, target: Grid, content: str) -> np.ndarray:
    """Image (S, S) warped from the grid `source` to the grid `target`."""
    size = int(image.shape[0])
    texture = Texture(image, False)
    result = np.full((size, size), OUTSIDE[content])
    for triangle in mesh_triangles(len(target), len(target[0])):
        corners = [snapped(target[r][c], size) for r, c in triangle]
        p, q, o = (source[r][c] for r, c in triangle)
        for column, row, weights in covered(corners, size, size):
            u = weighted(weights, p[0], q[0], o[0])
            v = weighted(weights, p[1], q[1], o[1])
            result[row, column] = texture.value(u, v)
    return result


def mixed_image(a: np.ndarray, b: np.ndarray, f: float) -> np.ndarray:
    """a (1 - f) + b f, pixel by pixel."""
    result = np.empty(a.shape)
    for row in range(a.shape[0]):
        for column in range(a.shape[1]):
            result[row, column] = lerp(float(a[row, column]), float(b[row, column]), f)
    return result


# --- The stage -------------------------------------------------------------------------------------------------------


def cell_of(value: float, line: list[float]) -> tuple[int, float]:
    """(cell, fraction in it) on one axis; on the middle line the upper cell."""
    cell = 0 if value < line[1] else 1
    return cell, (value - line[cell]) / (line[cell + 1] - line[cell])


def paced(f: float, w0: float, w1: float) -> float:
    """f' = f w1 / ((1 - f) w0 + f w1): how far along in the map what went the share f between depths w0 and w1 is."""
    return (f * w1) / ((1.0 - f) * w0 + f * w1)


def shares_of(s: float, t: float, depths: Any, i: int, j: int) -> tuple[float, float, float]:
    """The shares of the upper row, the lower row and between the rows; depths (3, 3) or None: an even pace."""
    if depths is None:
        return s, s, t
    w00, w10, w01, w11 = (float(depths[j + b, i + a]) for b in (0, 1) for a in (0, 1))
    return paced(s, w00, w10), paced(s, w01, w11), paced(t, lerp(w00, w10, s), lerp(w01, w11, s))


def between(
    a: np.ndarray, b: np.ndarray, grid_a: Grid, grid_b: Grid, target: Grid, f: float, params: Any
) -> np.ndarray:
    """Between two images: policy "dissolve" warps both and mixes them, "nearest" warps the nearer one."""
    if params.policy == "nearest":
        image, source = (a, grid_a) if f < 0.5 else (b, grid_b)
        return warp_image(image, source, target, params.content)
    if params.policy != "dissolve":
        raise ValueError(f"policy: {params.policy!r} is neither 'dissolve' nor 'nearest'")
    first = warp_image(a, grid_a, target, params.content)
    second = warp_image(b, grid_b, target, params.content)
    return mixed_image(first, second, f)


def warped_map(offset: Pair, positions: Any, images: Any, controls: Any, params: Any, depths: Any = None) -> Warped:
    """The map for the object at an offset, from the nine maps (3, 3, S, S) and their controls (3, 3, R, C, 2).

    depths (3, 3): the caster's in the nine maps, for interpolation="projective".
    """
    i, s = cell_of(offset[0], [float(positions[0, k, 0]) for k in range(3)])
    j, t = cell_of(offset[1], [float(positions[k, 0, 1]) for k in range(3)])
    grids, rows = [], []
    upper, lower, across = shares_of(s, t, depths, i, j)
    for at, f in ((j, upper), (j + 1, lower)):
        left, right = plain_grid(controls[at, i]), plain_grid(controls[at, i + 1])
        grid = mixed_grid(left, right, f)
        grids.append(grid)
        rows.append(between(images[at, i], images[at, i + 1], left, right, grid, f, params))
    final = mixed_grid(grids[0], grids[1], across)
    image = between(rows[0], rows[1], grids[0], grids[1], final, across, params)
    return Warped(
        cell=np.array([i, j], dtype=np.int32),
        fraction=np.array([s, t], dtype=np.float64),
        shares=np.array([upper, lower, across], dtype=np.float64),
        row_grids=np.array(grids, dtype=np.float64),
        rows=np.array(rows),
        grid=np.array(final, dtype=np.float64),
        image=image,
    )
