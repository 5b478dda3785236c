"""A FAIL names the bug: that of the broken port, with what this case does not tell from it, and never another one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.device import IEEE32
from ibr_ref.oracle.faults.shadows import MUTANTS, Port
from ibr_ref.oracle.faults.shadows.vectors import lit_from
from ibr_ref.oracle.programs.shadows.raster import Raster
from ibr_ref.oracle.referees.moved import with_light, with_params, with_scene
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from tests.oracle.judgements import named, picture
from tests.oracle.shadows.judged import Arrays, case, drawn

BOX = "shadows-box"
STAGED = {
    "maps-rows-flipped": BOX,
    "controls-v-upwards": BOX,
    "warp-mix-reversed": BOX,
    "warp-half-a-texel": BOX,
    "depth-viewport-shifted": BOX,
    "project-t-upwards": BOX,
    "project-bias-sign": "shadows-depths",
    "grid-n-intervals": "shadows-many",
    "soft-receiver-for-blocker": "shadows-penumbra",
    "accumulate-over": "shadows-nearest",
    "resolve-half-lambert": BOX,
    "resolve-columns-mirrored": BOX,
}
"""One of each stage and kind, and where it shows."""


def broken(name: str, mutant: str) -> Arrays:
    return drawn(name, port=next(m.port for m in MUTANTS if m.name == mutant))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("mutant", STAGED)
def test_the_bug_is_named(mutant: str) -> None:
    assert named(case(STAGED[mutant]), broken(STAGED[mutant], mutant)) == [mutant]


@pytest.mark.long
def test_the_bug_is_named_by_the_picture_alone() -> None:
    assert named(case(BOX), picture(broken(BOX, "resolve-bgr"))) == ["resolve-bgr"]


DEPTHS, NEAREST = "shadows-depths", "shadows-nearest"


def taken(other: Case) -> Arrays:
    """A right port of another case."""
    return Port(other.scene, other.params, Policy(), other.inputs).render()


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("name", "other", "says"),
    [
        (BOX, with_scene(case(BOX), ambient=0.46), ["ambient = 0.46"]),
        (BOX, with_scene(case(BOX), ambient=0.241), ["ambient looks like 0.241"]),
        (NEAREST, with_params(case(NEAREST), map_samples=3), ["map_samples = 3"]),
        (DEPTHS, with_params(case(DEPTHS), bias=0.008), ["project-bias-doubled", "bias = 0.008"]),
        (DEPTHS, with_params(case(DEPTHS), bias=0.0013), ["bias looks like 0.0014"]),  # as good
        (DEPTHS, with_light(case(DEPTHS), far=8.1), ["light.far looks like 8.1"]),
    ],
)
def test_a_right_port_with_another_number_is_named_so(name: str, other: Case, says: list[str]) -> None:
    assert named(case(name), taken(other)) == says


def test_nor_is_one_that_no_suspect_has() -> None:
    assert named(case(NEAREST), taken(with_params(case(NEAREST), map_samples=7))) == []


@pytest.mark.parametrize(
    ("name", "a", "b"),
    [
        (BOX, "resolve-light-from-target", "resolve-five-bits-a-channel"),
        ("shadows-far", "project-no-bias", "project-r-not-clamped"),
    ],
)
def test_two_bugs_of_which_neither_explains_all_are_named_together(name: str, a: str, b: str) -> None:
    kinds = [next(m.port for m in MUTANTS if m.name == each) for each in (a, b)]
    (found,) = named(case(name), drawn(name, port=type("_Both", tuple(kinds), {})))
    assert found in (f"{a} and {b}", f"{b} and {a}")


@pytest.mark.parametrize("place", [(0.2, 4.0, -0.15), (0.35, -0.2, 3.5)], ids=["listed", "found"])
def test_the_light_of_colours_alone_is_named(place: tuple[float, float, float]) -> None:
    (found,) = named(case(BOX), drawn(BOX, port=lit_from(Port, np.array(place))))
    assert found.startswith("light.position of colours ")
    assert found.endswith(f"({', '.join(f'{x:g}' for x in place)})")


class _TooWide(Raster):
    def column(self, x: Any, width: int) -> Any:
        return super().column(1.003 * x, width)


class _Unknown(Port):
    """A bug that is in no catalogue: the picture is a few thousandths too wide."""

    surface_raster = _TooWide


def test_a_bug_that_is_not_known_has_no_name() -> None:
    assert named(case(BOX), drawn(BOX, port=_Unknown)) == []


def test_what_a_fault_does_not_change_is_shared() -> None:
    """A suspect of the blending has the right program's surfaces and maps."""
    right = Inputs(case(BOX), IEEE32)
    of = {m.name: Inputs(case(BOX), IEEE32, {}, right, m.port, right=right) for m in MUTANTS}  # type: ignore[arg-type]
    assert of["accumulate-over"].seen is right.seen
    assert of["accumulate-over"].map(0) is right.map(0)
    assert of["depth-y-upwards"].seen is not right.seen
    assert of["warp-t-upwards"].map(0) is not right.map(0)
