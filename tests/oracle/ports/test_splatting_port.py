"""The plain port of splatting is the reference, its variants stay near, and each mutant is wrong where it says."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from ibr_ref import Light, splatting
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.faults.kinds import Mutant, Variant
from ibr_ref.oracle.faults.splatting import MUTANTS, VARIANTS, Port
from ibr_ref.oracle.programs.splatting import raster
from ibr_ref.testing.splatting import Drawn as Case
from ibr_ref.testing.splatting import drawn as cases
from tests.oracle.ports.splatting_scenes import SCENES
from tests.splatting import golden_scenes

pytestmark = pytest.mark.usefixtures("one_thread")

EXACT = ("terraces", "ties")
"""Scenes whose borders and depths hang on the last bit by design."""

AVERAGED = ("ellipses", "ovals")
"""Where a point shows in many pixels, not in those alone that it wins: what is small elsewhere need not be there."""

Arrays = dict[str, Any]


def handed_over(stages: Arrays) -> dict[str, Any]:
    """What a case hands to ports besides the scene: the reference's normals, one array an image."""
    pages = stages["atlas.normal"]
    return {"normals": [pages[p][y : y + h, x : x + w] for p, x, y, w, h in stages["atlas.rects"].tolist()]}


@cache
def reference(name: str) -> Arrays:
    frame = splatting.render(*scene(name))
    return {**frame.stages, "color": frame.color, "depth": frame.depth}


@cache
def scene(name: str) -> Any:
    return SCENES[name]()


@cache
def plain(name: str, policy: Policy) -> Arrays:
    return port(Port, name, policy)


def port(kind: Any, name: str, policy: Policy) -> Arrays:
    arrays: Arrays = kind(*scene(name), policy, handed_over(reference(name))).render()
    return arrays


def arrays_of(value: Any) -> tuple[np.ndarray, ...]:
    return value if isinstance(value, tuple) else (value,)


def distance(a: Any, b: Any) -> tuple[float, int]:
    """The largest difference of two stages, and of how many elements; infinite where there is nothing to compare with."""
    pairs = list(zip(arrays_of(a), arrays_of(b), strict=False))
    if len(arrays_of(a)) != len(arrays_of(b)) or any(x.shape != y.shape for x, y in pairs):
        return np.inf, 1 << 40
    flat = [np.concatenate([np.ravel(pair[side]).astype(np.float64) for pair in pairs]) for side in (0, 1)]
    difference = np.abs(flat[0] - flat[1])
    difference[np.isnan(flat[0]) & np.isnan(flat[1])] = 0.0
    difference[np.isnan(difference)] = np.inf
    return float(difference.max(initial=0.0)), int((difference > 0.0).sum())


def agree(found: Arrays, expected: Arrays) -> None:
    assert found.keys() == expected.keys() - {"raster.margin"}
    for name, arrays in found.items():
        largest, count = distance(arrays, expected[name])
        kinds = {array.dtype for array in arrays_of(expected[name])}
        assert {array.dtype for array in arrays_of(arrays)} == kinds, name
        assert largest <= 1e-9, name
        assert count == 0 or kinds == {np.dtype(np.float64)}, name


@pytest.mark.parametrize("name", SCENES)
def test_in_float64_it_is_the_reference(name: str) -> None:
    agree(plain(name, Policy(float_bits=64)), reference(name))


@pytest.mark.parametrize("name", golden_scenes.SCENES)
def test_without_normals_to_light_with_it_takes_its_own(name: str) -> None:
    drawn, params = golden_scenes.SCENES[name](60, 40)
    frame = splatting.render(drawn, params)
    found = Port(drawn, params, Policy(float_bits=64), {}).render()
    agree(found, {**frame.stages, "color": frame.color, "depth": frame.depth})


@settings(derandomize=True, deadline=None, max_examples=100)
@given(cases())
def test_adversarial_scenes(case: Case) -> None:
    frame = splatting.render(case.scene, case.params)
    found = Port(case.scene, case.params, Policy(float_bits=64), {}).render()
    agree(found, {**frame.stages, "color": frame.color, "depth": frame.depth})


@settings(derandomize=True, deadline=None, max_examples=60)
@given(cases())
def test_adversarial_ellipses(case: Case) -> None:
    params = splatting.Params(shape="ellipse", max_width=max(case.params.max_width, 4.0))
    frame = splatting.render(case.scene, params)
    found = Port(case.scene, params, Policy(float_bits=64), {}).render()
    agree(found, {**frame.stages, "color": frame.color, "depth": frame.depth})


@pytest.mark.parametrize("name", ["shelves", "terraces"])
def test_splats_drawn_in_batches(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(raster, "BATCH", 37)
    agree(port(Port, name, Policy(float_bits=64)), reference(name))


# Variants


def scenes_of(variant: Variant) -> list[str]:
    """Those that a variant can draw: pow(0, 0) is undefined, and no case has the exponent 0 (oracle/undefined.py)."""
    lights = {name: scene(name)[0].light for name in SCENES}
    return [n for n, light in lights.items() if not (variant.policy.intrinsic_power and light and light.exponent == 0)]


def codes_of(stages: Arrays) -> np.ndarray:
    """(V, 3) the normals of the points."""
    pages, rects = stages["atlas.normal"], stages["atlas.rects"]
    texels = [pages[rects[i, 0]][rects[i, 2] + row, rects[i, 1] + column] for i, row, column in stages["vertex.source"]]
    return np.asarray(texels, np.int64)


def relit(variant: Variant, found: Arrays, expected: Arrays) -> np.ndarray:
    """(V,) points that a variant lights with its own normal where that is another one: a code beside it, and seldom."""
    if "atlas.normal" not in variant.own:
        return np.zeros(len(found["vertex.source"]), np.bool_)
    apart = np.abs(codes_of(found) - codes_of(expected)).max(axis=1)
    assert apart.max() <= 1
    assert (apart > 0).mean() <= 0.002
    return np.asarray(apart > 0)


def of_a_code(light: Light) -> float:
    """The most that a colour moves when a normal's codes move by one.

    They are a vector of about 127, which turns by at most sqrt(3) / 126; the mirrored ray turns by twice that. An angle
    moves n.l by no more than itself, and cos^e by no more than sqrt(e) of itself.
    """
    turn = np.sqrt(3.0) / 126.0
    return float(turn * (light.diffuse + 2.0 * light.specular * np.sqrt(light.exponent)))


DESKTOPS = [variant for variant in VARIANTS if "," not in variant.profile]
"""Not those of a raster 16 times as coarse, or of bytes in place of floats, which are as right and farther away."""


@pytest.mark.parametrize("variant", DESKTOPS, ids=lambda v: v.name)
def test_variants_stay_near(variant: Variant) -> None:
    """Far apart from what a mutant does: a hundred times the rounding of float32; few pixels have another winner."""
    bounds = {"vertex.window": 2e-3, "vertex.depth": 1e-5, "vertex.width": 1e-4, "vertex.color": 1e-4, "color": 1 / 509}
    for name in set(scenes_of(variant)) - set(EXACT):
        found, expected = port(variant.port or Port, name, variant.policy), reference(name)
        same = found["raster.splat"] == expected["raster.splat"]
        assert (~same).mean() <= 0.005
        if name in AVERAGED:
            same &= found["raster.blended"] == expected["raster.blended"]
        others = relit(variant, found, expected)
        same &= ~np.append(others, False)[found["raster.splat"]]  # -1: the background
        bounds["color"] = 1 / 255 if name in AVERAGED else 1 / 509  # where a centre is snapped weights hang on it
        for stage, bound in bounds.items():
            kept = same if stage == "color" else ~others if stage == "vertex.color" else slice(None)
            assert distance(found[stage][kept], expected[stage][kept])[0] <= bound, stage
        if others.any():
            apart, _ = distance(found["vertex.color"][others], expected["vertex.color"][others])
            assert apart <= of_a_code(scene(name)[0].light) + bounds["vertex.color"]


@pytest.mark.parametrize("variant", [v for v in VARIANTS if v.name != "float32"], ids=lambda v: v.name)
def test_variants_are_ports_of_their_own(variant: Variant) -> None:
    """Another policy draws another frame than float32 does; another port another one than the plain port by its policy."""
    beside = variant.policy if variant.port else Policy()
    found = {name: port(variant.port or Port, name, variant.policy) for name in scenes_of(variant)}
    assert any(distance(a, plain(name, beside)[stage])[1] for name in found for stage, a in found[name].items())


def test_bytes_fetched_as_floats_are_the_same_bytes_where_rounding_is_correct() -> None:
    """So the variant that does so computes otherwise, or it would be the plain port."""
    codes = np.arange(256, dtype=np.float32)
    np.testing.assert_array_equal(codes / np.float32(255.0) * np.float32(255.0), codes)


def test_there_are_enough() -> None:
    assert len({variant.name for variant in VARIANTS}) == len(VARIANTS) >= 12
    assert len({mutant.name for mutant in MUTANTS}) == len(MUTANTS) >= 44
    assert 3 * sum(mutant.small for mutant in MUTANTS) >= len(MUTANTS)
    assert {variant.profile.partition(",")[0] for variant in VARIANTS} <= {"ieee32", "vulkan", "d3d11", "webgpu", "gl"}
    assert {mutant.stage for mutant in MUTANTS} == {"normals", "atlas", "vertex", "raster", "resolve"}


# Mutants

STAGE_OF = {"atlas.normal": "normals", "color": "resolve", "depth": "raster"}
"""The arrays that do not bear the name of their stage."""


def beyond_rounding(name: str, array: str, found: Any) -> bool:
    """Whether an array differs from the plain port's by more than float32 differs from float64."""
    largest, count = distance(found, plain(name, Policy())[array])
    error, changes = distance(plain(name, Policy())[array], plain(name, Policy(float_bits=64))[array])
    if arrays_of(found)[0].dtype.kind == "f":
        return largest > 8.0 * error
    return count > 2 * changes


def visible(name: str, found: Arrays) -> float:
    """The share of pixels whose colour changes by more than a byte's step."""
    return float((np.abs(found["color"] - plain(name, Policy())["color"]).max(axis=2) > 1.0 / 255.0).mean())


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: m.name)
def test_mutants_are_wrong_in_their_stage_and_as_small_and_hidden_as_they_say(mutant: Mutant) -> None:
    assert mutant.fault
    found = {name: port(mutant.port, name, Policy()) for name in SCENES}
    shown = False
    for name, arrays in found.items():
        right = plain(name, Policy())
        changed = [array for array in right if distance(arrays[array], right[array])[1]]
        if changed:
            assert STAGE_OF.get(changed[0], changed[0].split(".")[0]) == mutant.stage
            shown |= beyond_rounding(name, changed[0], arrays[changed[0]])
    assert shown
    shares = {name: visible(name, arrays) for name, arrays in found.items()}
    if mutant.hidden:
        # On ties in depth another winner is legal, and so cannot show.
        clear = [name for name in SCENES if name not in EXACT]
        assert max(distance(found[name]["color"], plain(name, Policy())["color"])[0] for name in clear) < 1.0 / 2550.0
    else:
        assert any(beyond_rounding(name, "color", arrays["color"]) for name, arrays in found.items())
    if mutant.small:
        left = [*EXACT, *(() if mutant.only else AVERAGED)]
        assert max(share for name, share in shares.items() if name not in left) < 0.01
    elif not mutant.hidden:
        assert max(shares.values()) >= 0.01
