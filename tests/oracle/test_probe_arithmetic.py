"""How precisely a device computes is measured from what plain ports draw in its arithmetic, and explains them elsewhere."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from ibr_ref import oracle
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.declaration import ARITHMETIC, Declaration
from ibr_ref.oracle.findings import Outcome
from ibr_ref.oracle.probe.arithmetic import NEEDED, RUNGS, found_by, measure, probe_case
from ibr_ref.oracle.programs.displacement.port import Port as Displacement
from ibr_ref.oracle.programs.splatting.port import Port

CORRECT = dict.fromkeys(ARITHMETIC, 0.5)


@cache
def case() -> Case:
    return probe_case()


def measured(policy: Policy) -> dict[str, Any]:
    return dict(measure(case(), Port(case().scene, case().params, policy, case().inputs).render()).numbers)


@pytest.mark.parametrize(
    "policy",
    [Policy(), Policy(fused=True), Policy(backwards=True), Policy(fused=True, backwards=True, intrinsic_power=True)],
    ids=["plain", "fused", "backwards", "pow"],
)
def test_correct_roundings_are_measured_as_such(policy: Policy) -> None:
    """In any order, fused or not, and pow as what it is made of."""
    assert measured(policy) == CORRECT


@pytest.mark.parametrize(
    ("policy", "least"),
    [
        (Policy(reciprocal=True), {"operation_ulps": 0.5, "quotient_ulps": 1.0, "root_ulps": 1.0}),
        (Policy(truncated=True), {"operation_ulps": 1.0, "quotient_ulps": 1.0, "root_ulps": 1.0}),
        (Policy(loose=1, seed=3), {"quotient_ulps": 1.5, "root_ulps": 1.5}),
        (Policy(loose=2), {"quotient_ulps": 2.5, "root_ulps": 2.5}),
        (Policy(loose=2, intrinsic_power=True), {"quotient_ulps": 2.5, "root_ulps": 2.5, "power_ulps": 2.5}),
    ],
    ids=["reciprocal", "truncated", "loose-1", "loose-2", "loose-pow"],
)
def test_what_is_less_precise_gets_what_it_needs(policy: Policy, least: dict[str, float]) -> None:
    found = measured(policy)
    assert {*found} == {*ARITHMETIC}
    assert all(found[name] >= ulps for name, ulps in least.items())
    assert max(found.values()) <= 5.5


@pytest.mark.parametrize("jitter", [1, 2])
def test_what_moves_at_random_is_not_measured(jitter: int) -> None:
    """It is assumed, as the profile grants it."""
    assert measured(Policy(jitter=jitter)) == {}


def test_how_much_took_part_is_said() -> None:
    arrays = Port(case().scene, case().params, Policy(), case().inputs).render()
    why = measure(case(), arrays).why
    assert {*why} == {*ARITHMETIC}
    assert all(int(words.split()[0]) >= 1000 for words in why.values())
    assert why["quotient_ulps"].endswith("different quotients, all of them within 0.5 ULP")


def test_a_wrong_port_is_not_measured() -> None:
    arrays = Port(case().scene, case().params, Policy(), case().inputs).render()
    arrays["vertex.width"] = arrays["vertex.width"] * 1.001
    assert measure(case(), arrays).numbers == {}


def test_arrays_that_are_missing_are_named() -> None:
    with pytest.raises(ValueError, match=r"^probe: found 'no vertex\.window', allowed: vertex\.window, "):
        measure(case(), {})
    with pytest.raises(ValueError, match=r"^vertex\.window: found .*, allowed: a row for each point"):
        measure(case(), {name: np.zeros((2, 2)) for name in NEEDED})


def test_roots_are_no_more_precise_than_quotients() -> None:
    """In a unit vector, which has both, the one would hide what the other lacks; rungs are asked for with room."""

    def explains(numbers: Any) -> bool:
        return float(numbers.get("quotient_ulps", 9.0)) >= 1.9

    assert found_by(explains) == {"operation_ulps": 0.5, "quotient_ulps": 2.5, "root_ulps": 2.5, "power_ulps": 0.5}
    assert RUNGS[0] == 0.5


@pytest.mark.parametrize(
    "policy", [Policy(), Policy(reciprocal=True), Policy(truncated=True), Policy(loose=2)], ids=str
)
@pytest.mark.parametrize("name", ["splatting-lamp", "splatting-discs", "splatting-sprites"])
def test_the_measured_device_explains_its_port(name: str, policy: Policy) -> None:
    other = oracle.build(name)
    arrays = Port(other.scene, other.params, policy, other.inputs).render()
    found = oracle.examine(other, arrays, profile=Declaration("gl", measured(policy)), name_causes=False)
    assert found.verdict.outcome is Outcome.PASS


@pytest.mark.parametrize("name", ["displacement-slope", "displacement-lamp"])
def test_unsnapped_varyings_are_explained_as_such(name: str) -> None:
    """And leave less undecided than those that may be either."""
    other, shares = oracle.build(name), {}
    policy = Policy(snapped_varyings=False)
    arrays = Displacement(other.scene, other.params, policy, other.inputs).render()
    for over in ("unsnapped", "either"):
        device = Declaration("gl", {**CORRECT, "varyings": over})
        verdict = oracle.examine(other, arrays, profile=device, name_causes=False).verdict
        assert verdict.outcome is Outcome.PASS
        shares[over] = verdict.undecided_share
    assert shares["unsnapped"] < shares["either"]
    snapped = Displacement(other.scene, other.params, Policy(), other.inputs).render()
    device = Declaration("gl", {**CORRECT, "varyings": "unsnapped"})
    assert oracle.examine(other, snapped, profile=device, name_causes=False).verdict.outcome is Outcome.FAIL
