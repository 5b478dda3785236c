"""Faults made by hand in what is handed in: found, in the stage where they are, and in no other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.splatting import MUTANTS, Port
from ibr_ref.oracle.referees.splatting.model import Model
from ibr_ref.oracle.referees.splatting.texels import codes_of
from tests.oracle.judgements import complaints, first_wrong, picture
from tests.oracle.splatting.judged import REFEREE, Arrays, case, drawn, image, reference, stages

LAMP = "splatting-lamp"


def copied(arrays: Arrays) -> Arrays:
    return {k: tuple(p.copy() for p in v) if isinstance(v, tuple) else v.copy() for k, v in arrays.items()}


def normal(arrays: Arrays) -> None:
    arrays["atlas.normal"][0][10, 25, 1] += 2


def rect(arrays: Arrays) -> None:
    arrays["atlas.rects"][1, 3] -= 1


def texel(arrays: Arrays) -> None:
    arrays["atlas.depth"][0][12, 24] *= 1.0 + 1e-6


def beside(arrays: Arrays) -> None:
    arrays["atlas.color"][0][-1, 0, 0] = 0.5


def color(arrays: Arrays) -> None:
    arrays["vertex.color"][700, 2] += 1e-5


def dropped(arrays: Arrays) -> None:
    arrays["vertex.width"][700] = 0.0


def half_dropped(arrays: Arrays) -> None:
    arrays["vertex.window"][700] = np.nan


def window(arrays: Arrays) -> None:
    arrays["vertex.window"][700, 0] += 1e-3


def winner(arrays: Arrays) -> None:
    place = tuple(np.argwhere(arrays["raster.overdraw"] >= 2)[50])
    arrays["raster.splat"][place] += 1


def loser(arrays: Arrays) -> None:
    arrays["raster.depth"][40, 50] += 1e-5


def count(arrays: Arrays) -> None:
    arrays["raster.overdraw"][40, 50] += 1


def nobody(arrays: Arrays) -> None:
    arrays["raster.splat"][40, 50] = 1_000_000


def shade(arrays: Arrays) -> None:
    arrays["color"][40, 50, 1] += 1e-5


def depth(arrays: Arrays) -> None:
    arrays["depth"][40, 50] = 1.0


FAULTS: list[tuple[Callable[[Arrays], None], str, str]] = [
    (normal, "normals", "atlas.normal"),
    (rect, "atlas", "atlas.rects"),
    (texel, "atlas", "atlas.depth"),
    (beside, "atlas", "atlas.color"),
    (color, "vertex", "vertex.color"),
    (dropped, "vertex", "vertex.width"),
    (half_dropped, "vertex", "vertex.window"),
    (window, "vertex", "vertex.window"),
    (winner, "raster", "raster.splat"),
    (loser, "raster", "raster.depth"),
    (count, "raster", "raster.overdraw"),
    (nobody, "raster", "raster.splat"),
    (shade, "resolve", "color"),
    (depth, "resolve", "depth"),
]


@pytest.mark.parametrize(("fault", "stage", "array"), FAULTS, ids=[fault.__name__ for fault, _, _ in FAULTS])
def test_a_fault_is_found_where_it_is(fault: Callable[[Arrays], None], stage: str, array: str) -> None:
    arrays = copied(drawn(LAMP))
    assert complaints(stages(LAMP, arrays)) == []
    fault(arrays)
    judged = stages(LAMP, arrays)
    assert first_wrong(judged) == stage
    found = next(j for j in judged if j.stage == stage)
    if stage != "atlas":
        assert found.wrong.sum() == 1
    assert {found.arrays[i] for i in found.blame[found.wrong]} == {array}
    at = tuple(np.argwhere(found.wrong)[0].tolist())
    rows = REFEREE.trace(case(LAMP), PROFILES["ieee32"], arrays, stage, at)
    assert len(rows) >= 4
    if array not in ("color", "depth"):
        assert any(row.note == "differs" for row in rows), rows


@pytest.mark.parametrize("stage", [*REFEREE.stages, "image"])
def test_every_stage_has_a_trace_for_every_kind_of_element(stage: str) -> None:
    arrays = drawn("splatting-among")
    device = PROFILES["ieee32"]
    described = case("splatting-among")
    if stage == "image":
        judged = REFEREE.judge_image(described, device, picture(arrays))
    else:
        judged = next(j for j in stages("splatting-among", arrays) if j.stage == stage)
    for place in np.random.default_rng(3).integers(0, judged.wrong.size, 40):
        at = tuple(int(i) for i in np.unravel_index(place, judged.wrong.shape))
        rows = REFEREE.trace(described, device, arrays, stage, at)
        assert rows
        assert all(isinstance(row.reference, str) and isinstance(row.port, str) for row in rows)
        assert not any(row.note == "differs" for row in rows), (at, rows)


@pytest.mark.parametrize("name", ["color", "depth", "vertex.window", "vertex.color", "vertex.depth", "raster.depth"])
def test_nan_is_wrong(name: str) -> None:
    arrays = copied(reference(LAMP))
    arrays[name][...] = np.nan
    assert any(j.wrong.any() for j in stages(LAMP, arrays))
    if name in ("color", "depth"):
        assert image(LAMP, {name: arrays[name]}).wrong.all()


@pytest.mark.parametrize("kept", [("color",), ("depth",), ("raster.splat", "color"), ("vertex.color", "color"),
                                  ("raster.depth",), ("raster.overdraw",), ("vertex.window", "raster.splat"),
                                  ("vertex.window", "vertex.depth", "vertex.width", "color"), ("vertex.source",),
                                  ("atlas.depth", "vertex.window"), ("atlas.normal",)])  # fmt: skip
def test_any_subset_can_be_handed_in(kept: tuple[str, ...]) -> None:
    for name in ("splatting-lamp", "splatting-shelves", "splatting-discs"):
        arrays = drawn(name)
        judged = stages(name, {array: arrays[array] for array in kept})
        assert judged
        assert complaints(judged) == []


@pytest.mark.parametrize("profile", PROFILES)
def test_neighbours_of_one_depth_tie_on_every_device(profile: str) -> None:
    """Their distances are made of the same numbers: whoever takes the left one is wrong under the loosest profile too."""
    (mutant,) = (m for m in MUTANTS if m.name == "ties-to-the-left")
    judged = stages("splatting-terraces", drawn("splatting-terraces", port=mutant.port), profile)
    assert first_wrong(judged) == "normals"


def test_a_port_may_light_with_normals_of_its_own() -> None:
    """Of a code on the edge between two it has the other one: legal, and its points and its picture are right with it."""
    described = case(LAMP)
    model = Model(described, PROFILES["ieee32"])
    own = [codes.copy() for codes in described.inputs["normals"]]
    for number, codes in enumerate(own):
        pixels, legal, _ = codes_of(model, number)
        flat = codes.reshape(-1, 3)
        for k, x in enumerate(legal):
            low, high = np.ceil(x.low), np.floor(x.high)
            flat[pixels, k] = np.where(low < high, low + high - flat[pixels, k], flat[pixels, k])
    page, rects = copied(drawn(LAMP))["atlas.normal"], drawn(LAMP)["atlas.rects"]
    for (number, x, y, width, height), codes in zip(rects.tolist(), own, strict=True):
        page[number][y : y + height, x : x + width] = codes
    arrays = Port(described.scene, described.params, Policy(), {"normals": own}).render() | {"atlas.normal": page}
    assert complaints([*stages(LAMP, arrays), REFEREE.judge_image(described, PROFILES["ieee32"], arrays)]) == []


def test_other_kinds_of_numbers_are_the_same_numbers() -> None:
    arrays = drawn(LAMP)
    changed = {
        k: v.astype(np.float32 if v.dtype.kind == "f" else np.int64)
        for k, v in arrays.items()
        if isinstance(v, np.ndarray)
    }
    assert complaints(stages(LAMP, changed)) == []


def test_what_was_wrong_before_does_not_smear() -> None:
    """A port whose points all lie a pixel to the right is wrong in its vertex stage alone."""
    arrays = copied(drawn(LAMP))
    arrays["vertex.window"][:, 0] += 1.0
    for name in ("raster.splat", "raster.depth", "raster.overdraw"):
        arrays[name] = np.roll(arrays[name], 1, axis=1)[:, 1:]
        arrays[name] = np.pad(arrays[name], ((0, 0), (1, 0)), constant_values=arrays[name][0, 0])
    judged = {j.stage: j for j in stages(LAMP, {k: v for k, v in arrays.items() if k not in ("color", "depth")})}
    assert judged["vertex"].wrong.all()
    assert judged["raster"].wrong[:, 4:].sum() == 0
