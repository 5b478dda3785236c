"""Numbers are found from results: smooth ones, bounds that they jump at, and none where it is another fault."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.referees.fitted import fitted, fitted_vector

X = np.linspace(0.1, 3.0, 97)
SLACK = np.full(97, 1e-6)


def power(value: float) -> np.ndarray | None:
    """Nothing below 0."""
    return X**value if value >= 0.0 else None


def beyond(value: float) -> np.ndarray | None:
    return np.where(value < X, 1.0, 0.0)


@pytest.mark.parametrize(("start", "value"), [(2.0, 2.17), (2.0, 0.4), (0.0, 1.3)])
def test_a_smooth_one(start: float, value: float) -> None:
    noise = np.random.default_rng(1).uniform(-1e-7, 1e-7, 97)
    found = fitted(start, X**start, power, X**value + noise, SLACK, jumps=False)
    assert value in found
    assert found[0] == float(f"{value:.1g}")


@pytest.mark.parametrize(("start", "value"), [(1.0, 1.52), (1.0, 0.31), (1.5, 2.8)])
def test_a_bound(start: float, value: float) -> None:
    target = np.where(value < X, 1.0, 0.0)
    found = fitted(start, beyond(start), beyond, target, SLACK, jumps=True)
    assert any(np.array_equal(beyond(x), target) for x in found)


@pytest.mark.parametrize("jumps", [False, True])
def test_another_fault(jumps: bool) -> None:
    target = np.random.default_rng(2).uniform(0.0, 1.0, 97)
    draw = beyond if jumps else power
    assert fitted(1.0, draw(1.0), draw, target, SLACK, jumps=jumps) == []


def test_results_of_another_number() -> None:
    assert fitted(1.0, X, power, np.zeros(5), np.zeros(5), jumps=False) == []


def towards(place: np.ndarray) -> np.ndarray:
    """Cosines on a floor, as from a lamp."""
    at = np.stack([X, X[::-1] ** 2, 0.3 * np.sin(5.0 * X)], axis=1)
    way = place - at
    return way[:, 2] / np.linalg.norm(way, axis=1)


@pytest.mark.parametrize("place", [(1.2, -0.5, 2.0), (0.7, 0.25, 3.1)])
def test_a_vector_is_found(place: tuple[float, float, float]) -> None:
    noise = np.random.default_rng(1).uniform(-1e-7, 1e-7, 97)
    found = fitted_vector(np.array([1.0, 0.0, 2.0]), towards, towards(np.array(place)) + noise, SLACK)
    assert any(np.array_equal(each, place) for each in found)


def test_no_vector_explains_another_fault() -> None:
    target = np.random.default_rng(2).uniform(0.0, 1.0, 97)
    assert fitted_vector(np.array([1.0, 0.0, 2.0]), towards, target, SLACK) == []


@pytest.mark.parametrize("value", [np.nan, np.inf, -1e300])
def test_no_vector_explains_what_is_no_number(value: float) -> None:
    """A warning of a mean of nothing once."""
    with np.errstate(all="ignore"):
        assert fitted_vector(np.array([1.0, 0.0, 2.0]), towards, np.full(97, value), SLACK) == []
