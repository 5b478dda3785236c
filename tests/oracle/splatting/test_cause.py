"""A FAIL names the bug: that of the broken port, with what this case does not tell from it, and never another one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.device import IEEE32
from ibr_ref.oracle.faults.splatting import MUTANTS, Port
from ibr_ref.oracle.faults.splatting.vectors import lit_from, seen_from
from ibr_ref.oracle.referees.moved import with_light, with_params
from ibr_ref.oracle.referees.splatting import cause
from tests.oracle.judgements import in_bytes, named, picture
from tests.oracle.splatting.judged import REFEREE, Arrays, case, drawn

LAMP = "splatting-lamp"
STAGED = (
    "normals-face-the-view",
    "depths-of-half-precision",
    "four-decimals",
    "beta-too-large",
    "fast-inverse-square-root",
    "size-as-radius",
    "encoded-for-screens",
    "color-of-the-pixel-above",
)
"""One of each kind; all of them are in the note of the naming tables."""
PICTURED = ("upside-down", "color-of-the-pixel-to-the-left")


def broken(name: str) -> Arrays:
    return drawn(LAMP, port=next(m.port for m in MUTANTS if m.name == name))


@pytest.mark.parametrize("mutant", STAGED)
def test_the_bug_is_named(mutant: str) -> None:
    assert named(case(LAMP), broken(mutant)) == [mutant]


@pytest.mark.long
@pytest.mark.parametrize("mutant", PICTURED)
def test_the_bug_is_named_by_the_picture_alone(mutant: str) -> None:
    assert named(case(LAMP), picture(broken(mutant))) == [mutant]


def test_the_eye_of_highlights_at_the_origin_is_named() -> None:
    """Highlights for the origin."""
    assert "eye of the highlights = (0, 0, 0)" in named(case(LAMP), drawn(LAMP, port=seen_from(Port, np.zeros(3))))


def test_what_looks_alike_is_named_together() -> None:
    """Bytes that are rounded down and bytes over 256 are the same where no byte is 255."""
    assert named(case(LAMP), broken("bytes-over-256")) == ["truncated-bytes", "bytes-over-256"]


def taken(other: Case) -> Arrays:
    """A right port of another case."""
    return Port(other.scene, other.params, Policy(), other.inputs).render()


@pytest.mark.parametrize(
    ("other", "says"),
    [
        (with_params(case(LAMP), beta=0.14), "beta = 0.14"),
        (with_params(case(LAMP), max_width=3.52), "max_width looks like 3.52"),
        (with_light(case(LAMP), ambient=0.4), "light.ambient = 0.4"),
        (with_light(case(LAMP), specular=0.62), "light.specular looks like 0.62"),
        (with_light(case(LAMP), position=(1.0, 2.0, -2.5)), "light.position = (1, 2, -2.5)"),
        (with_light(case(LAMP), position=(1.25, -2.6, 2.05)), "light.position looks like (1.25, -2.6, 2.05)"),
    ],
)
def test_a_right_port_with_another_number_is_named_so(other: Case, says: str) -> None:
    assert named(case(LAMP), taken(other)) == [says]


@pytest.mark.parametrize(
    "other",
    [with_light(case(LAMP), exponent=47), with_light(case(LAMP), ambient=0.21, diffuse=0.72)],
    ids=["whole", "two"],
)
def test_nor_are_a_whole_number_that_no_suspect_has_and_two_at_once(other: Case) -> None:
    assert named(case(LAMP), taken(other)) == []


def test_a_bug_that_is_a_number_is_named_with_it() -> None:
    found = named(case(LAMP), taken(with_light(case(LAMP), exponent=61)))
    assert found == ["exponent-one-more", "light.exponent = 61"]


def both(a: str, b: str) -> Arrays:
    """A port with two bugs."""
    kinds = [next(m.port for m in MUTANTS if m.name == name) for name in (a, b)]
    return drawn(LAMP, port=type("_Both", tuple(kinds), {}))


@pytest.mark.parametrize(
    ("a", "b"), [("half-pixel-shift", "colors-encoded-in-the-shader"), ("half-pixel-shift", "width-as-integer")]
)
def test_two_bugs_of_which_neither_explains_all_are_named_together(a: str, b: str) -> None:
    (found,) = named(case(LAMP), both(a, b))
    assert found in (f"{a} and {b}", f"{b} and {a}")


def test_two_bugs_of_which_one_does_not_show_are_not_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without beta, β d for β d² is right, and makes of exchanged coefficients another bug, which is none of the two."""
    name = "splatting-shelves"
    two = [m for m in MUTANTS if m.name in ("coefficients-backwards", "distance-not-squared")]
    monkeypatch.setattr(cause, "MUTANTS", two)
    arrays = drawn(name, port=next(m.port for m in MUTANTS if m.name == "delta-times-distance"))
    wrong = next(j for j in REFEREE.judge_stages(case(name), IEEE32, arrays, to_first_wrong=True) if j.wrong.any())
    found = REFEREE.causes(case(name), IEEE32, arrays, wrong)
    assert found is not None
    assert found.causes == ()


def test_a_directions_length_says_nothing() -> None:
    name = "splatting-quads"
    arrays = drawn(name, port=lit_from(Port, 3.0 * np.asarray(case(name).scene.light.direction)))
    assert not any(j.wrong.any() for j in REFEREE.judge_stages(case(name), IEEE32, arrays))


def test_a_pair_is_recognized() -> None:
    a, b = "half-pixel-shift", "colors-encoded-in-the-shader"
    arrays = both(a, b)
    wrong = next(j for j in REFEREE.judge_stages(case(LAMP), IEEE32, arrays, to_first_wrong=True) if j.wrong.any())
    for name, known in ((f"{a} and {b}", True), (f"{a} and exponent-one-less", False), (a, False)):
        assert REFEREE.recognizes(case(LAMP), IEEE32, arrays, wrong, name) is known


def test_of_a_few_wrong_points_no_second_bug_is_named() -> None:
    """Of many pairs one explains them by chance; what explains the others comes nearest, and its place is told."""
    arrays = broken("half-pixel-shift")
    color = np.array(arrays["vertex.color"])
    at = np.flatnonzero(np.isfinite(color).all(axis=1))[[3, 40]]
    color[at] += 0.25
    judgements = REFEREE.judge_stages(case(LAMP), IEEE32, {**arrays, "vertex.color": color}, to_first_wrong=True)
    wrong = next(j for j in judgements if j.wrong.any())
    found = REFEREE.causes(case(LAMP), IEEE32, {**arrays, "vertex.color": color}, wrong)
    assert found is not None
    assert found.nearest is not None
    assert (found.causes, found.nearest.name) == ((), "half-pixel-shift")
    assert (found.nearest.left, found.nearest.element, found.nearest.index) == (2, "vertex", (at[0],))


class _Unknown(Port):
    """A bug that is in no catalogue: the window is a thousandth too wide."""

    def window_x(self, x: Any) -> Any:
        return 1.001 * super().window_x(x)


@pytest.mark.parametrize("kept", [lambda arrays: arrays, in_bytes], ids=["stages", "bytes"])
def test_a_bug_that_is_not_known_has_no_name(kept: Any) -> None:
    assert named(case(LAMP), kept(drawn(LAMP, port=_Unknown))) == []


def test_what_a_fault_does_not_change_is_shared() -> None:
    """A suspect of the light has the right program's points."""
    from ibr_ref.oracle.referees.splatting.model import Model

    right = Model(case(LAMP), IEEE32)
    of = {m.name: Model(case(LAMP), IEEE32, m.port, right) for m in MUTANTS}  # type: ignore[arg-type]
    assert of["no-clamp"].own_places is right.own_places
    assert of["closed-borders"].own_contest is not right.own_contest
    assert of["upside-down"].own is not right.own
    np.testing.assert_array_equal(
        of["half-pixel-shift"].own_places.window[0].value, right.own_places.window[0].value - 0.5
    )
