"""Where splats lie and how small they are is measured from what plain ports draw, and drivers' faults are told."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.probe import DRIVER_FAULTS
from ibr_ref.oracle.probe.sprites import NEEDED, SMALL, measure, probe_case
from ibr_ref.oracle.programs.splatting.port import Port


@cache
def case() -> Case:
    return probe_case()


class Shifted(Port):
    """As softpipe draws point sprites."""

    def borders(self, center: Any, half: Any) -> tuple[Any, Any]:
        low, high = super().borders(center, half)
        return low + 0.125, high + 0.125


class OnePixel(Port):
    """No sprite is smaller than a pixel."""

    def borders(self, center: Any, half: Any) -> tuple[Any, Any]:
        return super().borders(center, np.maximum(half, 0.5))


def drawn(port: type[Port], policy: Policy) -> dict[str, Any]:
    return port(case().scene, case().params, policy, {}).render()


@pytest.mark.parametrize("bits", [4, 8])
def test_a_right_device_has_no_fault(bits: int) -> None:
    found = measure(case(), drawn(Port, Policy(subpixel_bits=bits)))
    assert ({*found.why}, found.faults) == ({"sprite_offset", "least_sprite"}, {})


def test_sprites_beside_their_points() -> None:
    found = measure(case(), drawn(Shifted, Policy()))
    assert found.faults == {"sprites beside their points": found.why["sprite_offset"]}
    assert found.why["sprite_offset"].startswith("splats lie +0.12")


def test_sprites_of_a_pixel() -> None:
    found = measure(case(), drawn(OnePixel, Policy()))
    assert [*found.faults] == ["sprites one pixel at least"]
    assert {*found.faults} <= {*DRIVER_FAULTS}


@pytest.mark.parametrize(("rounding", "found"), [(0.5, "nearest"), (0.0, "either"), (0.9, "either")])
def test_which_byte_a_colour_is_stored_as(rounding: float, found: str) -> None:
    arrays = drawn(Port, Policy())
    bytes_ = np.floor(255.0 * arrays["color"] + rounding).astype(np.uint8)
    measured = measure(case(), {**arrays, "color": bytes_})
    assert measured.numbers == {"unorm_rounding": found}
    assert "of" in measured.why["unorm_rounding"]


def test_a_picture_of_something_else_says_nothing_of_bytes() -> None:
    arrays = drawn(Port, Policy())
    measured = measure(case(), {**arrays, "color": np.full(arrays["color"].shape, 200, np.uint8)})
    assert not measured.numbers


def test_the_case_has_small_and_large_splats() -> None:
    width = np.asarray(drawn(Port, Policy())["vertex.width"])
    assert (width < SMALL).sum() >= 12
    assert (width > 1.0).sum() >= 24


def test_arrays_that_are_missing_are_named() -> None:
    with pytest.raises(ValueError, match=r"^probe: found 'no vertex\.window', allowed: "):
        measure(case(), {})
    arrays = {name: np.zeros((2, 2)) for name in NEEDED}
    with pytest.raises(ValueError, match=r"^raster\.splat: found .*, allowed: the picture's size"):
        measure(case(), arrays)
