"""That no triangle folds wherever the object is: areas in Bernstein form.

In a cell of the 3 x 3 positions a corner moves bilinearly between its four grids, so that a triangle's area is a
polynomial of degree (2, 2) in the fractions s and t. Its nine Bernstein coefficients are mixed areas
cross(e_k, f_l) of the triangle's edges e and f in the maps k and l; where all are positive, so is the area, at every
place. As sums of products of coordinates they have simple derivatives, and keep away from zero by a logarithmic barrier.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import device, kernel, prange
from ibr_ref.shadows.draw import grid_triangles

Array = NDArray[np.float64]


def _forms() -> Array:
    """(9, 4, 4) weights of the mixed areas of maps k and l in each coefficient, [3 m + n]: of degree m in t, n in s."""
    along = np.zeros((3, 2, 2))  # products of linear polynomials, by degree
    along[0, 0, 0] = along[2, 1, 1] = 1.0
    along[1, 0, 1] = along[1, 1, 0] = 0.5
    forms: Array = np.einsum("mac,nbd->mnabcd", along, along).reshape(9, 4, 4)
    return forms


_FORMS = _forms()


@device
def _coefficient(form, corners):
    """A coefficient: twice an area. corners (4, 3, 2)."""
    area = 0.0
    for k in range(4):
        for l in range(4):
            if form[k, l] != 0.0:
                ex, ey = corners[k, 1, 0] - corners[k, 0, 0], corners[k, 1, 1] - corners[k, 0, 1]
                fx, fy = corners[l, 2, 0] - corners[l, 0, 0], corners[l, 2, 1] - corners[l, 0, 1]
                area += form[k, l] * (ex * fy - ey * fx)
    return area


@device
def _slope(form, corners, out):
    """The coefficient's derivative by [map][corner][u, v], into (24,)."""
    out[:] = 0.0
    for k in range(4):
        for l in range(4):
            if form[k, l] != 0.0:
                ex, ey = corners[k, 1, 0] - corners[k, 0, 0], corners[k, 1, 1] - corners[k, 0, 1]
                fx, fy = corners[l, 2, 0] - corners[l, 0, 0], corners[l, 2, 1] - corners[l, 0, 1]
                w = form[k, l]
                out[k * 6 + 2] += w * fy
                out[k * 6 + 3] -= w * fx
                out[k * 6] -= w * fy
                out[k * 6 + 1] += w * fx
                out[l * 6 + 4] -= w * ey
                out[l * 6 + 5] += w * ex
                out[l * 6] += w * ey
                out[l * 6 + 1] -= w * ex


@device
def _coefficients_of(forms, corners, out):
    for m in range(len(forms)):
        out[m] = _coefficient(forms[m], corners)


@kernel
def _all_coefficients(forms, corners, out):
    for e in prange(len(out)):
        _coefficients_of(forms, corners[e], out[e])


@device
def _push(forms, corners, least, strength, matrix, gradient):
    slope = np.empty(24)
    for m in range(len(forms)):
        room = _coefficient(forms[m], corners) - least
        _slope(forms[m], corners, slope)
        for i in range(24):
            gradient[i] -= strength / room * slope[i]
            for j in range(24):
                matrix[i, j] += strength / (room * room) * (slope[i] * slope[j])


@kernel
def _push_all(forms, corners, least, strength, matrix, gradient):
    for e in prange(len(corners)):
        _push(forms, corners[e], least, strength, matrix[e], gradient[e])


def coefficients(corners: Array) -> Array:
    """(E, 9) Bernstein coefficients of twice the area, for corners (E, 4, 3, 2) in the maps 00, 10, 01, 11."""
    out = np.empty((len(corners), 9))
    _all_coefficients(_FORMS, corners, out)
    return out


def four_grids(controls: NDArray[Any]) -> NDArray[Any]:
    """(4, T, 4, 3, 2) the corners of the triangles in the four maps 00, 10, 01, 11 of each cell."""
    triangles = [[grid_triangles(grid) for grid in line] for line in controls]
    cells = [(j, i) for j in range(2) for i in range(2)]
    return np.stack([np.stack([triangles[j + k // 2][i + k % 2] for k in range(4)], axis=1) for j, i in cells])


def unfolded(controls: Array) -> bool:
    """Whether no triangle of controls (3, 3, R, C, 2) folds, at any place: sufficient, not necessary."""
    return bool((coefficients(four_grids(controls).reshape(-1, 4, 3, 2)) > 0.0).all())


def barrier(corners: Array, least: float, strength: float) -> float:
    """- strength sum log(coefficient - least); infinity where one is not above `least`."""
    room = coefficients(corners) - least
    if not (room > 0.0).all():
        return np.inf
    return -strength * float(sum(np.log(room).ravel().tolist()))


def add_barrier(corners: Array, least: float, strength: float, matrix: Array, gradient: Array) -> None:
    """Add the barrier's slope, and the part of its curvature that is never negative, to equations by element."""
    _push_all(_FORMS, corners, least, strength, matrix, gradient)
