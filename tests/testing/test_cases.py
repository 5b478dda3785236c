"""Drawn cases: small, valid, passed by a right port, and shrinking towards the simplest."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, find, given, seed, settings

from ibr_ref import methods, oracle
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.testing import bug_of, cases, drawing
from tests.oracle.devices import random_policy

QUIET = settings(
    database=None, deadline=None, max_examples=25, phases=[Phase.generate], suppress_health_check=list(HealthCheck)
)


def plain(case: Case) -> dict[str, Any]:
    """A right port, in float32."""
    port = methods.named(case.method).plain_port
    assert port is not None
    arrays: dict[str, Any] = port.open().Port(case.scene, case.params, Policy(), case.inputs).render()
    return arrays


@pytest.mark.parametrize("method", methods.names())
def test_a_right_port_is_right_on_them(method: str, one_thread: None) -> None:
    seen: list[Case] = []

    def right(case: Case) -> None:
        seen.append(case)
        assert case.scene.camera.width * case.scene.camera.height <= 256
        assert bug_of(case, drawing(plain), "ieee32") is None

    QUIET(seed(7)(given(cases(method))(right)))()
    shown = [case for case in seen if (case.frame.depth < 1.0).any()]
    assert len(shown) > len(seen) / 4


@pytest.mark.long
@pytest.mark.parametrize("method", methods.names())
def test_random_devices_are_right_on_them(method: str, one_thread: None) -> None:
    """Lights in the polygon's plane, slivers without an area, axes along the view: what no built-in case has."""
    random = np.random.default_rng(3)
    port = methods.named(method).plain_port
    assert port is not None

    def right(case: Case) -> None:
        policy, profile = random_policy(random)
        arrays = port.open().Port(case.scene, case.params, replace(policy, color_bits=None), case.inputs).render()
        assert bug_of(case, drawing(lambda case: arrays), profile) is None, policy

    settings(QUIET, max_examples=40)(seed(3)(given(cases(method))(right)))()


SYSTEMS = [
    (method, system)
    for method in methods.names()
    for system in methods.named(method).judged[1]
    if system != "protruded"
]
"""Those that `cases` draws alone when it is asked to; the protruded search without."""


@pytest.mark.parametrize(("method", "system"), SYSTEMS)
def test_of_one_system(method: str, system: str, one_thread: None) -> None:
    def right(case: Case) -> None:
        assert case.system == system
        assert bug_of(case, drawing(plain), "ieee32") is None

    settings(QUIET, max_examples=3)(seed(5)(given(cases(method, system))(right)))()


@pytest.mark.long
def test_they_shrink_to_a_pixel(one_thread: None) -> None:
    chosen = settings(QUIET, phases=[Phase.generate, Phase.shrink])
    case = find(cases("displacement"), lambda case: bool((case.frame.depth < 1.0).any()), settings=chosen)
    assert (case.scene.camera.width, case.scene.camera.height) == (1, 1)
    (polygon,) = case.scene.polygons
    assert np.shape(polygon.height_map) == (1, 1)
    assert (case.params.linear_steps, case.params.binary_steps, case.params.shadow_steps) == (1, 0, 0)


def test_they_can_be_written_down(tmp_path: Any, one_thread: None) -> None:
    def comes_back(case: Case) -> None:
        oracle.export(case, tmp_path / "case", force=True)
        again = oracle.load_case(tmp_path / "case")
        np.testing.assert_array_equal(again.frame.color, case.frame.color)

    for method in methods.names():
        settings(QUIET, max_examples=4)(seed(1)(given(cases(method))(comes_back)))()


def test_a_method_without_any() -> None:
    with pytest.raises(ValueError, match=r"method: found 'rays', allowed: displacement \| splatting \| shadows"):
        cases("rays")
    with pytest.raises(ValueError, match=r"system: found 'disc', allowed: protruded"):
        cases("displacement", "disc")
