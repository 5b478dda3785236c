"""Variants are near the reference, and no two are alike; a mutant is wrong in its stage, and as small as it says."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from ibr_ref import displacement
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.faults.displacement import MUTANTS, VARIANTS, Port
from ibr_ref.oracle.faults.kinds import Mutant, Variant
from ibr_ref.oracle.programs.displacement import PROGRAMS
from tests.agreement import Arrays, arrays_of
from tests.oracle.ports.displacement_scenes import SCENES, SHOWN_IN, USUAL, scene_of

STAGES = ("vertex", "raster", "march", "shade", "resolve")
PROFILES = ("ieee32", "vulkan", "d3d11", "webgpu", "gl")

ROUNDING = 1e-6
"""What two ports with the same policy may differ by, absolute and relative, where nothing is wrong."""

STEP = 1.0001 / 255.0


@cache
def plain(scene: str) -> Arrays:
    """The plain port in float32."""
    return Port(*SCENES[scene](), Policy(), {}).render()


@cache
def reference(scene: str) -> Arrays:
    """The reference frame."""
    return arrays_of(displacement.render(*SCENES[scene]()))


def differs(a: NDArray[np.generic], b: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Where two arrays differ by more than rounding; everywhere, if in shape."""
    if a.shape != b.shape:
        return np.ones(1, bool)
    return ~np.isclose(a, b, rtol=ROUNDING, atol=ROUNDING, equal_nan=True) if a.dtype.kind == "f" else a != b


def same_fragment(a: Arrays, b: Arrays) -> NDArray[np.bool_]:
    """The pixels that hold the same face's fragment in both."""
    return (a["raster.face"] == b["raster.face"]) & (a["raster.patch_id"] == b["raster.patch_id"])


def wrong_arrays(right: Arrays, wrong: Arrays) -> set[str]:
    """The arrays that differ, of those of the picture's size where both hold the same fragment."""
    same = same_fragment(right, wrong)
    pairs = {n: (a, wrong[n]) if n.startswith("vertex") else (a[same], wrong[n][same]) for n, a in right.items()}
    return {name for name, pair in pairs.items() if differs(*pair).any()}


def colors_apart(a: Arrays, b: Arrays) -> NDArray[np.float64]:
    """(H, W) the largest difference in a channel."""
    return np.abs(np.asarray(a["color"], np.float64) - b["color"]).max(axis=-1)


# --- All -------------------------------------------------------------------------------------------------------------


def test_there_are_enough_of_them() -> None:
    assert len(VARIANTS) >= 12
    assert len(MUTANTS) >= 44
    assert len({v.name for v in VARIANTS}) == len(VARIANTS)
    assert len({m.name for m in MUTANTS}) == len(MUTANTS)
    everywhere = [m for m in MUTANTS if not m.only]
    assert 3 * sum(m.small for m in everywhere) >= len(everywhere)
    for search in PROGRAMS:
        assert sum(search in m.only for m in MUTANTS) >= 8 or search == "protruded"
    assert {m.stage for m in MUTANTS} == set(STAGES)
    assert all(m.fault.endswith(".") for m in MUTANTS)


def test_scenes_are_told_of_existing_mutants() -> None:
    told = [name for names in SHOWN_IN.values() for name in names]
    assert set(told) <= {m.name for m in MUTANTS}
    assert len(told) == len(set(told))
    assert {scene_of(m.name) for m in MUTANTS} == {USUAL, *SHOWN_IN}


# --- Variants --------------------------------------------------------------------------------------------------------


DESKTOPS = [variant for variant in VARIANTS if "," not in variant.profile]
"""Not those of a raster 16 times as coarse, or of bytes in place of floats, which are as right and farther away."""


@pytest.mark.sampled(4)
@pytest.mark.parametrize("variant", DESKTOPS, ids=lambda variant: variant.name)
def test_variant_is_near_the_reference(variant: Variant, one_thread: None) -> None:
    assert variant.profile in PROFILES
    for scene in (USUAL, "city", "tiles"):
        expected = reference(scene)
        found = (variant.port or Port)(*SCENES[scene](), variant.policy, {}).render()
        assert not set(found) - set(expected)
        assert same_fragment(expected, found).mean() > 0.995
        steps = np.abs(expected["march.hit_index"].astype(np.int64) - found["march.hit_index"])
        assert (steps > 1).mean() < 0.01
        assert (colors_apart(expected, found) > 1.5 * STEP).mean() < 0.04


def test_no_two_variants_are_alike(one_thread: None) -> None:
    alike = {"float32", "subpixel ties up"}  # no corner of the scene lies halfway between two subpixels
    frames = {v.name: (v.port or Port)(*SCENES[USUAL](), v.policy, {}).render() for v in DESKTOPS}
    contents = {name: b"".join(a.tobytes() for a in frame.values()) for name, frame in frames.items()}
    assert len(set(contents.values())) == len(DESKTOPS) - 1
    assert len({contents[name] for name in alike}) == 1


# --- Mutants ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_mutant_is_wrong_in_its_stage_first(mutant: Mutant) -> None:
    scene = scene_of(mutant.name)
    right, wrong = plain(scene), mutant.port(*SCENES[scene](), Policy(), {}).render()
    found = wrong_arrays(right, wrong)
    earlier = STAGES[: STAGES.index(mutant.stage)]
    assert not {name for name in found if name.split(".")[0] in earlier}
    results = {name for name in right if name.startswith(mutant.stage)}
    results |= {"shade": {"color"}, "resolve": {"color", "depth"}}.get(mutant.stage, set())
    other_fragments = mutant.stage in ("raster", "resolve") and not same_fragment(right, wrong).all()
    assert found & results or other_fragments


@pytest.mark.parametrize("mutant", [m for m in MUTANTS if m.small], ids=lambda mutant: mutant.name)
def test_small_mutant_is_small(mutant: Mutant) -> None:
    scene = scene_of(mutant.name)
    wrong = mutant.port(*SCENES[scene](), Policy(), {}).render()
    assert (colors_apart(plain(scene), wrong) > STEP).mean() < 0.01


@pytest.mark.parametrize("mutant", [m for m in MUTANTS if m.hidden], ids=lambda mutant: mutant.name)
def test_hidden_mutant_is_hidden(mutant: Mutant) -> None:
    scene = scene_of(mutant.name)
    wrong = mutant.port(*SCENES[scene](), Policy(), {}).render()
    bytes_right, bytes_wrong = (np.floor(255.0 * np.clip(f["color"], 0.0, 1.0) + 0.5) for f in (plain(scene), wrong))
    # A triangle that is cut elsewhere has other roundings, which turn a search here and there.
    assert (np.abs(bytes_right - bytes_wrong).max(axis=-1) > 1.0).mean() < 1e-3
