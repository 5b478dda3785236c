"""Broken ports are found out, and the first wrong stage is where the bug is.

By their pictures every fifth; `ibr-ref check --self-test` tries all.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.faults.kinds import Mutant
from tests.oracle.displacement.drawn import REFEREE, SMALL, case, draw, wrong

PICTURED = MUTANTS[::5]


@dataclass(frozen=True)
class Fate:
    """What became of a mutant."""

    stages: str
    """The case that killed it with stages; empty: none did."""
    stage: str
    """The first wrong stage there."""
    image: str
    """The case that killed it by a picture of eight bits alone."""


def fate(mutant: Mutant, *, by_picture: bool) -> Fate:
    """Case by case, until it is dead both ways; a picture that is known to hide it is not asked for."""
    stages = stage = picture = ""
    for name in SMALL:
        device, arrays = PROFILES[case(name).profile], draw(name, Policy(), mutant.port)
        shown = {"color": color_bytes(arrays["color"])}
        if not stages:
            judged = REFEREE.judge_stages(case(name), device, arrays, to_first_wrong=True)
            stages, stage = next(((name, found) for found, *_ in wrong(judged)), ("", ""))
        if by_picture and not picture and wrong([REFEREE.judge_image(case(name), device, shown)]):
            picture = name
        if stages and (picture or mutant.hidden or not by_picture):
            break
    return Fate(stages, stage, picture)


@cache
def fates() -> dict[str, Fate]:
    return {m.name: fate(m, by_picture=m in PICTURED) for m in MUTANTS if not m.survives}


def test_mutants_are_killed_with_stages() -> None:
    assert not {name for name, each in fates().items() if not each.stages}
    assert len(fates()) >= 0.95 * len(MUTANTS)


def test_the_first_wrong_stage_is_the_bugs() -> None:
    misplaced = {m.name: fates()[m.name] for m in MUTANTS if m.name in fates() and fates()[m.name].stage != m.stage}
    assert not misplaced


def test_mutants_are_killed_by_the_picture_alone() -> None:
    survivors = {m.name for m in PICTURED if m.name in fates() and not fates()[m.name].image}
    assert survivors <= {m.name for m in MUTANTS if m.hidden}
    assert len(survivors) <= 0.15 * len(PICTURED)
