"""A budget that runs out is undecided, never an accusation."""

from __future__ import annotations

import pytest

from ibr_ref.oracle.arithmetic import decisions
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import PROFILES
from tests.oracle.displacement.drawn import REFEREE, case, draw, wrong

ROUGH = Policy(weight_bits=8, weight_rounding="down", truncated=True, backwards=True)


@pytest.mark.parametrize("handed", [None, "march", "shade"])
@pytest.mark.parametrize("name", ["displacement-slope", "displacement-city"])
def test_a_right_port_is_not_accused_where_outcomes_are_too_many(
    name: str, handed: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With every stage, and without the arrays of one, for which the program's own outcomes then stand."""
    monkeypatch.setattr(decisions, "MOST_PATHS", 1)
    arrays = draw(name, ROUGH)
    arrays = {key: a for key, a in arrays.items() if handed is None or not key.startswith(handed)}
    judgements = REFEREE.judge_stages(case(name), PROFILES["d3d11"], arrays)
    assert wrong(judgements) == []
    assert any(j.undecided.any() for j in judgements)
