"""No legal port is accused, by any case, in any stage or by its picture alone."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.ports.arithmetic import Policy
from ibr_ref.oracle.ports.displacement.variants import VARIANTS
from tests.oracle.displacement.drawn import REFEREE, SMALL, case, draw, image, profiles_from, wrong

PICTURES = 7
"""Random policies a case: with 15 cases of 9,408 pixels about 10^6 pairs of a policy and a pixel."""


@pytest.mark.parametrize("name", SMALL)
def test_variants_pass(name: str) -> None:
    """With their tightest profile stage by stage; their pictures by the loosest as well."""
    accused = {}
    for variant in VARIANTS:
        arrays = draw(name, variant.policy, variant.port)
        found = wrong(REFEREE.judge_stages(case(name), PROFILES[variant.profile], arrays))
        for profile in {variant.profile, profiles_from(variant.profile)[-1]}:
            found += wrong([REFEREE.judge_image(case(name), PROFILES[profile], image(arrays))])
        if found:
            accused[variant.name] = found
    assert not accused


def random_policy(random: np.random.Generator) -> tuple[Policy, str]:
    """Any device, and the tightest profile that allows it (the kinds of `arithmetic.Policy`, by device.py's numbers)."""
    profile = str(random.choice(["ieee32", "vulkan", "gl"]))
    loose, loosest = profile != "ieee32", profile == "gl"
    return Policy(
        backwards=bool(random.integers(2)),
        fused=bool(random.integers(2)),
        reciprocal=loose and bool(random.integers(2)),
        jitter=int(random.integers(3)) if loosest else 0,
        seed=int(random.integers(1 << 16)),
        weight_bits=8 if loose and random.integers(2) else None,
        weight_rounding=str(random.choice(["nearest", "down"])),
        subpixel_rounding=str(random.choice(["even", "up", "down"])) if loose else "even",
        snapped_varyings=not (loosest and random.integers(2)),
        depth_bits=24 if loose and random.integers(2) else None,
        color_bits=8 if random.integers(2) else None,
    ), profile


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
