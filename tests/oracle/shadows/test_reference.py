"""The reference is right by its own judge, its bounds stand on its own values, and the cases leave little open."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.array_types import Floats
from ibr_ref.oracle.accept.bounded import Bounded, exact
from ibr_ref.oracle.cases.shadows import CASES
from ibr_ref.oracle.device import IEEE32, PROFILES
from ibr_ref.oracle.referees.shadows.accumulate import accumulated
from ibr_ref.oracle.referees.shadows.image import Accepted
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from tests.oracle.judgements import complaints, in_bytes, picture
from tests.oracle.shadows.judged import REAL, REFEREE, SMALL, case, image, reference, stages


@pytest.mark.sampled(4)
@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", SMALL)
def test_the_reference_passes_under_every_profile(name: str, profile: str) -> None:
    handed = reference(name)
    warps = case(name).params.method == "warp"
    judged = stages(name, handed, profile)
    assert list(dict.fromkeys(j.stage for j in judged)) == list(REFEREE.stages[0 if warps else 2 :])
    pictures = [image(name, arrays, profile) for arrays in (picture(handed), in_bytes(handed))]
    assert complaints([*judged, *pictures]) == []
    assert complaints(stages(name, handed | in_bytes(handed), profile)[-1:]) == []


@pytest.mark.long
def test_the_reference_passes_in_its_real_size() -> None:
    assert complaints([*stages(REAL, reference(REAL)), image(REAL, picture(reference(REAL)))]) == []


def _value(axis: Bounded) -> Floats:
    return axis.value


def _error(axis: Bounded) -> Floats:
    return np.broadcast_to(axis.error, axis.value.shape)


@pytest.mark.parametrize("name", SMALL)
def test_what_is_recomputed_is_what_the_reference_has(name: str) -> None:
    described, expected = case(name), reference(name)
    made = Inputs(described, IEEE32)
    seen = made.seen
    shown = seen.first
    np.testing.assert_array_equal(shown >= 0, expected["depth"].reshape(-1) < 1.0)
    at, some = np.flatnonzero(shown >= 0), shown[shown >= 0]
    close = {"rtol": 1e-12, "atol": 1e-11}
    np.testing.assert_allclose(seen.depth.value[some], expected["depth"].reshape(-1)[at], **close)
    coords, images = (made.reference(f"{array}") for array in ("project.coord", "warp.image"))
    for i, place in enumerate(map(made.coordinate, range(made.count))):
        mine, off = (np.stack([part(axis)[some] for axis in place.axes], axis=1) for part in (_value, _error))
        theirs = coords[i].reshape(-1, 3)[at]
        # What is clamped, and may or may not reach the limit, has its middle before it.
        apart = np.abs(mine - theirs) - np.where((theirs == 0.0) | (theirs == 1.0), off, 0.0)
        assert (apart <= 1e-10 * (1.0 + np.abs(theirs))).all()
        np.testing.assert_allclose(made.map(i).firm.value, images[i], **close)
    accepted = Accepted.of(made)
    np.testing.assert_array_equal(accepted.outcomes.fragment[: len(seen.pixel)], np.arange(len(seen.pixel)))
    color = np.stack([channel.value[some] for channel in accepted.color], axis=1)
    mine = np.abs(color - expected["color"].reshape(-1, 3)[at]) <= 1e-9
    assert mine.mean() > (0.9 if described.params.accumulation == "unorm8" else 0.9999)


@pytest.mark.parametrize("name", [name for name in SMALL if case(name).params.method == "warp"])
def test_places_and_grids_are_the_reference_s(name: str) -> None:
    made, expected = Inputs(case(name), IEEE32), reference(name)
    positions = made.model.program.positions().value
    np.testing.assert_allclose(positions, expected["maps.positions"], rtol=1e-12)
    for sample in range(made.count):
        (spot,) = made.places(sample)
        cells, fractions = (made.reference(array)[sample] for array in ("warp.cell", "warp.fraction"))
        np.testing.assert_array_equal([place.cell for place in spot], cells)
        np.testing.assert_allclose([place.fraction.value for place in spot], fractions, rtol=1e-12)
        grids = [grid.value for grid in made.row_grids(sample, spot)]
        np.testing.assert_allclose(grids, made.reference("warp.row_grids")[sample], rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(made.grid(sample, spot).value, made.reference("warp.grid")[sample], atol=1e-14)
        rows = [row.value for row in made.rows(sample, spot)]
        np.testing.assert_allclose(rows, made.reference("warp.rows")[sample], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["shadows-soft", "shadows-direct", "shadows-masks"])
def test_sums_are_the_reference_s(name: str) -> None:
    made = Inputs(case(name), IEEE32, reference(name))
    own = made.own("project.shadow")
    assert own is not None
    sums = accumulated(made.model, [exact(shadow, IEEE32) for shadow in own])
    np.testing.assert_allclose(sums.value, reference(name)["accumulate.shadow"], rtol=1e-12)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", CASES)
def test_little_is_undecided(name: str) -> None:
    judged = image(name, picture(reference(name)))
    assert judged.undecided.mean() <= 0.005
    assert np.median(judged.width) < (0.02 if case(name).params.accumulation == "unorm8" else 6e-4)


def test_the_cases_are_of_all_kinds() -> None:
    described = [case(name) for name in CASES]
    assert {c.kind for c in described} == {"easy", "typical", "adversarial", "real-sized"}
    assert {"ieee32", "vulkan", "gl"} <= {c.profile for c in described}
    assert all(c.name == name and c.method == "shadows" for name, c in zip(CASES, described, strict=True))
    sizes = [(c.scene.camera.width, c.scene.camera.height) for c in described if c.kind == "real-sized"]
    assert sizes == [(640, 480)]


def test_parameters_move_the_image() -> None:
    described = case("shadows-soft")
    found = {p.name: p for p in REFEREE.parameters(described)}
    assert {"ambient", "light.position.z", "light.size", "offset.x", "background.b", "camera.eye.x"} <= set(found)
    assert "bias" in {p.name for p in REFEREE.parameters(case("shadows-depths"))}
    for parameter in found.values():
        same = parameter.moved(parameter.value).frame.color
        np.testing.assert_allclose(same, described.frame.color, atol=1e-9, err_msg=parameter.name)
        moved = parameter.moved(parameter.value + parameter.step).frame.color
        assert np.abs(moved - described.frame.color).max() > 1e-5, parameter.name
