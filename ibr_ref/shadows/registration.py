"""Registration of warped on rendered maps: damped Gauss-Newton steps (Levenberg-Marquardt) on all nine grids at once.

What falls is half the sum of squared differences at all training places, and a logarithmic barrier against folds. Points
that nothing in the maps holds on to go with their neighbours: a step is damped by the squared differences along the sides
of the triangles too. Damping acts on steps alone, so that it draws the result nowhere.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.shadows import folds, residuals, solver
from ibr_ref.shadows.folds import four_grids
from ibr_ref.shadows.residuals import LOCAL, Places

_LEAST_AREA = 2e-5
"""Twice a triangle's area, as a share of the map's: 1.3 texels of 256 x 256. Lower where a start has less."""

_BARRIER = 1e-3
"""Its strength, beside squared differences of coverage."""

_SMOOTHNESS = 0.01
"""Of a step, beside the mean of the diagonal of J^T J; _RIDGE keeps what has no slope at all in place."""
_RIDGE = 1e-3

_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-2, 1e-6, 1e4
_EASED, _RAISED = 1.0 / 4.0, 6.0
"""Factors of the damping after a step that was taken, and after one that was not."""

_ENOUGH = 1e-3
"""A step that takes off a smaller share is the last."""

_SOLVER_STEPS, _SOLVER_TOLERANCE = 100, 1e-3


class Task(NamedTuple):
    """What is registered."""

    images: Floats
    """(9, S S) the nine maps."""
    places: Places
    """Training places, and what was rendered there."""
    forms: Floats = folds.EVEN
    """Of the triangles' areas, by the pace between the maps (`folds.forms_of`)."""


class _Slope(NamedTuple):
    """The normal equations at one set of points."""

    matrix: Floats
    """(E, 24, 24)."""
    gradient: Floats
    """(9 R C 2,)."""
    diagonal: Floats
    """(9 R C 2,) of the matrix of all unknowns."""


def _members(shape: tuple[int, ...]) -> NDArray[np.int64]:
    """(E, 24) which unknowns each element knows, of controls (3, 3, R, C, 2) counted through."""
    return four_grids(np.arange(int(np.prod(shape))).reshape(shape)).reshape(-1, LOCAL)


def _free(controls: Floats) -> Floats:
    """(9 R C 2,) 1 where a coordinate may change: the border's points stay on the border, its corners where they are."""
    free = np.ones(controls.shape)
    for border in (np.s_[:, :, 0], np.s_[:, :, -1], np.s_[:, :, :, 0], np.s_[:, :, :, -1]):
        free[border] = (controls[border] > 0.0) & (controls[border] < 1.0)
    return free.reshape(-1)


def _stiffness() -> Floats:
    """(24, 24) of an element: squared differences of the steps along a triangle's sides, in its four maps."""
    sides = np.array([[2.0, -1.0, -1.0], [-1.0, 2.0, -1.0], [-1.0, -1.0, 2.0]])
    return np.asarray(np.kron(np.eye(4), np.kron(sides, np.eye(2))), np.float64)


class _Registration:
    """A task, and what does not change while points move."""

    def __init__(self, controls: Floats, task: Task) -> None:
        self.task = task
        self.members, self.free, self.stiffness = _members(controls.shape), _free(controls), _stiffness()
        self.least = min(_LEAST_AREA, folds.coefficients(self.corners(controls), task.forms).min() / 4.0)

    def corners(self, controls: Floats) -> Floats:
        return four_grids(controls).reshape(-1, 4, 3, 2)

    def objective(self, controls: Floats) -> float:
        fence = folds.barrier(self.corners(controls), self.least, _BARRIER, self.task.forms)
        if fence == np.inf:
            return fence
        return fence + residuals.cost(self.task.images, self.task.places, controls) / 2.0

    def slope(self, controls: Floats) -> _Slope:
        sums = residuals.equations(self.task.images, self.task.places, controls)
        corners, forms = self.corners(controls), self.task.forms
        folds.add_barrier(corners, self.least, _BARRIER, sums.matrix, sums.gradient, forms)
        diagonals = np.ascontiguousarray(np.diagonal(sums.matrix, axis1=1, axis2=2))
        gradient = solver.scatter(sums.gradient, self.members, controls.size)
        return _Slope(sums.matrix, gradient, solver.scatter(diagonals, self.members, controls.size))

    def step(self, slope: _Slope, damping: float) -> Floats:
        level = sum(slope.diagonal.tolist()) / len(slope.diagonal)
        matrix = slope.matrix + damping * _SMOOTHNESS * level * self.stiffness
        ridge = damping * (slope.diagonal + _RIDGE * level)
        equations = solver.Equations(matrix, self.members, ridge, self.free)
        return solver.solve(equations, -slope.gradient, _SOLVER_STEPS, _SOLVER_TOLERANCE)


def register(controls: Floats, task: Task, steps: int, began: Callable[[], None]) -> Floats:
    """Controls (3, 3, R, C, 2) with which the maps, warped to the places, are nearer to what was rendered there.

    At most `steps` steps, each after a call of `began`. Points on the border slide along it. The controls that are given
    must be free of folds at all places; those that are returned are.
    """
    work = _Registration(controls, task)
    damping, value, slope = _FIRST_DAMPING, work.objective(controls), work.slope(controls)
    for _ in range(steps):
        began()
        trial = controls + work.step(slope, damping).reshape(controls.shape)
        before, after = value, work.objective(trial)
        if after < before:
            controls, value, damping = trial, after, max(damping * _EASED, _LEAST_DAMPING)
            if before - after < _ENOUGH * before:
                break
            slope = work.slope(controls)
        else:
            damping *= _RAISED
            if damping > _MOST_DAMPING:
                break
    return controls
