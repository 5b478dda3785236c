"""The referee on ports: no legal one is accused, hardly a bug gets away, and the stage that it is in is named."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.kinds import Mutant, Variant
from ibr_ref.oracle.faults.shadows import MUTANTS, VARIANTS, Port
from ibr_ref.oracle.self_test import port_output
from ibr_ref.oracle.trials import judge
from tests.oracle.devices import random_policy
from tests.oracle.judgements import complaints, first_wrong, in_bytes, picture, pictures
from tests.oracle.shadows.judged import REAL, SMALL, case, drawn, image, plain, stages

SURVIVORS = 0.05
"""Of the bugs, the most that may get away when stages are handed in; and the most that may be blamed on another stage."""
HIDDEN = 0.15
"""Of the bugs that a picture can show, the most that may get away by the final image alone."""


PAIRS = [(name, v) for i, v in enumerate(VARIANTS) for j, name in enumerate(SMALL) if (i + j) % 6 == 0]
"""Each variant on every sixth case, each case by every sixth variant; `ibr-ref check --self-test` tries all on all."""


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("name", "variant"), PAIRS, ids=lambda each: getattr(each, "name", each))
def test_no_legal_variant_is_accused(name: str, variant: Variant) -> None:
    arrays = drawn(name, variant.policy, variant.port or Port)
    alone = [image(name, handed, variant.profile) for handed in pictures(arrays, variant)]
    assert complaints([*stages(name, arrays, variant.profile), *alone]) == []


@pytest.mark.long
def test_no_legal_variant_is_accused_in_real_size() -> None:
    arrays = drawn(REAL)
    assert complaints([*stages(REAL, arrays, "ieee32"), image(REAL, picture(arrays), "ieee32")]) == []


@cache
def verdicts() -> dict[str, tuple[str | None, bool]]:
    """By mutant the first wrong stage in the first case that shows one, and whether some case's image alone shows it."""
    found: dict[str, tuple[str | None, bool]] = {mutant.name: (None, False) for mutant in MUTANTS}
    for name in SMALL:
        for mutant in (each for each in MUTANTS if each.applies(case(name).system)):
            stage, seen = found[mutant.name]
            if stage is None or not (seen or mutant.hidden):
                found[mutant.name] = _verdict(mutant, name, stage, seen)
    return found


def _verdict(mutant: Mutant, name: str, stage: str | None, seen: bool) -> tuple[str | None, bool]:
    arrays = drawn(name, port=mutant.port)
    changed = {a for a, v in arrays.items() if not np.array_equal(v, plain(name)[a], equal_nan=True)}
    if changed and stage is None:
        stage = first_wrong(stages(name, arrays, "ieee32"))
    if "color" in changed and not seen:
        seen = bool(image(name, in_bytes(arrays), "ieee32").wrong.any())
    return stage, seen


@pytest.mark.sampled(8)
@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: m.name)
def test_a_bug_that_should_be_killed_is(mutant: Mutant) -> None:
    stage, _ = verdicts()[mutant.name]
    assert mutant.survives or stage == mutant.stage


def test_nearly_all_bugs_are_killed_and_named() -> None:
    found = verdicts()
    survivors = [m.name for m in MUTANTS if found[m.name][0] is None]
    misnamed = [m.name for m in MUTANTS if found[m.name][0] not in (None, m.stage)]
    shown = [m for m in MUTANTS if not m.hidden]
    unseen = [m.name for m in shown if not found[m.name][1]]
    assert len(survivors) <= SURVIVORS * len(MUTANTS), survivors
    assert len(misnamed) <= SURVIVORS * len(MUTANTS), misnamed
    assert len(unseen) <= HIDDEN * len(shown), unseen


@pytest.mark.long
def test_a_million_pixels_of_random_devices_are_all_accepted() -> None:
    random = np.random.default_rng(20)
    pixels, widths = 0, []
    for profile, share in (("ieee32", 2), ("vulkan", 4), ("gl", 4)):
        for name in SMALL:
            for _ in range(share):
                policy, _ = random_policy(random, profile)
                judged = image(name, picture(drawn(name, policy)), profile)
                assert complaints([judged]) == [], (name, policy)
                widths.append(np.median(judged.width))
                pixels += judged.wrong.size
    assert pixels >= 1_000_000
    assert np.median(widths) < 1e-3, "the accepted sets are too wide to say anything"


@pytest.mark.long
def test_random_devices_pass_stage_by_stage() -> None:
    random = np.random.default_rng(21)
    for name in SMALL:
        for _ in range(3):
            policy, profile = random_policy(random)
            assert complaints(stages(name, drawn(name, policy), profile)) == [], (name, policy)


@pytest.mark.parametrize("device", PROFILES)
def test_the_nine_maps_are_the_centre_s_whichever_sample_comes_first(device: str) -> None:
    """Samples that the case lists itself, the centre last."""
    given = case("shadows-soft")
    light = given.scene.light
    corners = [[-2 / 3, -2 / 3], [2 / 3, -2 / 3], [-2 / 3, 2 / 3], [2 / 3, 2 / 3], [0, 0]]
    listed = light.arrays[0] + np.asarray(corners) @ light.arrays[1]
    own = replace(given, params=replace(given.params, light_samples=listed))
    policy, _ = random_policy(np.random.default_rng(5), device)
    arrays = port_output(own, Port, Variant("listed", policy, device))
    assert complaints(judge(own, arrays, PROFILES[device])) == []


def test_counts_that_are_handed_on_are_quotients() -> None:
    """The nearest map of a grid as it is: its texels are counts over k^2, divided by a device that is off by 2 ULP."""
    given = case("shadows-many")
    near = replace(given, params=replace(given.params, grid_mix=False, map_samples=1))
    arrays = port_output(near, Port, Variant("near", Policy(jitter=2, seed=4), "gl"))
    assert complaints(judge(near, arrays, PROFILES["gl"])) == []


def test_a_looser_device_forgives_more() -> None:
    arrays = drawn("shadows-box", Policy(subpixel_rounding="down", weight_bits=8))
    assert image("shadows-box", picture(arrays), "ieee32").wrong.any()
    assert not image("shadows-box", picture(arrays), "vulkan").wrong.any()
