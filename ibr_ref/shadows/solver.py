"""Conjugate gradients on equations that are kept element by element: no matrix of all unknowns is ever put together.

Of E elements that know K unknowns each, out of N: matrix (E, K, K), members (E, K); everything else is (N,).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Ints
from ibr_ref.jit import device, routine


@device
def _times(matrix: Floats, members: Ints, ridge: Floats, x: Floats, out: Floats) -> None:
    """out = (sum of the elements' matrices + diag(ridge)) x."""
    for i in range(len(x)):
        out[i] = ridge[i] * x[i]
    for e in range(len(members)):
        for i in range(members.shape[1]):
            total = 0.0
            for j in range(members.shape[1]):
                total += matrix[e, i, j] * x[members[e, j]]
            out[members[e, i]] += total


@device
def _dot(a: Floats, b: Floats) -> float:
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total


@routine
def _solve(
    matrix: Floats,
    members: Ints,
    ridge: Floats,
    diagonal: Floats,
    free: Floats,
    right: Floats,
    steps: int,
    tolerance: float,
    x: Floats,
) -> None:
    """Preconditioned by the diagonal; unknowns that are not free stay 0."""
    n = len(x)
    residual, direction, product = right * free, np.empty(n), np.empty(n)
    for i in range(n):
        direction[i] = residual[i] / diagonal[i]
    fall = _dot(residual, direction)
    enough = tolerance * tolerance * fall
    for _ in range(steps):
        if not fall > enough:
            break
        _times(matrix, members, ridge, direction, product)
        for i in range(n):
            product[i] *= free[i]
        step = fall / _dot(direction, product)
        for i in range(n):
            x[i] += step * direction[i]
            residual[i] -= step * product[i]
        before, fall = fall, 0.0
        for i in range(n):
            fall += residual[i] * residual[i] / diagonal[i]
        for i in range(n):
            direction[i] = residual[i] / diagonal[i] + fall / before * direction[i]


@routine
def _scatter(values: Floats, members: Ints, out: Floats) -> None:
    """Add values (E, K) to the unknowns (N,) that their elements know."""
    for e in range(len(members)):
        for i in range(members.shape[1]):
            out[members[e, i]] += values[e, i]


def scatter(values: Floats, members: NDArray[np.int64], count: int) -> Floats:
    """(count,) sums of the elements' values (E, K) by the unknowns `members` (E, K)."""
    out = np.zeros(count)
    _scatter(values, members, out)
    return out


class Equations(NamedTuple):
    """(sum of the elements' matrices + diag(ridge)) x = right, on the unknowns that are free."""

    matrix: Floats
    """(E, K, K) symmetric, not negative."""
    members: NDArray[np.int64]
    """(E, K) the unknowns that each element knows."""
    ridge: Floats
    """(N,) > 0."""
    free: Floats
    """(N,) 1; 0 for unknowns that stay 0."""


def solve(equations: Equations, right: Floats, steps: int, tolerance: float) -> Floats:
    """x (N,); stops after `steps`, or where the residual, in the diagonal's norm, fell to its `tolerance`-th part."""
    matrix, members, ridge, free = equations
    x = np.zeros(len(right))
    diagonals = np.ascontiguousarray(np.diagonal(matrix, axis1=1, axis2=2))
    diagonal = ridge + scatter(diagonals, members, len(right))
    _solve(matrix, members, ridge, diagonal, free, right, steps, tolerance, x)
    return x
