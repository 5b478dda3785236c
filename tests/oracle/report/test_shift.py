"""Pictures of splats and of shadows that were sampled elsewhere: by how much is found."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from ibr_ref import methods
from ibr_ref.array_types import Bools
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.examination import Examination, examine
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.report.shift import Shift, shift
from tests.oracle.tiny_cases import TINY

pytestmark = pytest.mark.usefixtures("one_thread")


def sampled_elsewhere(case: Case, across: float, down: float) -> dict[str, Any]:
    """The stages of the same view through a camera whose picture lies elsewhere."""
    scene = case.scene
    clip = scene.camera.clip_from_view.copy()
    clip[0] -= 2 * across / scene.camera.width * clip[3]
    clip[1] += 2 * down / scene.camera.height * clip[3]
    camera = dataclasses.replace(scene.camera, clip_from_view=clip, intrinsics=None)
    other = dataclasses.replace(case, scene=dataclasses.replace(scene, camera=camera))
    return other.draw(stages=True).stages


def shift_of(case: Case, array: str, across: float, down: float) -> Shift | None:
    handed = {array: sampled_elsewhere(case, across, down)[array]}
    ours, theirs = (np.asarray(a[array], np.float64) for a in (case.frame.stages, handed))
    wrong: Bools = np.abs(theirs - ours) > 1e-9
    wrong = wrong.any(axis=-1) if array == "project.coord" else wrong
    judgement = Judgement(
        stage=array.partition(".")[0], element="pixel", arrays=(array,), wrong=wrong,
        undecided=np.zeros_like(wrong), width=np.full(wrong.shape, np.nan), blame=np.zeros(wrong.shape, np.int8),
    )  # fmt: skip
    verdict: Any = None
    return shift(Examination(case=case, handed=handed, judgements=[judgement], verdict=verdict))


@pytest.mark.parametrize(("across", "down"), [(0.5, 0.0), (0.0, -0.5), (0.5, 0.5), (-1.0, 0.25)])
@pytest.mark.parametrize("name", ["splatting-dots", "splatting-round_dots"])
def test_of_splats(name: str, across: float, down: float) -> None:
    found = shift_of(TINY[name](), "raster.splat", across, down)
    assert found is not None
    assert found.median == pytest.approx((across, down), abs=0.35)  # splats are wide
    assert found.explained > 0.8 * found.wrong


@pytest.mark.parametrize(("across", "down"), [(0.5, 0.0), (0.0, -0.5), (0.5, 0.5), (-1.0, 0.25)])
@pytest.mark.parametrize("name", ["shadows-warp", "shadows-many"])
def test_of_shadows(name: str, across: float, down: float) -> None:
    """Of several light samples too."""
    found = shift_of(TINY[name](), "project.coord", across, down)
    assert found is not None
    assert found.median == pytest.approx((across, down), abs=0.1)
    assert found.explained > 0.6 * found.wrong


def test_winners_by_another_order_are_no_shift() -> None:
    """The farthest splat instead of the nearest: a few pixels may agree with a shift, most do not."""
    case = TINY["splatting-dots"]()
    mutant = next(m for m in methods.named("splatting").plain_port.open().MUTANTS if m.name == "farthest-wins")
    handed = mutant.port(case.scene, case.params, Policy(), case.inputs).render()
    found = shift(examine(case, handed, profile="ieee32", name_causes=False))
    assert found is None or found.explained < 0.5 * found.wrong
