"""A FAIL names the bug: that of the broken port, with what this case does not tell from it, and never another one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.device import IEEE32
from ibr_ref.oracle.faults.splatting import MUTANTS, Port
from ibr_ref.oracle.referees.moved import with_light, with_params
from tests.oracle.judgements import in_bytes, picture
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


def named(arrays: Arrays) -> list[str]:
    judgements = REFEREE.judge_stages(case(LAMP), IEEE32, arrays, to_first_wrong=True) if len(arrays) > 2 else []
    judgements.append(REFEREE.judge_image(case(LAMP), IEEE32, arrays))
    wrong = next(j for j in judgements if j.wrong.any())
    found = REFEREE.causes(case(LAMP), IEEE32, arrays, wrong)
    assert found is not None
    assert found.given_up_after is None
    return [cause.name for cause in found.causes]


def broken(name: str) -> Arrays:
    return drawn(LAMP, port=next(m.port for m in MUTANTS if m.name == name))


@pytest.mark.parametrize("mutant", STAGED)
def test_the_bug_is_named(mutant: str) -> None:
    assert named(broken(mutant)) == [mutant]


@pytest.mark.parametrize("mutant", PICTURED)
def test_the_bug_is_named_by_the_picture_alone(mutant: str) -> None:
    assert named(picture(broken(mutant))) == [mutant]


def test_what_looks_alike_is_named_together() -> None:
    """Bytes that are rounded down and bytes over 256 are the same where no byte is 255."""
    assert named(broken("bytes-over-256")) == ["truncated-bytes", "bytes-over-256"]


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
    ],
)
def test_a_right_port_with_another_number_is_named_so(other: Case, says: str) -> None:
    assert named(taken(other)) == [says]


@pytest.mark.parametrize(
    "other",
    [with_light(case(LAMP), exponent=47), with_light(case(LAMP), ambient=0.21, diffuse=0.72)],
    ids=["whole", "two"],
)
def test_nor_are_a_whole_number_that_no_suspect_has_and_two_at_once(other: Case) -> None:
    assert named(taken(other)) == []


def test_a_bug_that_is_a_number_is_named_with_it() -> None:
    found = named(taken(with_light(case(LAMP), exponent=61)))
    assert found == ["exponent-one-more", "light.exponent = 61"]


class _Unknown(Port):
    """A bug that is in no catalogue: the window is a thousandth too wide."""

    def window_x(self, x: Any) -> Any:
        return 1.001 * super().window_x(x)


@pytest.mark.parametrize("kept", [lambda arrays: arrays, in_bytes], ids=["stages", "bytes"])
def test_a_bug_that_is_not_known_has_no_name(kept: Any) -> None:
    assert named(kept(drawn(LAMP, port=_Unknown))) == []


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
