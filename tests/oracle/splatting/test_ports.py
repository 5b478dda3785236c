"""The referee on ports: no legal one is accused, hardly a bug gets away, and the stage that it is in is named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import PROFILES, Device
from ibr_ref.oracle.faults.kinds import Mutant, Variant
from ibr_ref.oracle.faults.splatting import MUTANTS, VARIANTS, Port
from ibr_ref.oracle.programs.splatting.variants import OwnNormals
from tests.oracle.devices import random_policy
from tests.oracle.judgements import complaints, first_wrong, picture, pictures
from tests.oracle.splatting.judged import REAL, REFEREE, SMALL, case, drawn, image, plain, reference, stages

TELLING = ("lamp", "shelves", "discs", "among", "terraces", "dust", "ball", "quads", "sprites", "ellipses", "ovals")
"""The small cases, those in which most bugs show first."""

SURVIVORS = 0.05
"""Of the bugs, the most that may get away when stages are handed in."""
HIDDEN = 0.15
"""The most that may get away by the final image alone."""


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda v: v.name)
def test_no_legal_variant_is_accused(variant: Variant, name: str) -> None:
    arrays = drawn(name, variant.policy, variant.port or Port)
    alone = [image(name, handed, variant.profile) for handed in pictures(arrays, variant)]
    assert complaints([*stages(name, arrays, variant.profile), *alone]) == []


@pytest.mark.long
@pytest.mark.parametrize("variant", VARIANTS[:3], ids=lambda v: v.name)
def test_no_legal_variant_is_accused_in_real_size(variant: Variant) -> None:
    arrays = drawn(REAL, variant.policy, variant.port or Port)
    assert complaints([*stages(REAL, arrays, variant.profile), image(REAL, picture(arrays), variant.profile)]) == []


@pytest.mark.parametrize("name", ["splatting-sprites", "splatting-quads", "splatting-dust"])
def test_own_normals_are_handed_in_beside_the_picture(name: str) -> None:
    """They are a code beside the case's here and there; whoever keeps them to himself is judged with the case's."""
    arrays = drawn(name, port=OwnNormals)
    of_the_case = {"atlas.normal": reference(name)["atlas.normal"]}
    assert complaints([image(name, picture(arrays) | {"atlas.normal": arrays["atlas.normal"]})]) == []
    assert image(name, picture(arrays)).wrong.any()
    assert image(name, picture(arrays) | of_the_case).wrong.any(), "lit with others than those handed in"


def test_wrong_normals_explain_no_picture() -> None:
    """Handed in beside a picture that is lit with them."""
    name = "splatting-dust"
    mutants = [m for m in MUTANTS if m.stage == "normals"]
    shown = 0
    for mutant in mutants:
        arrays = drawn(name, port=type("Own", (OwnNormals,), {"preparation": mutant.port.preparation}))  # type: ignore[attr-defined]
        own = {"atlas.normal": arrays["atlas.normal"]}
        if image(name, picture(arrays)).wrong.any() and stages(name, own)[0].wrong.any():
            shown += 1
            assert image(name, picture(arrays) | own).wrong.any(), mutant.name
    assert shown >= 3


def verdict(mutant: Mutant) -> tuple[str | None, bool]:
    """The first wrong stage in the first case that shows one, and whether some case's image alone shows the bug."""
    stage, seen = None, False
    for short in TELLING:
        name = f"splatting-{short}"
        arrays = drawn(name, port=mutant.port)
        differs = {array for array, found in arrays.items() if changed(found, plain(name)[array])}
        if differs and stage is None:
            stage = first_wrong(REFEREE.judge_stages(case(name), own(name), arrays, to_first_wrong=True))
        if differs & {"color", "depth"} and not (seen or mutant.hidden):
            seen = bool(image(name, picture(arrays)).wrong.any())
        if stage is not None and (seen or mutant.hidden):
            break
    return stage, seen


def own(name: str) -> Device:
    """The case's device."""
    return PROFILES[case(name).profile]


def changed(found: Any, right: Any) -> bool:
    """Whether an array, or a page of an atlas, has another number than the plain port's, which is right."""
    pairs = (
        zip(found, right, strict=True) if isinstance(found, tuple) and len(found) == len(right) else [(found, right)]
    )
    return not all(same(a, b) for a, b in pairs)


def same(a: Any, b: Any) -> bool:
    return isinstance(a, np.ndarray) and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")


@pytest.mark.sampled(4)
@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: m.name)
def test_a_bug_that_should_be_killed_is(mutant: Mutant) -> None:
    stage, seen = verdict(mutant)
    assert mutant.survives or stage == mutant.stage
    assert mutant.hidden or seen


def test_few_are_not_found() -> None:
    """All others are, each by a test of its own above."""
    assert sum(bool(mutant.survives) for mutant in MUTANTS) <= SURVIVORS * len(MUTANTS)
    assert sum(bool(mutant.hidden) for mutant in MUTANTS) <= HIDDEN * len(MUTANTS)


def test_a_million_pixels_of_random_devices_are_all_accepted() -> None:
    random = np.random.default_rng(20)
    pixels, accepted_widths = 0, []
    while pixels < 1_000_000:
        name = SMALL[int(random.integers(len(SMALL)))]
        policy, profile = random_policy(random)
        judged = image(name, picture(drawn(name, policy)), profile)
        assert complaints([judged]) == [], (name, policy)
        accepted_widths.append(np.nanmedian(judged.width))
        pixels += judged.wrong.size
    assert np.median(accepted_widths) < 1e-4, "the accepted sets are too wide to say anything"


def test_random_devices_pass_stage_by_stage() -> None:
    random = np.random.default_rng(21)
    for name in SMALL:
        for _ in range(3):
            policy, profile = random_policy(random)
            assert complaints(stages(name, drawn(name, policy), profile)) == [], (name, policy)


def test_a_looser_device_forgives_more() -> None:
    """The reference's picture, each number moved by what a Vulkan device may do to it, is no picture of ieee32."""
    name = "splatting-lamp"
    arrays = drawn(name, Policy(subpixel_rounding="down"))
    assert image(name, picture(arrays), "ieee32").wrong.any()
    assert not image(name, picture(arrays), "vulkan").wrong.any()
    assert case(name).profile == "ieee32"
