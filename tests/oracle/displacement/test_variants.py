"""No legal port is accused, in any stage or by its picture alone.

Each variant on one case, each case by several of them; `ibr-ref check --self-test` tries all on all.
"""

from __future__ import annotations

from itertools import cycle
from typing import Any

import numpy as np
import pytest

from ibr_ref.array_types import Ints
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.kinds import Variant
from ibr_ref.oracle.programs.displacement.port import Port
from ibr_ref.oracle.programs.displacement.variants import VARIANTS
from tests.oracle.devices import random_policy
from tests.oracle.displacement.drawn import REFEREE, SMALL, case, draw, image, profiles_from, wrong

SUNKEN = ("displacement-cone", "displacement-relaxed", "displacement-distance")
"""Long searches: each verdict by a coarse device takes as long as those of ten other cases."""

PAIRS = [
    (variant, "displacement-box" if "," in variant.profile and name in SUNKEN else name)
    for variant, name in zip(VARIANTS, cycle(SMALL), strict=False)
]


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("variant", "name"), PAIRS, ids=lambda each: getattr(each, "name", each))
def test_variants_pass(variant: Variant, name: str) -> None:
    """With their tightest profile stage by stage, and by their pictures; every third by the loosest's as well."""
    arrays = draw(name, variant.policy, variant.port)
    found = wrong(REFEREE.judge_stages(case(name), device_of(variant.profile), arrays))
    profile, *numbers = variant.profile.split(",")
    loosest = profiles_from(profile)[-1] if VARIANTS.index(variant) % 3 == 0 else profile
    for each in {profile, loosest}:
        found += wrong([REFEREE.judge_image(case(name), device_of(",".join([each, *numbers])), image(arrays))])
    assert not found


class _SameLevel(Port):
    """A walk through a quadtree that goes on at the level of the node that it leaves."""

    def levels_up(self) -> int:
        return 0


class _NoJumps(Port):
    """One that never moves the ray down to the highest point of a node."""

    def go_down(self, states: Any, node: Any, some: Ints) -> tuple[Any, list[Any]]:
        lower = states.some(some)
        return lower.at(lower.depth, lower.level - 1), []


@pytest.mark.parametrize("port", [_SameLevel, _NoJumps])
def test_other_ways_through_a_quadtree_pass(port: type[Port]) -> None:
    """They find the same."""
    name = "displacement-quadtree"
    arrays = draw(name, Policy(), port)
    assert not wrong(REFEREE.judge_stages(case(name), PROFILES["ieee32"], arrays))
    assert not wrong([REFEREE.judge_image(case(name), PROFILES["gl"], image(arrays))])


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("seed", "name"), list(enumerate(SMALL)))
def test_random_devices_escape_no_accepted_set(seed: int, name: str) -> None:
    """By the picture, and, each other case, stage by stage."""
    policy, profile = random_policy(np.random.default_rng(seed))
    arrays = draw(name, policy)
    found = wrong([REFEREE.judge_image(case(name), PROFILES[profile], image(arrays))])
    if seed % 2:
        found += wrong(REFEREE.judge_stages(case(name), PROFILES[profile], arrays))
    assert not found, policy
