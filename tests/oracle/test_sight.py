"""What is printed of the oracle's sight: a blind judge accepts all of it, a seeing one nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ibr_ref.oracle import sight as module
from ibr_ref.oracle.cases import build
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.sight import sight
from tests.oracle.tiny_cases import TINY


class Blind:
    """Calls everything right; of hit pixels, and of stages where it is told so."""

    def __init__(self, judge: object, stages_see: bool) -> None:
        self.judge, self.stages_see = judge, stages_see

    def judge_image(self, *given: object) -> object:
        found = self.judge.judge_image(*given)
        return replace(found, wrong=np.zeros_like(found.wrong), blame=np.full_like(found.blame, -1))

    def judge_stages(self, *given: object) -> list[object]:
        return self.judge.judge_stages(*given) if self.stages_see else []


def test_the_referee_sees() -> None:
    found = sight(build("displacement-box"), PROFILES["ieee32"])
    assert found.hits > 1000
    shares = (found.color_of_picture, found.color_beside_depth, found.color_beside_stages)
    assert max(*shares, found.depth_beside_color, found.depth_beside_stages) <= 0.005


@pytest.mark.parametrize("stages_see", [False, True])
def test_a_blind_judge_shows(stages_see: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    judge = module.referee("displacement")
    monkeypatch.setattr(module, "referee", lambda method: Blind(judge, stages_see))
    found = sight(TINY["displacement-hill"](), PROFILES["ieee32"])
    assert found.color_of_picture == found.color_beside_depth == found.depth_beside_color == 1.0
    assert found.color_beside_stages == found.depth_beside_stages == (0.0 if stages_see else 1.0)
