"""A FAIL names the bug: that of the broken port, with what this case does not tell from it, and never another one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.programs.displacement import Port
from ibr_ref.oracle.referees.moved import with_light, with_params
from tests.oracle.displacement.drawn import case, draw, image
from tests.oracle.judgements import named

STAGED = (
    "height scale in half precision",
    "far plane not clipped",
    "no perspective correction",
    "bracket a step early",
    "heights half a texel off",
    "delta on the size of the difference",
    "gradient along the edges",
    "exponent off by one",
    "shadow samples at j/S",
    "colours in BGR",
    "depth as (z + 1)/2",
)
"""One of each kind; all of them are in the note of the naming tables."""
SHOWS = {
    "far plane not clipped": "displacement-planes",
    "delta on the size of the difference": "displacement-tiles",
}
"""The case where they do, of those that displacement-slope does not show."""

PICTURED = (
    "height scale in half precision",
    "window a pixel narrower",
    "first sample left out",
    "one orientation culled",
    "nearest heights",
    "delta on the height of the step",
    "gradient along the edges",
    "specular off by 2 %",
)
"""Of every stage, some that show at few pixels, or by little."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("mutant", STAGED)
def test_the_bug_is_named(mutant: str) -> None:
    name = SHOWS.get(mutant, "displacement-slope")
    port = next(m.port for m in MUTANTS if m.name == mutant)
    assert mutant in named(case(name), draw(name, Policy(), port))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("name", "taken"),
    [
        ("displacement-slope", {"steep_threshold": 0.1}),
        ("displacement-slope", {"linear_steps": 20}),
        ("displacement-slope", {"shadow_steps": 14}),
        ("displacement-occlusion", {"max_steps": 16}),
        ("displacement-distance", {"distance_layers": 24}),
    ],
)
def test_a_right_port_with_another_parameter_is_named_so(name: str, taken: dict[str, Any]) -> None:
    what = case(name)
    arrays = Port(what.scene, replace(what.params, **taken), Policy(), {}).render()
    found = named(case(name), arrays)
    (field, value), *_ = taken.items()
    assert found == [f"{field} = {value}"]


@pytest.mark.parametrize(
    ("name", "value", "other"),
    [
        ("steep_threshold", 0.105, with_params(case("displacement-slope"), steep_threshold=0.105)),
        ("light.diffuse", 1.17, with_light(case("displacement-slope"), diffuse=1.17)),
    ],
)
def test_a_number_that_was_not_guessed_is_found(name: str, value: float, other: Case) -> None:
    """A bound up to where the next pixel jumps."""
    (found,) = named(case("displacement-slope"), Port(other.scene, other.params, Policy(), {}).render())
    told, _, looks_like = found.partition(" looks like ")
    assert (told, float(looks_like)) == (name, pytest.approx(value, rel=0.01))


@pytest.mark.long
def test_two_bugs_of_which_neither_explains_all_are_named_together() -> None:
    name, a, b = "displacement-slope", "ambient off by 2 %", "gradient without 1/2"
    kinds = [next(m.port for m in MUTANTS if m.name == each) for each in (a, b)]
    both = draw(name, Policy(), type("_Both", tuple(kinds), {}))
    assert {f"{a} and {b}", f"{b} and {a}"} & {*named(case(name), both)}


def test_another_place_of_the_light_is_named() -> None:
    """Below the polygon, where all such places are the same."""
    other = with_light(case("displacement-slope"), position=(1.0, 1.5, -1.4))
    found = named(case("displacement-slope"), Port(other.scene, other.params, Policy(), {}).render())
    assert "light.position = (1, 1.5, -1.4)" in found


def test_what_a_bug_and_a_number_explain_is_named_by_both() -> None:
    """Of 25 steps the first 24 are those of "step of 1/(N + 1)"; no ray here hits at the last."""
    name = "displacement-relief"
    other = with_params(case(name), linear_steps=25)
    arrays = Port(other.scene, other.params, Policy(), {}).render()
    assert named(case(name), arrays) == ["step of 1/(N + 1)", "linear_steps = 25"]


def test_nor_is_one_that_no_suspect_has() -> None:
    what = case("displacement-slope")
    arrays = Port(what.scene, replace(what.params, linear_steps=17), Policy(), {}).render()
    assert named(case("displacement-slope"), arrays) == []


def test_of_a_few_wrong_pixels_no_parameter_is_named() -> None:
    """One of a dozen numbers explains them by chance."""
    what = case("displacement-slope")
    arrays = dict(what.frame.stages)
    steep = np.array(arrays["march.steep"])
    at = np.argwhere(np.asarray(arrays["march.hit_index"]) > 0)[:3]
    steep[tuple(at.T)] = ~steep[tuple(at.T)]
    assert named(case("displacement-slope"), {**arrays, "march.steep": steep}) == []


class _Unknown(Port):
    """A bug that is in no catalogue: the search's position is off by a sixteenth along u."""

    def position(self, rays: object, index: object) -> list[np.ndarray]:
        u, v, h = super().position(rays, index)
        return [u + 0.0625, v, h]


@pytest.mark.long
def test_a_bug_that_is_not_known_has_no_name() -> None:
    name = "displacement-slope"
    assert named(case(name), draw(name, Policy(), _Unknown)) == []


@pytest.mark.long
@pytest.mark.parametrize("mutant", PICTURED)
def test_a_picture_by_itself_names_the_bug(mutant: str) -> None:
    name = "displacement-slope"
    port = next(m.port for m in MUTANTS if m.name == mutant)
    assert mutant in named(case(name), image(draw(name, Policy(), port)))


@pytest.mark.long
def test_nor_has_it_by_the_picture() -> None:
    name = "displacement-slope"
    assert named(case(name), image(draw(name, Policy(), _Unknown))) == []


def test_of_some_pixels_a_port_draws_the_same() -> None:
    name = "displacement-crossing"
    whole, among = draw(name, Policy()), np.zeros(case(name).frame.depth.shape, np.bool_)
    among[::3, 1::4] = True
    some = Port(case(name).scene, case(name).params, Policy(), {}).render(among)
    for array, values in some.items():
        if values.shape[:2] == among.shape:
            np.testing.assert_array_equal(values[among], whole[array][among], err_msg=array)
