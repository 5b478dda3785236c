"""The cases of displacement mapping: what they leave open, and that the reference's own frames pass."""

from __future__ import annotations

from itertools import cycle

import numpy as np
import pytest

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.cases.displacement import CASES
from ibr_ref.oracle.device import PROFILES
from tests.oracle.displacement.drawn import REFEREE, SMALL, Arrays, case, image, reference, wrong

MOST_UNDECIDED = 0.005
"""Of a case's pixels under its own profile."""
WALLS = {"displacement-street": 0.01}
"""Looks along walls, whose normals hang on the sign of a difference of heights beside their edges."""


def test_every_kind_and_the_profiles_are_there() -> None:
    cases = [case(name) for name in CASES]
    assert all(name == each.name for name, each in zip(CASES, cases, strict=True))
    assert {each.kind for each in cases} == {"easy", "typical", "adversarial", "real-sized"}
    assert {"ieee32", "vulkan", "gl"} <= {each.profile for each in cases}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", CASES)
def test_hardly_a_pixel_is_undecided_and_the_reference_passes(name: str) -> None:
    device = PROFILES[case(name).profile]
    arrays = reference(name)
    judgement = REFEREE.judge_image(case(name), device, image(arrays))
    assert judgement.undecided.mean() <= WALLS.get(name, MOST_UNDECIDED)
    assert (arrays["march.hit_index"] >= 0).mean() > 0.015, "hardly anything is drawn"
    assert not wrong([judgement])


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("name", "profile"), list(zip(SMALL, cycle(PROFILES), strict=False)))
def test_the_reference_passes_stage_by_stage(name: str, profile: str) -> None:
    """By each profile on several cases; all profiles of all cases are `check --self-test`'s."""
    assert not wrong(REFEREE.judge_stages(case(name), PROFILES[profile], reference(name)))


@pytest.mark.parametrize("name", ["displacement-slope", "displacement-tiles", "displacement-beside"])
def test_looser_profiles_accept_no_less(name: str) -> None:
    """Widths grow with the freedom, and so does what is undecided; bytes of the reference pass all of them."""
    found = [REFEREE.judge_image(case(name), PROFILES[p], in_bytes(name)) for p in ("ieee32", "vulkan", "gl")]
    assert not wrong(found)
    shown = reference(name)["march.hit_index"] >= 0
    widths = [np.nanmedian(each.width[shown]) for each in found]
    assert widths == sorted(widths)
    assert widths[0] < 8.0 / 255.0
    open_ = [each.undecided.mean() for each in found]
    assert open_ == sorted(open_)


def in_bytes(name: str) -> Arrays:
    return {"color": color_bytes(reference(name)["color"])}
