"""The plain port of shadows agrees with the reference, its variants nearly so, and every mutant differs where it says."""

from __future__ import annotations

from collections import Counter
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from ibr_ref import shadows
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.faults.kinds import Mutant, Variant
from ibr_ref.oracle.faults.shadows import MUTANTS, VARIANTS, Port
from ibr_ref.testing import shadows as strategies
from tests import drawn
from tests.oracle.ports.shadows_scenes import CASES, ELSEWHERE, Case, shows

Arrays = dict[str, NDArray[Any]]

DOUBLES, FLOATS = Policy(float_bits=64), Policy()

PROFILES = ("ieee32", "vulkan", "d3d11", "webgpu", "gl")

STAGES = ("maps", "controls", "warp", "depth", "project", "accumulate", "resolve")
"""In the order in which they are judged: a surface that is wrong shows in the depth before anything is projected on it."""

ROUNDING = 2e-6
"""Float32 at values about 1, a few operations long."""

BYTE = 1.0 / 255.0


def stage_of(array: str) -> str:
    return "resolve" if array == "color" else array.split(".")[0]


def reference(case: Case) -> Arrays:
    """What a port is to hand in, as the reference has it."""
    frame = shadows.render(case.scene, case.params, maps=case.maps)
    stages = {name: np.asarray(array) for name, array in frame.stages.items() if "margin" not in name}
    return {**stages, "color": frame.color, "depth": frame.depth}


def port(case: Case, policy: Policy, kind: type[Port] = Port) -> Arrays:
    return kind(case.scene, case.params, policy, case.inputs).render()


@cache
def right(name: str) -> Arrays:
    """The plain port in floats."""
    return port(CASES[name](), FLOATS)


def difference(ours: Arrays, theirs: Arrays) -> dict[str, NDArray[np.float64]]:
    """By array; infinite where shapes or types differ, or one is NaN."""
    result = {}
    for name, array in theirs.items():
        if (ours[name].shape, ours[name].dtype) != (array.shape, array.dtype):
            result[name] = np.full(array.shape, np.inf)
        else:
            result[name] = np.nan_to_num(np.abs(ours[name].astype(np.float64) - array), nan=np.inf)
    return result


def check_exact(case: Case) -> None:
    ours, theirs = port(case, DOUBLES), reference(case)
    assert set(ours) == set(theirs)
    for name, array in theirs.items():
        assert (ours[name].shape, ours[name].dtype) == (array.shape, array.dtype), name
        np.testing.assert_allclose(ours[name], array, rtol=1e-9, atol=1e-9, err_msg=name)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", CASES)
def test_in_doubles_it_is_the_reference(name: str) -> None:
    check_exact(CASES[name]())


@pytest.mark.parametrize("number", range(40))
def test_in_doubles_it_is_the_reference_on_drawn_scenes(number: int) -> None:
    def agree(case: strategies.Drawn) -> None:
        scene, params = case.scene, case.params
        warps = params.method == "warp"
        maps = shadows.prepare(scene, params, controls=case.controls) if warps else None
        check_exact(Case(scene, params, maps))

    drawn.run_scene(number, strategies.drawn(), agree)


DESKTOPS = [variant for variant in VARIANTS if "," not in variant.profile]
"""Not those of a raster 16 times as coarse, or of bytes in place of floats, which are as right and farther away."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("variant", DESKTOPS, ids=lambda variant: variant.name)
def test_a_variant_differs_little(variant: Variant) -> None:
    """A variant is another port, and stays near: but for a few pixels at edges, within a step of 8 bits or two."""
    changed = False
    for name in ("soft", "deep", "direct", "filtered"):
        ours = port(CASES[name](), variant.policy, variant.port or Port)  # type: ignore[arg-type]
        theirs = reference(CASES[name]())
        far = {array: float((d > 2.0 * BYTE).mean()) for array, d in difference(ours, theirs).items()}
        assert max(far.values()) < 0.01, (name, far)
        changed |= any((d > 0.0).any() for d in difference(ours, right(name)).values())
    assert changed == (variant.name not in ("floats", "subpixels up"))  # the latter: only where a position ties


def test_variants_are_listed_as_they_should() -> None:
    assert len(VARIANTS) >= 12
    assert len({variant.name for variant in VARIANTS}) == len(VARIANTS)
    assert {variant.profile.partition(",")[0] for variant in VARIANTS} <= set(PROFILES)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_a_mutant_goes_wrong_where_it_says(mutant: Mutant) -> None:
    """Its stage is the first one that differs from the plain port; it shows in the picture unless it is hidden there."""
    case, scene = shows(mutant.name), ELSEWHERE.get(mutant.name, "soft")
    changes = difference(port(case, FLOATS, mutant.port), right(scene))  # type: ignore[arg-type]
    wrong = {stage_of(name) for name, change in changes.items() if (change > ROUNDING).any()}
    assert min(wrong, key=STAGES.index) == mutant.stage
    picture = changes["color"]
    assert picture.max() > 0.5 * BYTE or mutant.hidden or mutant.small
    if mutant.small:
        hidden = picture.max() <= ROUNDING
        seen = [d for name, d in changes.items() if stage_of(name) == mutant.stage] if hidden else [picture]
        assert all(d.max() < BYTE or (d > ROUNDING).mean() < 0.01 for d in seen)


@pytest.mark.long
@pytest.mark.parametrize("name", ["nearest", "deep", "direct"])
def test_no_mutant_goes_wrong_before_its_stage(name: str) -> None:
    for mutant in MUTANTS:
        changes = difference(port(CASES[name](), FLOATS, mutant.port), right(name))  # type: ignore[arg-type]
        early = [array for array, d in changes.items() if STAGES.index(stage_of(array)) < STAGES.index(mutant.stage)]
        assert not [array for array in early if (changes[array] > ROUNDING).any()], mutant.name


def test_mutants_are_listed_as_they_should() -> None:
    names = [mutant.name for mutant in MUTANTS]
    assert len(names) >= 150
    assert len(set(names)) == len(names)
    assert set(ELSEWHERE) <= set(names)
    assert set(Counter(mutant.stage for mutant in MUTANTS)) == set(STAGES)
    assert 4 * sum(mutant.small for mutant in MUTANTS) >= len(MUTANTS)
    assert [mutant.name for mutant in MUTANTS if mutant.survives] == ["soft-empty-texels-block", "resolve-lequal"]
