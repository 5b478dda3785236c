"""The reference is right by its own judge, its bounds stand on its own values, and the cases leave little open."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.cases.splatting import CASES
from ibr_ref.oracle.device import IEEE32, PROFILES
from ibr_ref.oracle.pipeline.splats import contest
from ibr_ref.oracle.referees.splatting.model import Model
from ibr_ref.oracle.referees.splatting.texels import codes_of
from tests.oracle.judgements import complaints, in_bytes, picture
from tests.oracle.splatting.judged import REAL, REFEREE, SMALL, case, image, reference, stages


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", SMALL)
def test_the_reference_passes_under_every_profile(name: str, profile: str) -> None:
    handed = reference(name)
    for arrays in (handed, handed | in_bytes(handed)):
        judged = stages(name, arrays, profile)
        assert [j.stage for j in judged] == list(REFEREE.stages)
        assert complaints(judged) == []
    assert complaints([image(name, arrays, profile) for arrays in (picture(handed), in_bytes(handed))]) == []


@pytest.mark.long
def test_the_reference_passes_in_its_real_size() -> None:
    assert complaints([*stages(REAL, reference(REAL)), image(REAL, picture(reference(REAL)))]) == []


@pytest.mark.parametrize("name", SMALL)
def test_what_is_recomputed_is_what_the_reference_has(name: str) -> None:
    described, expected = case(name), reference(name)
    model = Model(described, IEEE32)
    where, kept = model.own_places, expected["vertex.width"] > 0.0
    assert not (kept & ~where.possible).any()
    assert not (where.sure & ~kept).any()
    for bound, array in (
        (where.window[0], expected["vertex.window"][:, 0]),
        (where.window[1], expected["vertex.window"][:, 1]),
        (where.depth, expected["vertex.depth"]),
        (where.width, expected["vertex.width"]),
    ):
        np.testing.assert_allclose(bound.value[kept], array[kept], rtol=1e-12, atol=1e-12)
    color = model.colors(model.own, where.world)[0].color
    exactly = np.abs(color.value - expected["vertex.color"]) <= 1e-12
    # What is clamped within its bound is in the middle of what may be.
    assert (exactly | color.allows(expected["vertex.color"])).all()
    assert exactly.mean() > 0.5


@pytest.mark.parametrize("name", SMALL)
def test_the_reference_s_codes_lie_in_the_intervals_that_it_takes(name: str) -> None:
    model = Model(case(name), IEEE32)
    for number, codes in enumerate(model.given):
        pixel, legal, lost = codes_of(model, number)
        assert not len(lost)
        found = codes.reshape(-1, 3)[pixel]
        fits = np.all([x.allows(found[:, k]) for k, x in enumerate(legal)], axis=0)
        assert np.isin(pixel, pixel[fits]).all()
        assert np.median([x.high - x.low for x in legal]) == 0.0


@pytest.mark.parametrize("name", SMALL)
def test_overdraw_and_winners_are_among_the_possible(name: str) -> None:
    described, expected = case(name), reference(name)
    model = Model(described, IEEE32)
    result = contest(model.program, model.own_places)
    overdraw = expected["raster.overdraw"].reshape(-1)
    assert ((result.least <= overdraw) & (overdraw <= result.most)).all()
    assert (result.least == result.most).mean() > 0.99
    shown = set(zip(result.pixel.tolist(), result.splat.tolist(), strict=True))
    splat = expected["raster.splat"].reshape(-1)
    assert all((pixel, int(splat[pixel])) in shown for pixel in np.flatnonzero(splat >= 0))
    assert result.empty[splat < 0].all()


@pytest.mark.parametrize("name", CASES)
def test_little_is_undecided(name: str) -> None:
    judged = image(name, picture(reference(name)))
    assert judged.undecided.mean() <= 0.005
    assert np.nanmedian(judged.width) < 1e-4


def test_the_cases_are_of_all_kinds() -> None:
    described = [case(name) for name in CASES]
    assert {c.kind for c in described} == {"easy", "typical", "adversarial", "real-sized"}
    assert {"ieee32", "vulkan", "gl"} <= {c.profile for c in described}
    assert all(c.name == name and c.method == "splatting" for name, c in zip(CASES, described, strict=True))
    sizes = [(c.scene.camera.width, c.scene.camera.height) for c in described if c.kind == "real-sized"]
    assert sizes == [(640, 480)]


def test_parameters_move_the_image() -> None:
    described = case("splatting-lamp")
    found = {p.name: p for p in REFEREE.parameters(described)}
    assert {
        "alpha",
        "beta",
        "gamma",
        "delta",
        "light.ambient",
        "light.position.z",
        "background.b",
        "camera.eye.x",
    } <= set(found)
    for name in ("alpha", "light.diffuse", "light.position.x", "background.r", "camera.eye.y"):
        parameter = found[name]
        np.testing.assert_allclose(
            parameter.moved(parameter.value).frame.color, described.frame.color, atol=1e-9, err_msg=name
        )
        moved = parameter.moved(parameter.value + parameter.step).frame
        assert np.abs(moved.color - described.frame.color).max() > 1e-5, name
