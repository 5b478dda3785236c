"""Compiled operations on whole arrays against the definitions, one element at a time; and what they hold on to."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.bounds import Bounds
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.device import GL, IEEE32
from tests.naive import affine

COUNT = 60


def drawn(do: Bounds, seed: int, names: str, *, everywhere: bool = False) -> Number:
    """Large and small numbers, some exact, with slopes along some symbols."""
    random = np.random.default_rng(seed)
    shape = () if everywhere else (COUNT,)
    value = random.normal(0, 1, shape) * 10.0 ** random.integers(-3, 4, shape)
    error = np.abs(value) * 10.0 ** random.uniform(-9, -2, shape)
    slopes = {name: error * random.normal(0, 1, shape) for name in names}
    return Number(do, value, error, slopes)


def one(x: Number, i: int) -> affine.Affine:
    """An element."""
    row = x.rows if x.rows.ndim == 1 else x.rows[:, i]
    return float(row[0]), float(row[1]), dict(zip(x.names, row[3:].tolist(), strict=True))


def same(found: Number, expected: Callable[[int], affine.Affine]) -> None:
    """But for the last bits of errors, which are sums in another order."""
    for i in range(COUNT):
        mine, other = one(found, i), expected(i)
        assert mine[0] == other[0]
        assert mine[1] == pytest.approx(other[1], rel=1e-14, abs=0.0)
        assert mine[2] == pytest.approx(other[2], rel=1e-14, abs=0.0)
        assert found.deviation[i] == pytest.approx(affine.deviation(other), rel=1e-14, abs=0.0)


@pytest.mark.parametrize("names", [("", ""), ("s", "s"), ("st", "tu"), ("", "u")])
@pytest.mark.parametrize("everywhere", [False, True])
def test_operations_are_the_definitions(names: tuple[str, str], everywhere: bool) -> None:
    do, units = Bounds(GL), GL.operation
    x, y = drawn(do, 1, names[0]), drawn(do, 2, names[1], everywhere=everywhere)
    same(do.add(x, y), lambda i: affine.rounded(affine.plus(one(x, i), one(y, i)), units))
    same(do.subtract(x, y), lambda i: affine.rounded(affine.plus(one(x, i), one(y, i), -1.0), units))
    same(do.multiply(x, y), lambda i: affine.rounded(affine.times(one(x, i), one(y, i)), units))
    same(do.divide(x, y), lambda i: affine.rounded(affine.over(one(x, i), one(y, i)), GL.quotient))
    same(do.alternatives(x, y), lambda i: affine.either(one(x, i), one(y, i)))
    products = [(x, y), (y, x), (x, x)]
    found = do.dot(*zip(*products, strict=True))  # type: ignore[arg-type]
    terms = lambda i: [affine.rounded(affine.times(one(a, i), one(b, i)), units) for a, b in products]  # noqa: E731
    same(found, lambda i: affine.total(terms(i), units))


@pytest.mark.parametrize("operation", ["add", "subtract", "multiply", "divide"])
def test_no_choice_of_symbols_and_errors_leaves_the_result(operation: str) -> None:
    """The exact result of any two numbers that are allowed, rounded to float32, is allowed."""
    do, random = Bounds(IEEE32), np.random.default_rng(3)
    x, y = drawn(do, 4, "st"), drawn(do, 5, "tu")
    found = getattr(do, operation)(x, y)
    exact: dict[str, Any] = {"add": np.add, "subtract": np.subtract, "multiply": np.multiply, "divide": np.divide}
    for _ in range(50):
        signs = dict(zip("stu", random.uniform(-1, 1, (3, COUNT)), strict=True))
        a, b = (
            n.value + n.error * random.uniform(-1, 1, COUNT) + sum(n.slopes[k] * signs[k] for k in n.names)
            for n in (x, y)
        )
        rest = np.float32(exact[operation](a, b)) - found.value - sum(found.slopes[k] * signs[k] for k in found.names)
        assert (np.abs(rest) <= found.error).all()


def test_what_is_exact_stays_exact() -> None:
    do = Bounds(IEEE32)
    x = Number(do, np.float32(np.random.default_rng(6).normal(0, 1, COUNT)))
    assert do.multiply(x, 1.0) is x
    assert do.add(x, 0.0) is x
    assert not do.multiply(x, 0.5).deviation.any()
    assert not do.divide(x, 4.0).deviation.any()
    assert not do.dot([x, x], [0.0, 1.0]).deviation.any()
    assert not do.add(x, -x).value.any()
    assert not do.add(x, -x).deviation.any()


def test_nothing_times_what_has_no_end_may_be_anything() -> None:
    do = Bounds(GL)
    wide = Number(do, np.zeros(2), [np.inf, 0.0], {"s": np.array([0.0, np.inf])})
    assert np.isinf(do.multiply(wide, np.zeros(2)).deviation).all()
    assert np.isinf(do.divide(np.ones(2), wide).deviation).all()


def test_the_same_numbers_in_any_shape() -> None:
    """Columns, views that are not in one piece, and read-only ones."""
    do = Bounds(GL)
    x, y = drawn(do, 7, "s"), drawn(do, 8, "st")
    whole = do.multiply(x, y)
    square = do.multiply(x.reshape(6, 10), y.reshape(6, 10))
    assert (square.reshape(COUNT).rows == whole.rows).all()
    assert (do.multiply(x[::2], y[::2]).rows == whole.rows[:, ::2]).all()
    column = do.multiply(x.reshape(6, 10), y.reshape(6, 10)[:, :1])
    assert (column.rows[:, :, 0] == square.rows[:, :, 0]).all()
    wide = do.in_lanes(y[0], x)
    assert (do.multiply(x, wide).rows == do.multiply(x, y[0]).rows).all()


def test_rows_one_after_the_other_keep_their_runs() -> None:
    do = Bounds(GL)
    parts = [Number(do, np.arange(3.0), 1.0, {}, np.array(lane)) for lane in ([0, 1, 2], [2, 0, 1])]
    both = np.concatenate(parts)  # type: ignore[call-overload]
    assert both.lane.tolist() == [0, 1, 2, 2, 0, 1]
    assert both.value.tolist() == [0.0, 1.0, 2.0, 0.0, 1.0, 2.0]


@pytest.mark.parametrize(
    ("operation", "exact", "low", "high"),
    [("exponential", np.exp, -np.inf, 0.0), ("root", np.sqrt, 0.0, np.inf)],
)
@pytest.mark.parametrize("size", [1e-6, 0.1, 3.0])
def test_curves_keep_what_both_ends_of_a_range_give(
    operation: str, exact: Callable[[Any], Any], low: float, high: float, size: float
) -> None:
    """Near where the range is cut off as near as elsewhere: e^x of x <= 0 had the nearer end's error there."""
    random = np.random.default_rng(int(1.0 / size))
    value = np.clip(random.normal(0.0, 1.0, COUNT), low, high) * 10.0 ** random.integers(-3, 1, COUNT)
    x = Number(Bounds(IEEE32), value, size * random.uniform(0.0, 1.0, COUNT))
    found = getattr(Bounds(IEEE32), operation)(x)
    for at in np.linspace(0.0, 1.0, 21):
        inside = np.clip(x.low + at * (x.high - x.low), low, high)
        assert found.allows(exact(inside)).all(), at
