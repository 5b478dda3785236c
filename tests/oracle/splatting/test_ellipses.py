"""Ellipses that are averaged: what is wrong with them is found where it is, and named; what may be either way passes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import IEEE32, PROFILES
from ibr_ref.oracle.faults.splatting import MUTANTS, Port
from ibr_ref.oracle.pipeline import blends
from ibr_ref.oracle.referees.moved import with_params
from ibr_ref.oracle.referees.splatting.model import Model
from ibr_ref.oracle.referees.splatting.texels import codes_of
from ibr_ref.oracle.sight import sight
from tests.oracle.judgements import complaints, first_wrong, picture
from tests.oracle.splatting.judged import REFEREE, Arrays, case, drawn, image, reference, stages
from tests.oracle.splatting.test_cause import taken

NAME = "splatting-ellipses"
BOTH = (NAME, "splatting-ovals")


def copied(arrays: Arrays) -> Arrays:
    return {k: v if isinstance(v, tuple) else v.copy() for k, v in arrays.items()}


def covariance(arrays: Arrays) -> None:
    arrays["vertex.covariance"][300, 1] += 1e-2


def amplitude(arrays: Arrays) -> None:
    arrays["vertex.amplitude"][300] -= 1e-3


def distance(arrays: Arrays) -> None:
    arrays["vertex.distance"][300] += 1e-4


def side(arrays: Arrays) -> None:
    arrays["vertex.width"][300] += 1e-2


def weight(arrays: Arrays) -> None:
    arrays["raster.weight"][40, 50] += 1e-3


def number(arrays: Arrays) -> None:
    arrays["raster.blended"][40, 50] -= 1


def background(arrays: Arrays) -> None:
    arrays["raster.weight"][0, 0] = 0.25


def shade(arrays: Arrays) -> None:
    arrays["color"][40, 50, 1] += 1e-4


FAULTS: list[tuple[Callable[[Arrays], None], str, str]] = [
    (covariance, "vertex", "vertex.covariance"),
    (amplitude, "vertex", "vertex.amplitude"),
    (distance, "vertex", "vertex.distance"),
    (side, "vertex", "vertex.width"),
    (weight, "raster", "raster.weight"),
    (number, "raster", "raster.blended"),
    (background, "raster", "raster.weight"),
    (shade, "resolve", "color"),
]


@pytest.mark.parametrize(("fault", "stage", "array"), FAULTS, ids=[fault.__name__ for fault, _, _ in FAULTS])
def test_a_fault_is_found_where_it_is(fault: Callable[[Arrays], None], stage: str, array: str) -> None:
    arrays = copied(drawn(NAME))
    fault(arrays)
    judged = stages(NAME, arrays)
    assert first_wrong(judged) == stage
    found = next(j for j in judged if j.stage == stage)
    assert found.wrong.sum() == 1
    assert {found.arrays[i] for i in found.blame[found.wrong]} == {array}
    at = tuple(np.argwhere(found.wrong)[0].tolist())
    rows = REFEREE.trace(case(NAME), IEEE32, arrays, stage, at)
    assert array in {row.array for row in rows if row.note == "differs"}


@pytest.mark.parametrize("name", BOTH)
def test_every_element_has_a_trace(name: str) -> None:
    arrays, random = drawn(name), np.random.default_rng(4)
    judged = [*stages(name, arrays), image(name, picture(arrays))]
    for stage, size, shape in [(j.stage, j.wrong.size, j.wrong.shape) for j in judged]:
        for place in random.integers(0, size, 20):
            at = tuple(int(i) for i in np.unravel_index(place, shape))
            rows = REFEREE.trace(case(name), IEEE32, arrays, stage, at)
            assert rows
            assert not any(row.note == "differs" for row in rows), (at, rows)


def test_a_pixel_s_trace_has_the_weights() -> None:
    rows = REFEREE.trace(case(NAME), IEEE32, drawn(NAME), "raster", (40, 40))
    weights = [float(row.reference) for row in rows if row.step.endswith("weight, amplitude exp(-q/2)")]
    (total,) = (float(row.reference) for row in rows if row.array == "raster.weight")
    (count,) = (int(row.reference) for row in rows if row.array == "raster.blended")
    assert 1 < len(weights) <= count
    assert sum(weights) <= total * (1.0 + 1e-6)


@pytest.mark.parametrize(
    "kept",
    [
        ("raster.weight",),
        ("raster.blended",),
        ("vertex.covariance", "color"),
        ("vertex.color", "raster.splat", "color"),
        ("vertex.window", "raster.weight", "color"),
        ("vertex.distance",),
        ("atlas.normal", "raster.splat"),
        ("atlas.normal", "color"),
    ],
)
@pytest.mark.parametrize("name", BOTH)
def test_any_subset_can_be_handed_in(kept: tuple[str, ...], name: str) -> None:
    arrays = drawn(name)
    judged = stages(name, {array: arrays[array] for array in kept})
    assert judged
    assert complaints(judged) == []


def test_ellipses_may_have_their_shapes_by_normals_of_the_port_s_own() -> None:
    """Of a code on the edge between two it has the other one: legal, and all that is made of it right."""
    described = case(NAME)
    model = Model(described, IEEE32)
    own = [codes.copy() for codes in described.inputs["normals"]]
    for index, codes in enumerate(own):
        pixels, legal, _ = codes_of(model, index)
        flat = codes.reshape(-1, 3)
        for k, x in enumerate(legal):
            low, high = np.ceil(x.low), np.floor(x.high)
            flat[pixels, k] = np.where(low < high, low + high - flat[pixels, k], flat[pixels, k])
    pages = tuple(np.array(page) for page in drawn(NAME)["atlas.normal"])
    for (page, x, y, width, height), codes in zip(drawn(NAME)["atlas.rects"].tolist(), own, strict=True):
        pages[page][y : y + height, x : x + width] = codes
    mine = Port(described.scene, described.params, Policy(), {"normals": own}).render()
    assert (mine["vertex.covariance"] != drawn(NAME)["vertex.covariance"]).any()
    for arrays in (mine | {"atlas.normal": pages}, drawn(NAME) | {"atlas.normal": pages}):
        assert complaints([*stages(NAME, arrays), image(NAME, arrays)]) == []
    assert first_wrong(stages(NAME, mine | {"atlas.normal": reference(NAME)["atlas.normal"]})) == "vertex"


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", BOTH)
def test_the_referee_sees(name: str, profile: str) -> None:
    found = sight(case(name), PROFILES[profile])
    assert max(found.color_of_picture, found.color_beside_depth, found.color_beside_stages) <= 0.005
    assert max(found.depth_beside_color, found.depth_beside_stages) <= 0.005


def test_what_cannot_be_followed_is_not_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """With no splat of a pixel left open, all that has one is undecided, and no port is accused of it."""
    arrays = drawn(NAME, Policy(subpixel_rounding="down"))
    followed = image(NAME, picture(arrays), "vulkan").undecided.sum()
    monkeypatch.setattr(blends, "MOST_OPEN", 0)
    judged = image(NAME, picture(arrays), "vulkan")
    assert complaints([judged, *stages(NAME, arrays, "vulkan")]) == []
    assert judged.undecided.sum() > followed


def named(arrays: Arrays) -> list[str]:
    judged = REFEREE.judge_stages(case(NAME), IEEE32, arrays, to_first_wrong=True) if len(arrays) > 2 else []
    judged.append(REFEREE.judge_image(case(NAME), IEEE32, arrays))
    found = REFEREE.causes(case(NAME), IEEE32, arrays, next(j for j in judged if j.wrong.any()))
    assert found is not None
    return [cause.name for cause in found.causes]


def broken(name: str) -> Arrays:
    return drawn(NAME, port=next(m.port for m in MUTANTS if m.name == name))


OF_ELLIPSES = [mutant.name for mutant in MUTANTS if mutant.only == ("ellipse",)]


@pytest.mark.sampled(12)
@pytest.mark.parametrize("mutant", OF_ELLIPSES)
def test_the_bug_is_named(mutant: str) -> None:
    assert mutant in named(broken(mutant))


@pytest.mark.long
@pytest.mark.parametrize("mutant", ["ellipse-without-the-divide's-terms", "ellipse-exponent-without-half"])
def test_the_bug_is_named_by_the_picture_alone(mutant: str) -> None:
    assert named(picture(broken(mutant))) == [mutant]


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"footprint": 0.5}, "footprint = 0.5"),
        ({"low_pass": 0.47}, "low_pass looks like 0.47"),
        ({"cutoff": 2.0}, "cutoff = 2"),
        ({"depth_tolerance": 0.01}, "depth_tolerance = 0.01"),
    ],
)
def test_another_number_is_named(changed: dict[str, float], says: str) -> None:
    assert says in named(taken(with_params(case(NAME), **changed)))
