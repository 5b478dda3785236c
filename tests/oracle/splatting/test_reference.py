"""The reference is right by its own judge, its bounds stand on its own values, and the cases leave little open."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.cases.splatting import CASES
from ibr_ref.oracle.device import IEEE32, PROFILES
from ibr_ref.oracle.referees.splatting.lighting import shades
from ibr_ref.oracle.referees.splatting.normals import Codes, surface
from ibr_ref.oracle.referees.splatting.place import placed
from ibr_ref.oracle.referees.splatting.splats import contest
from ibr_ref.oracle.referees.splatting.table import normal_codes, table
from tests.oracle.judgements import complaints, in_bytes, picture
from tests.oracle.splatting.judged import REFEREE, SMALL, case, image, reference, stages


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", SMALL)
def test_the_reference_passes_under_every_profile(name: str, profile: str) -> None:
    handed = reference(name)
    for arrays in (handed, handed | in_bytes(handed)):
        judged = stages(name, arrays, profile)
        assert [j.stage for j in judged] == list(REFEREE.stages)
        assert complaints(judged) == []
    assert complaints([image(name, arrays, profile) for arrays in (picture(handed), in_bytes(handed))]) == []


def test_the_reference_passes_in_its_real_size() -> None:
    name = "splatting-kettle"
    assert complaints([*stages(name, reference(name)), image(name, picture(reference(name)))]) == []


@pytest.mark.parametrize("name", SMALL)
def test_what_is_recomputed_is_what_the_reference_has(name: str) -> None:
    described, expected = case(name), reference(name)
    points = table(described, IEEE32)
    where = placed(described, IEEE32, points)
    kept = expected["vertex.width"] > 0.0
    np.testing.assert_array_equal(where.kept, kept)
    for bound, array in (
        (where.x, expected["vertex.window"][:, 0]),
        (where.y, expected["vertex.window"][:, 1]),
        (where.depth, expected["vertex.depth"]),
        (where.width, expected["vertex.width"]),
    ):
        np.testing.assert_allclose(bound.value[kept], array[kept], rtol=1e-12, atol=1e-12)
    colors = shades(described, IEEE32, where.world, points.codes, points.albedo).color
    np.testing.assert_allclose(colors.value, expected["vertex.color"], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", SMALL)
def test_the_reference_s_codes_lie_in_the_intervals_that_it_takes(name: str) -> None:
    for described, codes in zip(case(name).scene.images, normal_codes(case(name)), strict=True):
        legal = Codes(surface(described, IEEE32))
        assert legal.allows(codes.astype(np.float64)).all()
        assert np.nanmedian(legal.width) == 0.0


@pytest.mark.parametrize("name", SMALL)
def test_overdraw_and_winners_are_among_the_possible(name: str) -> None:
    described, expected = case(name), reference(name)
    where = placed(described, IEEE32, table(described, IEEE32))
    camera = described.scene.camera
    result = contest(where, described.params.shape, camera.width, camera.height)
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
