"""No legal port is accused, by any case, in any stage or by its picture alone."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.programs.displacement.variants import VARIANTS
from tests.oracle.devices import random_policy
from tests.oracle.displacement.drawn import REFEREE, SMALL, case, draw, image, profiles_from, wrong

PICTURES = 7
"""Random policies a case: with 15 cases of 9,408 pixels about 10^6 pairs of a policy and a pixel."""


@pytest.mark.parametrize("name", SMALL)
def test_variants_pass(name: str) -> None:
    """With their tightest device stage by stage; their pictures by the loosest profile as well."""
    accused = {}
    for variant in VARIANTS:
        arrays = draw(name, variant.policy, variant.port)
        found = wrong(REFEREE.judge_stages(case(name), device_of(variant.profile), arrays))
        profile, *numbers = variant.profile.split(",")
        for device in {variant.profile, ",".join([profiles_from(profile)[-1], *numbers])}:
            found += wrong([REFEREE.judge_image(case(name), device_of(device), image(arrays))])
        if found:
            accused[variant.name] = found
    assert not accused


def test_no_pixel_of_a_million_escapes_its_accepted_set() -> None:
    random = np.random.default_rng(17)
    pairs, escaped = 0, []
    for name in SMALL:
        for _ in range(PICTURES):
            policy, profile = random_policy(random)
            arrays = draw(name, policy)
            found = wrong([REFEREE.judge_image(case(name), PROFILES[profile], image(arrays))])
            escaped += [(name, policy, *each) for each in found]
            pairs += arrays["depth"].size
    assert not escaped
    assert pairs >= 1_000_000


def test_random_devices_pass_stage_by_stage() -> None:
    random = np.random.default_rng(21)
    for name in SMALL:
        for _ in range(3):
            policy, profile = random_policy(random)
            judged = REFEREE.judge_stages(case(name), PROFILES[profile], draw(name, policy))
            assert not wrong(judged), (name, policy)
