"""Faces that are cut at the picture's border: a right port with poor planes there passes, and bugs are found beside it."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.declaration import ARITHMETIC, device_of
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.faults.kinds import Mutant
from ibr_ref.oracle.programs.displacement.variants import CutAtBorders
from tests.oracle.displacement.drawn import REFEREE, case, draw, reference, wrong

NAME = "displacement-sliver"


CORRECT = ",".join(f"{name}=0.5" for name in ARITHMETIC)


def test_a_device_that_clips_at_the_border_passes_where_that_is_allowed() -> None:
    """Also where it is known how precisely it computes, and that it interpolates over what it has not snapped."""
    arrays = draw(NAME, Policy(snapped_varyings=False), CutAtBorders)
    for device in ("gl", "gl,varyings=unsnapped", f"gl,varyings=unsnapped,{CORRECT}"):
        assert not wrong(REFEREE.judge_stages(case(NAME), device_of(device), arrays))
    assert wrong(REFEREE.judge_stages(case(NAME), device_of("gl,clip_border=none"), arrays))
    off = np.abs(arrays["raster.patch"] - reference(NAME)["raster.patch"]).max(axis=-1)
    assert np.nanmax(off) > 1e-4, "no sliver shows"


BUGS = [m for m in MUTANTS if m.stage == "raster" and not m.small][::2]


@pytest.mark.parametrize("mutant", BUGS, ids=lambda mutant: mutant.name)
def test_bugs_of_the_rasterizer_are_as_visible_as_without(mutant: Mutant) -> None:
    """Where a device without clipping at the border is told to be wrong, so is one with it."""
    arrays = draw(NAME, Policy(), mutant.port)
    found = [
        bool(wrong(REFEREE.judge_stages(case(NAME), device_of(device), arrays, to_first_wrong=True)))
        for device in ("gl,clip_border=none", "gl")
    ]
    assert found[0] == found[1]
