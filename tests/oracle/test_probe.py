"""Devices are measured as what they are, number by number, by what plain ports draw in their arithmetic."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.declaration import NUMBERS, Declaration
from ibr_ref.oracle.probe.polygons import NEEDED, measure, probe_case
from ibr_ref.oracle.programs.displacement.port import Port


@cache
def case() -> Case:
    return probe_case()


def drawn(policy: Policy) -> dict[str, Any]:
    return Port(case().scene, case().params, policy, {}).render()


@pytest.mark.parametrize(
    ("policy", "expected"),
    [
        (Policy(), {"subpixel_bits": 8, "varyings": "snapped", "texel_weight_bits": 0, "filter_result": "float"}),
        (
            Policy(
                subpixel_bits=4,
                subpixel_rounding="down",
                snapped_varyings=False,
                weight_bits=8,
                filtered_bytes=True,
                depth_bits=24,
            ),
            {"subpixel_bits": 4, "varyings": "unsnapped", "texel_weight_bits": 8, "filter_result": "unorm8"},
        ),
    ],
)
def test_a_device_is_measured(policy: Policy, expected: dict[str, Any]) -> None:
    found = measure(case(), drawn(policy))
    assert found.numbers == {**expected, "depth_format": "unorm24" if policy.depth_bits else "float32"}
    assert {*found.why} == {*found.numbers}
    assert {*found.assumed} == {*NUMBERS} - {*found.numbers}
    Declaration("gl", found.numbers)  # it can be declared


def test_what_no_device_does_is_not_measured() -> None:
    """A port with a bug in its fetches and its raster: nothing of them is claimed."""
    arrays = drawn(Policy())
    arrays["shade.albedo"] = arrays["shade.albedo"] * 0.99
    arrays["raster.patch_id"] = np.roll(arrays["raster.patch_id"], 1, axis=1)
    arrays["raster.face"] = np.roll(arrays["raster.face"], 1, axis=1)
    assert not {"subpixel_bits", "texel_weight_bits", "filter_result"} & {*measure(case(), arrays).numbers}


def test_arrays_that_are_missing_are_named() -> None:
    with pytest.raises(ValueError, match=r"^probe: found 'no raster\.face', allowed: raster\.face, "):
        measure(case(), {})
    arrays = {name: np.zeros((2, 2)) for name in NEEDED}
    with pytest.raises(ValueError, match=r"^raster\.face: found .*, allowed: the picture's size"):
        measure(replace(case()), arrays)
