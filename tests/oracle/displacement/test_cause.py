"""A FAIL names the bug: that of the broken port, with what this case does not tell from it, and never another one."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import IEEE32
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.programs.displacement import Port
from tests.oracle.displacement.drawn import REFEREE, Arrays, case, draw

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


def named(name: str, arrays: Arrays) -> list[str]:
    judgements = REFEREE.judge_stages(case(name), IEEE32, arrays, to_first_wrong=True)
    wrong = next((j for j in judgements if j.wrong.any()), None)
    if wrong is None:
        pytest.skip("not visible on this case")
    found = REFEREE.causes(case(name), IEEE32, arrays, wrong)
    assert found is not None
    assert found.given_up_after is None
    return [cause.name for cause in found.causes]


@pytest.mark.parametrize("mutant", STAGED)
def test_the_bug_is_named(mutant: str) -> None:
    name = "displacement-slope"
    port = next(m.port for m in MUTANTS if m.name == mutant)
    assert mutant in named(name, draw(name, Policy(), port))


class _Unknown(Port):
    """A bug that is in no catalogue: the search's position is off by a sixteenth along u."""

    def position(self, rays: object, index: object) -> list[np.ndarray]:
        u, v, h = super().position(rays, index)
        return [u + 0.0625, v, h]


def test_a_bug_that_is_not_known_has_no_name() -> None:
    name = "displacement-slope"
    assert named(name, draw(name, Policy(), _Unknown)) == []
