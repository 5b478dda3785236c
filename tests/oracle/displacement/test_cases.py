"""The cases of displacement mapping: what they leave open, and that the reference's own frames pass."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases.displacement import CASES
from ibr_ref.oracle.device import PROFILES
from tests.oracle.displacement.drawn import REFEREE, SMALL, case, image, reference, wrong

MOST_UNDECIDED = 0.005
"""Of a case's pixels under its own profile."""


def test_every_kind_and_the_profiles_are_there() -> None:
    cases = [case(name) for name in CASES]
    assert all(name == each.name for name, each in zip(CASES, cases, strict=True))
    assert {each.kind for each in cases} == {"easy", "typical", "adversarial", "real-sized"}
    assert {"ieee32", "vulkan", "gl"} <= {each.profile for each in cases}


@pytest.mark.parametrize("name", CASES)
def test_hardly_a_pixel_is_undecided_and_the_reference_passes(name: str) -> None:
    device = PROFILES[case(name).profile]
    arrays = reference(name)
    judgement = REFEREE.judge_image(case(name), device, image(arrays))
    assert judgement.undecided.mean() <= MOST_UNDECIDED
    assert (arrays["march.hit_index"] >= 0).mean() > 0.015, "hardly anything is drawn"
    assert not wrong([judgement])
    assert not wrong(REFEREE.judge_stages(case(name), device, arrays))


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", SMALL)
def test_the_reference_passes_every_profile(name: str, profile: str) -> None:
    arrays, device = reference(name), PROFILES[profile]
    assert not wrong(REFEREE.judge_stages(case(name), device, arrays))
    assert not wrong([REFEREE.judge_image(case(name), device, {"color": color_bytes(arrays["color"])})])


@pytest.mark.parametrize("name", SMALL)
def test_looser_profiles_accept_no_less(name: str) -> None:
    """Widths grow with the freedom, and so does what is undecided."""
    found = [REFEREE.judge_image(case(name), PROFILES[p], image(reference(name))) for p in ("ieee32", "vulkan", "gl")]
    shown = reference(name)["march.hit_index"] >= 0
    widths = [np.nanmedian(each.width[shown]) for each in found]
    assert widths == sorted(widths)
    assert widths[0] < 8.0 / 255.0
    open_ = [each.undecided.mean() for each in found]
    assert open_ == sorted(open_)
