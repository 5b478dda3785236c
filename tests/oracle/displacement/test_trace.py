"""What a referee says of one element, and the parameters that it names."""

from __future__ import annotations

import gc
from dataclasses import replace
from weakref import ref

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import IEEE32
from ibr_ref.oracle.faults.displacement import MUTANTS
from tests.oracle.displacement.drawn import REFEREE, Arrays, case, draw, reference
from tests.oracle.tiny_cases import TINY

TRACED = tuple(f"displacement-{name}" for name in ("extended", "tiles", "street", "crossing", "borders"))
"""Each way to draw and to search, several polygons."""


def arrays_of(mutant: str, name: str) -> Arrays:
    return draw(name, Policy(), next(m.port for m in MUTANTS if m.name == mutant))


def test_a_wrong_bracket_shows_in_its_comparisons() -> None:
    name = "displacement-slope"
    arrays = arrays_of("bracket a step early", name)
    march = next(j for j in REFEREE.judge_stages(case(name), IEEE32, arrays) if j.stage == "march")
    row, column = np.argwhere(march.wrong)[0]
    rows = REFEREE.trace(case(name), IEEE32, arrays, "march", (int(row), int(column)))
    linear = [r for r in rows if r.step.startswith("linear search")]
    assert linear
    assert all(r.note != "differs" for r in linear)
    assert any(r.note == "differs" for r in rows if r.step.startswith("binary search"))
    # A comparison is certain just where its margin is larger than what rounding can move.
    for r in rows:
        if r.margin is not None and r.note == "certain":
            assert r.bound is not None
            assert r.margin > r.bound


def test_the_reference_differs_nowhere() -> None:
    name = "displacement-slope"
    arrays = reference(name)
    hits = np.argwhere(arrays["march.linear_index"] >= 0)
    for row, column in hits[:: len(hits) // 12]:
        rows = REFEREE.trace(case(name), IEEE32, arrays, "image", (int(row), int(column)))
        assert not [r for r in rows if r.note == "differs"]
        assert {"colour", "shade.albedo", "shade.normal", "lit"} <= {r.step for r in rows}


def test_the_terms_of_a_colour_make_it() -> None:
    """Albedo times brightness and the highlight, of walls with the place on their tile."""
    what = TINY["displacement-hill"]()
    frame = what.frame
    arrays = {name: array for name, array in frame.stages.items() if not name.endswith("margin")}
    for steep in (True, False):
        shown = np.argwhere((frame.stages["march.steep"] == steep) & (frame.stages["march.hit_index"] >= 0))
        row, column = map(int, shown[len(shown) // 2])
        rows = {r.step: r.reference for r in REFEREE.trace(what, IEEE32, arrays, "shade", (row, column))}
        cosine, brightness = float(rows["n . l"]), float(rows["ambient + diffuse max(0, n . l) where lit"])
        light, lit = what.scene.light, bool(frame.stages["shade.lit"][row, column])
        assert brightness == pytest.approx(light.ambient + light.diffuse * max(0.0, cosine) * lit, abs=1e-6)
        highlight = light.specular * max(0.0, float(rows["r . v"])) ** light.exponent * (lit and cosine > 0.0)
        assert float(rows["highlight"]) == pytest.approx(highlight, abs=1e-6)
        color = frame.stages["shade.albedo"][row, column] * brightness + highlight
        assert frame.color[row, column] == pytest.approx(color.clip(0, 1), abs=1e-6)
        assert ("tiles across, and down" in rows) == steep
        assert rows.get("the wall faces along", "u") in ("u", "v")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", TRACED)
def test_every_stage_can_be_traced_everywhere(name: str) -> None:
    arrays = reference(name)
    height, width = arrays["depth"].shape
    for stage in ("raster", "march", "shade", "resolve"):
        for index in ((0, 0), (height // 2, width // 2), (height - 1, width // 3)):
            REFEREE.trace(case(name), IEEE32, arrays, stage, index)
    rows = REFEREE.trace(case(name), IEEE32, arrays, "vertex", (1,))
    assert [r.step for r in rows] == ["vertex.patch[1]", "vertex.clip[1]"]


def test_parameters_move_the_picture() -> None:
    what = case("displacement-slope")
    found = {p.name: p for p in REFEREE.parameters(what)}
    assert {"light.ambient", "light.diffuse", "light.specular", "light.position.z", "height_scale", "eye.x"} <= set(
        found
    )
    for name, parameter in found.items():
        same = parameter.moved(parameter.value)
        assert abs(same.frame.color - what.frame.color).max() < 1e-9, name
        moved = parameter.moved(parameter.value + parameter.step)
        if name not in ("shadow_bias", "steep_threshold"):
            assert abs(moved.frame.color - what.frame.color).max() > 0.0, name


def test_ambient_is_the_derivative_that_it_is() -> None:
    """d colour / d ambient is the albedo, where the colour is not clamped."""
    what = case("displacement-box")
    ambient = next(p for p in REFEREE.parameters(what) if p.name == "light.ambient")
    ahead, behind = (ambient.moved(ambient.value + s * ambient.step).frame.color for s in (1, -1))
    shown = what.frame.stages["march.hit_index"] >= 0
    slope = (ahead - behind)[shown] / (2 * ambient.step)
    assert slope == pytest.approx(what.frame.stages["shade.albedo"][shown], abs=1e-9)


def test_a_vertex_buffer_of_another_length_is_wrong() -> None:
    name = "displacement-box"
    arrays = reference(name)
    for field in ("vertex.clip", "vertex.patch"):
        arrays[field] = arrays[field][:-4]
    vertex, *rest = REFEREE.judge_stages(case(name), IEEE32, arrays)
    assert vertex.stage == "vertex"
    assert vertex.wrong.all()
    assert not any(j.wrong.any() for j in rest)


def test_nan_is_wrong_where_the_reference_has_none() -> None:
    name = "displacement-box"
    arrays = {**reference(name)}
    row, column = np.argwhere(arrays["march.hit_index"] >= 0)[100]
    color = arrays["color"].copy()
    color[row, column, 1] = np.nan
    judgement = REFEREE.judge_image(case(name), IEEE32, {"color": color})
    assert np.argwhere(judgement.wrong).tolist() == [[row, column]]
    hit = arrays["march.hit"].copy()
    hit[row, column] = np.nan
    march = next(
        j for j in REFEREE.judge_stages(case(name), IEEE32, {**arrays, "march.hit": hit}) if j.stage == "march"
    )
    assert np.argwhere(march.wrong).tolist() == [[row, column]]


def test_a_stage_is_judged_with_what_is_handed_in() -> None:
    """Any subset of arrays; what is missing is the reference's."""
    name = "displacement-slope"
    arrays = reference(name)
    for kept in (("march.hit_index",), ("raster.face", "shade.lit"), ("shade.albedo", "color"), ("color",)):
        found = REFEREE.judge_stages(case(name), IEEE32, {k: arrays[k] for k in kept})
        assert {j.stage for j in found} >= {k.partition(".")[0] for k in kept if "." in k}
        assert not any(j.wrong.any() for j in found), kept
    index = arrays["march.hit_index"].copy()
    row, column = np.argwhere(index > 0)[50]
    index[row, column] -= 3
    (march,) = REFEREE.judge_stages(case(name), IEEE32, {"march.hit_index": index})
    assert np.argwhere(march.wrong).tolist() == [[row, column]]


def test_candidates_are_computed_once_a_case_and_device() -> None:
    what = replace(case("displacement-mapped"))
    first = REFEREE.judge_image(what, IEEE32, {"color": what.frame.color})
    assert not first.wrong.any()
    from ibr_ref.oracle.referees.displacement.picture import picture_of

    assert picture_of(what, IEEE32) is picture_of(what, IEEE32)


def test_a_judged_case_is_freed_with_what_was_computed_of_it() -> None:
    what = replace(case("displacement-mapped"))
    assert not REFEREE.judge_image(what, IEEE32, {"color": what.frame.color}).wrong.any()
    gone = ref(what)
    del what
    gc.collect()
    assert gone() is None
