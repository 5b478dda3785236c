"""Soft shadows with too many legal outcomes to follow each: what is around all of them is sound, and says something."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.referees.shadows import project
from ibr_ref.oracle.referees.shadows.enclosed import Enclosed, hats, least_mean
from ibr_ref.oracle.referees.shadows.image import Accepted
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from tests.oracle.devices import random_policy
from tests.oracle.judgements import picture
from tests.oracle.shadows.judged import case, drawn

NAME, COARSE = "shadows-penumbra", "gl,subpixel_bits=4"


def test_the_least_mean_is_that_of_the_best_choice() -> None:
    random = np.random.default_rng(1)
    numbers = random.random((200, 5))
    may = random.random(numbers.shape) < 0.7
    must = may & (random.random(numbers.shape) < 0.4)
    for row, there, needed, found in zip(numbers, may, must, least_mean(numbers, may, must), strict=True):
        choices = (np.array(choice) for choice in product((False, True), repeat=5))
        means = [row[c].mean() for c in choices if c.any() and (c <= there).all() and (c >= needed).all()]
        assert found == pytest.approx(min(means)) if means else np.isinf(found)


def test_no_place_is_beyond_the_ends_of_a_mix() -> None:
    random = np.random.default_rng(2)
    image, middle, half = random.random(12), random.uniform(2.0, 8.0, 300), random.uniform(0.0, 1.7, 300)
    x = Number(None, middle, half)
    first, last = np.floor(x.low).astype(int), np.floor(x.high).astype(int)
    texels = np.minimum(first[:, None] + np.arange(6), last[:, None] + 1)
    ends = np.einsum("nxk,nk->nx", hats(x, texels), image[texels])
    for share in np.linspace(-1.0, 1.0, 21):
        found = np.interp(middle + share * half, np.arange(12), image)
        assert (found >= ends.min(axis=1) - 1e-12).all()
        assert (found <= ends.max(axis=1) + 1e-12).all()


def test_a_picture_is_judged_where_the_verge_of_the_caster_is_open() -> None:
    """Each comparison followed by itself, anything was accepted at 17 % of the hit pixels."""
    accepted, hit = Accepted.of(Inputs(case(NAME), device_of(COARSE))), case(NAME).frame.depth < 1.0
    judged = accepted.judge({"color": np.random.default_rng(3).random((*hit.shape, 3))})
    assert judged.wrong[hit].mean() > 0.98
    assert judged.undecided[hit].mean() < 0.12


def test_it_holds_what_devices_draw(monkeypatch: pytest.MonkeyPatch) -> None:
    """For all fragments, not those alone that need it."""
    followed = project._followed

    def enclosed_alone(model: Any, program: Any, image: Any, axes: Any, among: Any, steps: Any) -> Any:
        fragment, outcome, lost = followed(model, program, image, axes, among, steps)
        return (fragment, outcome, lost) if isinstance(program, Enclosed) else (fragment[:0], outcome[:0], among)

    monkeypatch.setattr(project, "_followed", enclosed_alone)
    accepted, random = Accepted.of(Inputs(case(NAME), device_of(COARSE))), np.random.default_rng(4)
    assert not accepted.outcomes.crowded.any()
    for rounding in ("even", "up", "down"):
        policy, _ = random_policy(random, "gl")
        policy = replace(policy, subpixel_bits=4, subpixel_rounding=rounding, color_bits=None)
        assert not accepted.judge(picture(drawn(NAME, policy))).wrong.any(), policy
