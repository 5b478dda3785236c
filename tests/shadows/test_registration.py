"""The mathematics of registration: residuals are the warp's, slopes those of the residuals, steps solve their equations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ibr_ref.shadows import controls, folds, registration, residuals, solver
from ibr_ref.shadows.draw import Image, draw
from ibr_ref.shadows.residuals import Places
from ibr_ref.shadows.spans import spans

SIZE = 48


def blob(x: float, y: float) -> Any:
    """A smooth spot around (x, y)."""
    v, u = np.meshgrid(*2 * [(np.arange(SIZE) + 0.5) / SIZE], indexing="ij")
    return 1.0 / (1.0 + np.exp(40.0 * (np.hypot(u - x, (v - y) * 1.5) - 0.18)))


@pytest.fixture(scope="module")
def task() -> registration.Task:
    """A spot that moves over nine maps, faster than its controls; one place in each cell, targets elsewhere still."""
    images = np.stack([blob(0.35 + 0.15 * i, 0.35 + 0.15 * j) for j in range(3) for i in range(3)])
    random = np.random.RandomState(2)
    s, t = random.uniform(0.2, 0.8, (2, 4))
    weights = np.stack([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t], axis=1)
    cells = [(j, i) for j in range(2) for i in range(2)]
    targets = [blob(0.37 + 0.15 * (i + a), 0.36 + 0.15 * (j + b)) for (j, i), a, b in zip(cells, s, t, strict=True)]
    return registration.Task(images.reshape(9, -1), Places(np.arange(5), weights, np.array(targets)))


@pytest.fixture(scope="module")
def points() -> Any:
    """Grids that differ, on the lattice of the window."""
    grids = np.array(np.broadcast_to(controls.regular(5, 4), (3, 3, 5, 4, 2)))
    grids[:, :, 1:-1, 1:-1] += np.random.RandomState(1).uniform(-0.05, 0.05, (3, 3, 3, 2, 2))
    return controls.on_lattice(grids, SIZE)


def test_residuals_are_those_of_four_warps(task: registration.Task, points: Any) -> None:
    total = 0.0
    for cell in range(4):
        weights = task.places.weights[cell]
        around = [(cell // 2 + k // 2, cell % 2 + k % 2) for k in range(4)]
        target = sum(w * points[place] for w, place in zip(weights, around, strict=True))
        mixed = np.zeros((SIZE, SIZE))
        for w, (j, i) in zip(weights, around, strict=True):
            out = np.empty((SIZE, SIZE))
            image = task.images[3 * j + i]
            drawn = spans(image.reshape(SIZE, SIZE), None, 0.0)
            draw(Image(image, None, drawn, points[j, i]), None, 0.0, target, 0.0, out)
            mixed += w * out
        total += ((mixed - task.places.targets[cell]) ** 2).sum()
    assert residuals.cost(task.images, task.places, points) == pytest.approx(total, rel=1e-12)
    assert residuals.equations(task.images, task.places, points).cost.sum() == pytest.approx(total, rel=1e-12)


def test_slopes_are_those_of_the_cost(task: registration.Task, points: Any) -> None:
    """By differences over 16 steps of the lattice; neither fetches nor coverage are smooth, so by a few per cent."""
    sums = residuals.equations(task.images, task.places, points)
    members = folds.four_grids(np.arange(points.size).reshape(points.shape)).reshape(-1, 24)
    gradient = solver.scatter(sums.gradient, members, points.size).reshape(points.shape)
    step = 16 / (256 * SIZE)
    largest = np.abs(gradient).max()
    for place in [(1, 1, 2, 1, 0), (1, 1, 2, 2, 1), (0, 1, 2, 1, 0), (2, 2, 3, 2, 1), (1, 0, 1, 1, 1), (0, 0, 2, 1, 1)]:
        ends = []
        for sign in (-1, 1):
            moved = points.copy()
            moved[place] += sign * step
            ends.append(residuals.cost(task.images, task.places, moved) / 2)
        assert gradient[place] == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=0.05, abs=0.02 * largest)
    assert np.allclose(sums.matrix, sums.matrix.swapaxes(1, 2), atol=0)
    assert np.linalg.eigvalsh(sums.matrix).min() > -1e-9 * np.abs(sums.matrix).max()


def test_a_registered_spot_is_where_it_should_be(task: registration.Task, points: Any) -> None:
    before = residuals.cost(task.images, task.places, points)
    begun: list[int] = []
    found = registration.register(points, task, 30, lambda: begun.append(1))
    assert residuals.cost(task.images, task.places, found) < before / 5
    assert 0 < len(begun) <= 30
    assert folds.unfolded(found)


def test_steps_solve_their_equations() -> None:
    random = np.random.RandomState(6)
    members = np.stack([random.permutation(20)[:6] for _ in range(12)])
    roots = random.standard_normal((12, 6, 3))
    matrix = roots @ roots.swapaxes(1, 2)
    ridge, free = random.uniform(0.1, 1.0, 20), np.ones(20)
    free[[3, 11]] = 0.0
    right = random.standard_normal(20)
    dense = np.diag(ridge)
    for element, m in zip(matrix, members, strict=True):
        dense[np.ix_(m, m)] += element
    kept = np.flatnonzero(free)
    expected = np.zeros(20)
    expected[kept] = np.linalg.solve(dense[np.ix_(kept, kept)], right[kept])
    found = solver.solve(solver.Equations(matrix, members, ridge, free), right, 200, 1e-12)
    np.testing.assert_allclose(found, expected, atol=1e-9)
    assert (found[[3, 11]] == 0.0).all()
