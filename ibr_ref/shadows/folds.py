"""That no triangle folds wherever the object is: areas in Bernstein form.

In a cell of the 3 x 3 positions a corner moves bilinearly between its four grids, so that a triangle's area is a
polynomial of degree (2, 2) in the fractions s and t. Its nine Bernstein coefficients are mixed areas
cross(e_k, f_l) of the triangle's edges e and f in the maps k and l; where all are positive, so is the area, at every
place. As sums of products of coordinates they have simple derivatives, and keep away from zero by a logarithmic barrier.

At the projective pace maps are mixed by their bilinear weights times the caster's depths w, over the sum of these. Times
the square of that sum, which is positive, the area is such a polynomial too: with w_k w_l in front of the mixed areas.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.jit import device, kernel, prange
from ibr_ref.shadows.draw import grid_triangles


def _forms() -> Floats:
    """(9, 4, 4) weights of the mixed areas of maps k and l in each coefficient, [3 m + n]: of degree m in t, n in s."""
    along = np.zeros((3, 2, 2))  # products of linear polynomials, by degree
    along[0, 0, 0] = along[2, 1, 1] = 1.0
    along[1, 0, 1] = along[1, 1, 0] = 0.5
    forms: Floats = np.einsum("mac,nbd->mnabcd", along, along).reshape(9, 4, 4)
    return forms


_FORMS = _forms()

EVEN = _FORMS[None].copy()
"""(1, 9, 4, 4) the forms at the even pace, of all cells of the positions."""


def forms_of(depths: Floats | None) -> Floats:
    """(4, 9, 4, 4) the forms of each cell, for the caster's depths (3, 3) in the nine maps; None: `EVEN`."""
    if depths is None:
        return EVEN
    cells = np.stack([depths[j : j + 2, i : i + 2].reshape(4) for j in range(2) for i in range(2)])
    shares = cells / cells.mean(axis=1)[:, None]
    return np.ascontiguousarray(_FORMS * (shares[:, None, :, None] * shares[:, None, None, :]))


@device
def _coefficient(form: Floats, corners: Floats) -> float:
    """A coefficient: twice an area. form (4, 4), corners (4, 3, 2)."""
    area = 0.0
    for k in range(4):
        for l in range(4):
            if form[k, l] != 0.0:
                ex, ey = corners[k, 1, 0] - corners[k, 0, 0], corners[k, 1, 1] - corners[k, 0, 1]
                fx, fy = corners[l, 2, 0] - corners[l, 0, 0], corners[l, 2, 1] - corners[l, 0, 1]
                area += form[k, l] * (ex * fy - ey * fx)
    return area


@device
def _slope(form: Floats, corners: Floats, out: Floats) -> None:
    """The coefficient's derivative by [map][corner][u, v], into (24,). form (4, 4), corners (4, 3, 2)."""
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
def _coefficients_of(forms: Floats, corners: Floats, out: Floats) -> None:
    """All of a triangle, into (9,): forms (9, 4, 4), corners (4, 3, 2)."""
    for m in range(len(forms)):
        out[m] = _coefficient(forms[m], corners)


@kernel
def _all_coefficients(forms: Floats, corners: Floats, out: Floats) -> None:
    """Of all triangles, into (E, 9): forms (F, 9, 4, 4), corners (E, 4, 3, 2)."""
    count = len(out) // len(forms)
    for e in prange(len(out)):
        _coefficients_of(forms[e // count], corners[e], out[e])


@device
def _push(forms: Floats, corners: Floats, least: float, strength: float, matrix: Floats, gradient: Floats) -> None:
    """Of a triangle, added to matrix (24, 24) and gradient (24,): forms (9, 4, 4), corners (4, 3, 2)."""
    slope = np.empty(24)
    for m in range(len(forms)):
        room = _coefficient(forms[m], corners) - least
        _slope(forms[m], corners, slope)
        for i in range(24):
            gradient[i] -= strength / room * slope[i]
            for j in range(24):
                matrix[i, j] += strength / (room * room) * (slope[i] * slope[j])


@kernel
def _push_all(forms: Floats, corners: Floats, least: float, strength: float, matrix: Floats, gradient: Floats) -> None:
    """Of all: forms (F, 9, 4, 4), corners (E, 4, 3, 2), matrix (E, 24, 24), gradient (E, 24)."""
    count = len(corners) // len(forms)
    for e in prange(len(corners)):
        _push(forms[e // count], corners[e], least, strength, matrix[e], gradient[e])


def coefficients(corners: Floats, forms: Floats = EVEN) -> Floats:
    """(E, 9) Bernstein coefficients of twice the area, for corners (E, 4, 3, 2) in the maps 00, 10, 01, 11 of a cell.

    forms (F, 9, 4, 4): those of `forms_of`, of E / F triangles in a row each.
    """
    out = np.empty((len(corners), 9))
    _all_coefficients(forms, corners, out)
    return out


def four_grids(controls: NDArray[Any]) -> NDArray[Any]:
    """(4, T, 4, 3, 2) the corners of the triangles in the four maps 00, 10, 01, 11 of each cell."""
    triangles = [[grid_triangles(grid) for grid in line] for line in controls]
    cells = [(j, i) for j in range(2) for i in range(2)]
    return np.stack([np.stack([triangles[j + k // 2][i + k % 2] for k in range(4)], axis=1) for j, i in cells])


def folding(controls: Floats, forms: Floats = EVEN) -> NDArray[np.bool_]:
    """(4, T) which triangles of controls (3, 3, R, C, 2) may fold somewhere in a cell: all that do, and few others."""
    found = coefficients(four_grids(controls).reshape(-1, 4, 3, 2), forms)
    return np.asarray(~(found > 0.0).all(axis=1), np.bool_).reshape(4, -1)


def unfolded(controls: Floats, forms: Floats = EVEN) -> bool:
    """Whether no triangle of controls (3, 3, R, C, 2) folds, at any place: sufficient, not necessary."""
    return not folding(controls, forms).any()


def barrier(corners: Floats, least: float, strength: float, forms: Floats = EVEN) -> float:
    """- strength sum log(coefficient - least); infinity where one is not above `least`."""
    room = coefficients(corners, forms) - least
    if not (room > 0.0).all():
        return np.inf
    return -strength * float(sum(np.log(room).ravel().tolist()))


def add_barrier(
    corners: Floats, least: float, strength: float, matrix: Floats, gradient: Floats, forms: Floats = EVEN
) -> None:
    """Add the barrier's slope, and the part of its curvature that is never negative, to equations by element.

    matrix (E, 24, 24), gradient (E, 24): of the corners (E, 4, 3, 2).
    """
    _push_all(forms, corners, least, strength, matrix, gradient)
