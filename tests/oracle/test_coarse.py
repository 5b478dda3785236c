"""Broken ports in the way of right ones on coarse devices."""

from __future__ import annotations

import pytest

from ibr_ref.oracle.cases import build
from ibr_ref.oracle.coarse import _in_the_way_of, _killed
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.faults.splatting.raster import RASTER
from ibr_ref.oracle.programs.splatting.variants import VARIANTS
from ibr_ref.oracle.self_test import plain_port, tried

COARSE = [variant for variant in VARIANTS if variant.coarse]
BUG = next(mutant for mutant in RASTER.mutants if mutant.name == "farthest-wins")


@pytest.mark.parametrize("method", tried())
def test_every_method_has_devices_that_are_coarse(method: str) -> None:
    assert any("subpixel_bits=4" in variant.profile for variant in plain_port(method).VARIANTS if variant.coarse)


@pytest.mark.parametrize("variant", COARSE, ids=lambda variant: variant.name)
def test_a_bug_is_seen_there_and_the_right_port_is_not(variant: object) -> None:
    case, right = build("splatting-ball"), next(v for v in COARSE if v is variant)
    assert _killed(right.port or plain_port("splatting").Port, right, [case], device_of(right.profile)) is None
    broken = _in_the_way_of(BUG, right)
    assert issubclass(broken, BUG.port)
    assert _killed(broken, right, [case], device_of(right.profile)) == "splatting-ball"
