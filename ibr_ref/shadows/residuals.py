"""What a warped map lacks of the rendered one, and how that changes with the control points: the kernels of registration.

Two warps in turn map through the same barycentric coordinates, so that a texel of the warped map is, but for the blur of
the fetches in between, sum_k w_k M_k(u_k) over the four maps around, u_k = sum_a l_a G_k,a in the triangle of
G' = sum_k w_k G_k that the texel is in. Its derivative by a control point counts the point twice, as texture coordinate
and as corner:

    dI / dG_k,a = w_k l_a (grad M_k(u_k) - grad I),    grad I = sum_j w_j A_j^T grad M_j(u_j),    A_j = du_j / dx

The normal equations are kept as elements, one for each triangle of a cell of the 3 x 3 positions: it knows 24 numbers, the
coordinates of its three corners in four maps, and one thread sums all its texels at all places.

What kernels take: images (9, S S); matrix (E, 24, 24), gradient (E, 24) and cost (E,) as in `Equations`; of one element xs
and ys (3,), corners (4, 3, 2), of a map (3, 2), affine (4, 2, 2), of a map (2, 2), weights (4,), sums (3, 3, 8, 8) and slope
(24,); of a texel gradients (4, 2) and barycentric (3,); target (S,) the rendered row.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Ints, Texels
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.sampling import footprint
from ibr_ref.pipeline.triangles import SUBPIXELS, Edges, columns_in_row, edges_in_row
from ibr_ref.shadows.folds import four_grids

LOCAL = 24
"""Numbers that an element knows: [map 00, 10, 01, 11][corner][u, v]."""


class Places(NamedTuple):
    """Places of the object with the maps rendered there, sorted by cell."""

    starts: NDArray[np.int64]
    """(5,) the places of cell q are starts[q] to starts[q + 1] - 1; q = 2 j + i."""
    weights: Floats
    """(N, 4) of the maps 00, 10, 01, 11 in the mix."""
    targets: Floats
    """(N, S, S) the rendered maps."""


class Equations(NamedTuple):
    """Sums over the texels of each element."""

    matrix: Floats
    """(E, 24, 24) J^T J; no rows where only the cost is asked for."""
    gradient: Floats
    """(E, 24) J^T r."""
    cost: Floats
    """(E,) r^T r."""


class _Elements(NamedTuple):
    """The triangles of all elements at all places."""

    sources: Floats
    """(4, T, 4, 3, 2) texture coordinates in the four maps."""
    x: NDArray[np.int64]
    """(N, T, 3) corners in the window, in 1/256 texel."""
    y: NDArray[np.int64]
    """(N, T, 3)."""


@device
def _gather(image: Texels, u: float, v: float, size: float, gradient: Floats) -> float:
    """Bilinear fetch from an image (S S) flat, and its gradient by (u, v) into gradient (2,)."""
    i00, i10, i01, i11, fx, fy = footprint(u, v, size, size, None)
    t00, t10, t01, t11 = image[i00], image[i10], image[i01], image[i11]
    top, bottom = t00 + (t10 - t00) * fx, t01 + (t11 - t01) * fx
    gradient[0] = ((t10 - t00) * (1.0 - fy) + (t11 - t01) * fy) * size
    gradient[1] = (bottom - top) * size
    return top + (bottom - top) * fy


@device
def _affine(xs: Ints, ys: Ints, corners: Floats, size: float, out: Floats) -> None:
    """(2, 2) derivative of the texture coordinates by the place in the map, [u or v, x or y]; and the barycentrics'."""
    x0, y0 = np.float64(xs[0]), np.float64(ys[0])
    ax, ay = np.float64(xs[1]) - x0, np.float64(ys[1]) - y0
    bx, by = np.float64(xs[2]) - x0, np.float64(ys[2]) - y0
    scale = size * SUBPIXELS / (ax * by - ay * bx)
    for d in range(2):
        a, b = corners[1, d] - corners[0, d], corners[2, d] - corners[0, d]
        out[d, 0] = (a * by - b * ay) * scale
        out[d, 1] = (b * ax - a * bx) * scale


@device
def _add(
    weights: Floats,
    gradients: Floats,
    affine: Floats,
    barycentric: Floats,
    difference: float,
    sums: Floats,
    slope: Floats,
) -> None:
    """Add a texel to the sums: [pair of corners][24 / 3 squared] of the matrix, (24,) of the gradient."""
    gx, gy = 0.0, 0.0
    for k in range(4):
        gx += weights[k] * (affine[k, 0, 0] * gradients[k, 0] + affine[k, 1, 0] * gradients[k, 1])
        gy += weights[k] * (affine[k, 0, 1] * gradients[k, 0] + affine[k, 1, 1] * gradients[k, 1])
    for k in range(4):
        gradients[k, 0] = weights[k] * (gradients[k, 0] - gx)
        gradients[k, 1] = weights[k] * (gradients[k, 1] - gy)
    for a in range(3):
        for k in range(4):
            for d in range(2):
                slope[(k * 3 + a) * 2 + d] += barycentric[a] * gradients[k, d] * difference
        for b in range(a, 3):
            share = barycentric[a] * barycentric[b]
            for i in range(8):
                row = share * gradients[i // 2, i % 2]
                for j in range(8):
                    sums[a, b, i, j] += row * gradients[j // 2, j % 2]


@device
def _spread(sums: Floats, matrix: Floats) -> None:
    """Sums by pairs of corners, into the symmetric matrix (24, 24)."""
    for a in range(3):
        for b in range(3):
            for i in range(8):
                for j in range(8):
                    value = sums[a, b, i, j] if a <= b else sums[b, a, j, i]
                    matrix[(i // 2 * 3 + a) * 2 + i % 2, (j // 2 * 3 + b) * 2 + j % 2] = value


@device
def _sum_row(
    images: Floats,
    first: int,
    weights: Floats,
    corners: Floats,
    affine: Floats,
    target: Floats,
    edges: Edges,
    sums: Floats | None,
    slope: Any,
) -> float:
    """The texels of a triangle in one row: returns their sum of squares. sums, slope: None where only that is asked for."""
    size = np.float64(len(target))
    total = np.float64(edges.e0 + edges.e1 + edges.e2)
    gradients, barycentric = np.empty((4, 2)), np.empty(3)
    start, stop = columns_in_row(edges, len(target))
    cost = 0.0
    for column in range(start, stop):
        barycentric[0] = np.float64(edges.e0 + edges.step0 * column) / total
        barycentric[1] = np.float64(edges.e1 + edges.step1 * column) / total
        barycentric[2] = np.float64(edges.e2 + edges.step2 * column) / total
        value, steep = 0.0, False
        for k in range(4):
            c = corners[k]
            u = barycentric[0] * c[0, 0] + barycentric[1] * c[1, 0] + barycentric[2] * c[2, 0]
            v = barycentric[0] * c[0, 1] + barycentric[1] * c[1, 1] + barycentric[2] * c[2, 1]
            value += weights[k] * _gather(images[first + k // 2 * 3 + k % 2], u, v, size, gradients[k])
            steep = steep or gradients[k, 0] != 0.0 or gradients[k, 1] != 0.0
        difference = value - target[column]
        cost += difference * difference
        if sums is not None and steep:
            _add(weights, gradients, affine, barycentric, difference, sums, slope)
    return cost


@device
def _sum_element(
    images: Floats, places: Places, elements: _Elements, cell: int, t: int, sums: Floats | None, slope: Floats | None
) -> float:
    """One triangle at all places of a cell: returns the sum of squares."""
    size = places.targets.shape[1]
    affine = np.empty((4, 2, 2))
    corners = elements.sources[cell, t]
    first = cell // 2 * 3 + cell % 2
    cost = 0.0
    for n in range(places.starts[cell], places.starts[cell + 1]):
        xs, ys, weights = elements.x[n, t], elements.y[n, t], places.weights[n]
        for k in range(4):
            _affine(xs, ys, corners[k], np.float64(size), affine[k])
        for row in range(max(0, ys.min() // SUBPIXELS), min(size - 1, ys.max() // SUBPIXELS) + 1):
            edges = edges_in_row(xs, ys, row)
            if edges.e0 + edges.e1 + edges.e2 != 0:
                cost += _sum_row(images, first, weights, corners, affine, places.targets[n, row], edges, sums, slope)
    return cost


@device
def _run_element(
    images: Floats,
    places: Places,
    elements: _Elements,
    e: int,
    matrix: Floats | None,
    gradient: Any,
    cost: Floats,
) -> None:
    """matrix, gradient: None where only the sum of squares is asked for."""
    count = elements.sources.shape[1]
    cell, t = e // count, e % count
    if matrix is None:
        cost[e] = _sum_element(images, places, elements, cell, t, None, None)
    else:
        sums = np.zeros((3, 3, 8, 8))
        cost[e] = _sum_element(images, places, elements, cell, t, sums, gradient[e])
        _spread(sums, matrix[e])


@kernel
def _run(
    images: Floats, places: Places, elements: _Elements, matrix: Floats | None, gradient: Floats | None, cost: Floats
) -> None:
    for e in prange(len(cost)):
        _run_element(images, places, elements, e, matrix, gradient, cost)


def _elements(controls: Floats, places: Places) -> _Elements:
    sources, size = four_grids(controls), places.targets.shape[1]
    windows = []
    for cell in range(4):
        w = places.weights[places.starts[cell] : places.starts[cell + 1], :, None, None, None]
        c = sources[cell].swapaxes(0, 1)
        windows.append(c[0] * w[:, 0] + c[1] * w[:, 1] + c[2] * w[:, 2] + c[3] * w[:, 3])
    window = np.rint(np.concatenate(windows) * (size * SUBPIXELS)).astype(np.int64)
    return _Elements(sources, np.ascontiguousarray(window[..., 0]), np.ascontiguousarray(window[..., 1]))


def equations(images: Floats, places: Places, controls: Floats) -> Equations:
    """The normal equations of warped against rendered maps. images (9, S S), controls (3, 3, R, C, 2)."""
    elements = _elements(controls, places)
    count = 4 * elements.sources.shape[1]
    out = Equations(np.zeros((count, LOCAL, LOCAL)), np.zeros((count, LOCAL)), np.zeros(count))
    _run(images, places, elements, out.matrix, out.gradient, out.cost)
    return out


def cost(images: Floats, places: Places, controls: Floats) -> float:
    """The sum of squares alone."""
    elements = _elements(controls, places)
    costs = np.zeros(4 * elements.sources.shape[1])
    _run(images, places, elements, None, None, costs)
    return float(sum(costs.tolist()))
