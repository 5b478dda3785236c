"""Searches of which every way is followed: states that come again, and ends."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.arithmetic.ways import MOST_STATES
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.pipeline.machine import Machine


def begun(lanes: int) -> Machine:
    machine = Machine(PROFILES["gl"])
    machine.begin(np.arange(lanes))
    return machine


def number(machine: Machine, value: Any, error: Any, lane: Any) -> Number:
    return Number(machine, np.array(value, np.float64), np.array(error, np.float64), {}, np.array(lane))


def test_a_comparison_that_may_go_either_way_parts_a_state() -> None:
    machine = begun(3)
    may, may_not = machine.parted(number(machine, [-1.0, 0.0, 1.0], [0.5, 0.5, 0.5], [0, 1, 2]) > 0.0)
    assert may.tolist() == [False, True, True]
    assert may_not.tolist() == [True, True, False]
    assert not machine.run.forks


def test_all_whole_numbers_are_told_and_too_many_lose_the_lane() -> None:
    machine = begun(3)
    rows, whole = machine.wholes(number(machine, [1.5, 3.0, 0.0], [0.1, 0.1, 9.0], [0, 1, 2]))
    assert rows.tolist() == [0, 1, 1]
    assert whole.tolist() == [1, 2, 3]
    assert machine.run.lost.tolist() == [False, False, True]


def test_a_state_comes_again_only_if_it_is_wider() -> None:
    machine = begun(2)
    explored = machine.explored()
    rows, x = explored.fresh(np.array([7, 5, 7]), number(machine, [1.0, 2.0, 1.5], [0.0, 0.0, 0.1], [0, 1, 0]))
    assert rows.tolist() == [1, 0]
    assert x.low.tolist() <= [2.0, 1.0]
    assert x.high[1] >= 1.6
    rows, _ = explored.fresh(np.array([7, 5]), number(machine, [1.5, 2.0], [0.1, 0.0], [0, 1]))
    assert not len(rows), "both have been there"
    rows, x = explored.fresh(np.array([5]), number(machine, [3.0], [0.0], [1]))
    assert rows.tolist() == [0]
    assert x.low[0] <= 2.0
    assert x.high[0] >= 3.0


def test_too_many_states_lose_the_lane() -> None:
    machine = begun(2)
    count = MOST_STATES + 1
    keys = np.arange(count + 1)
    lane = np.zeros(count + 1, np.int64)
    lane[-1] = 1
    rows, _ = machine.explored().fresh(keys, number(machine, np.zeros(count + 1), 0.0, lane))
    assert machine.run.lost.tolist() == [True, False]
    assert rows.tolist() == [count]


def test_ends_of_one_kind_that_overlap_are_one_and_others_are_paths() -> None:
    """Two kinds and a gap: three paths of the first search, one of the second, none of the third."""
    machine = begun(3)

    def run(origin: Any) -> dict[str, Any]:
        lane = np.arange(len(origin))
        at = {0: [(1, 0.1), (1, 0.11), (1, 0.9), (0, 0.0)], 1: [(1, 0.5)], 2: []}
        rows, kinds, values = zip(*((i, *end) for i in lane for end in at[int(origin[i])]), strict=True)
        x = number(machine, values, 0.01, lane[list(rows)])
        like = number(machine, np.zeros(len(lane)), 0.0, lane)
        kind, end = machine.one_end(like, np.array(rows), np.array(kinds), x)
        return {"kind": kind, "low": end.low, "high": end.high}

    outcomes, lost = machine.follow(run, 3)
    assert not len(lost)
    found = sorted(zip(outcomes["origin"], outcomes["kind"], outcomes["low"].round(6), strict=True))
    assert [(o, k) for o, k, _ in found] == [(0, 0), (0, 1), (0, 1), (1, 1), (2, -1)]
    one = (outcomes["origin"] == 0) & (outcomes["kind"] == 1) & (outcomes["low"] < 0.5)
    assert outcomes["low"][one] <= 0.09
    assert outcomes["high"][one] >= 0.12 - 1e-12


def test_a_device_goes_one_way() -> None:
    do = Arithmetic(Policy())
    may, may_not = do.parted(np.array([True, False]))
    assert (may ^ may_not).all()
    rows, whole = do.wholes(np.array([1.5, -0.5]))
    assert rows.tolist() == [0, 1]
    assert whole.tolist() == [1, -1]
    kind, end = do.one_end(np.zeros(3), np.array([2, 0]), np.array([1, 0]), np.array([0.5, 0.0]))
    assert kind.tolist() == [0, -1, 1]
    assert end.tolist() == [0.0, 0.0, 0.5]
