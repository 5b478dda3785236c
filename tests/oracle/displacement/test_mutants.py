"""Broken ports are found out, and the first wrong stage is where the bug is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.faults.kinds import Mutant
from tests.oracle.displacement.drawn import REFEREE, SMALL, case, draw, wrong


@dataclass(frozen=True)
class Fate:
    """What became of a mutant."""

    stages: str
    """The case that killed it with stages; empty: none did."""
    stage: str
    """The first wrong stage there."""
    image: str
    """The case that killed it by a picture of eight bits alone."""


def fate(mutant: Mutant) -> Fate:
    """Case by case, until it is dead both ways; a picture that is known to hide it is not asked for."""
    stages = stage = picture = ""
    for name in SMALL:
        device, arrays = PROFILES[case(name).profile], draw(name, Policy(), mutant.port)
        if not stages and (found := wrong(REFEREE.judge_stages(case(name), device, arrays))):
            stages, stage = name, found[0][0]
        if not picture and wrong([REFEREE.judge_image(case(name), device, {"color": color_bytes(arrays["color"])})]):
            picture = name
        if stages and (picture or mutant.hidden):
            break
    return Fate(stages, stage, picture)


@cache
def fates() -> dict[str, Fate]:
    return {mutant.name: fate(mutant) for mutant in MUTANTS}


def test_mutants_are_killed_with_stages() -> None:
    survivors = {m.name for m in MUTANTS if not fates()[m.name].stages}
    assert survivors <= {m.name for m in MUTANTS if m.survives}
    assert len(survivors) <= 0.05 * len(MUTANTS)


def test_the_first_wrong_stage_is_the_bugs() -> None:
    misplaced = {m.name: fates()[m.name] for m in MUTANTS if fates()[m.name].stage not in ("", m.stage)}
    assert not misplaced


def test_mutants_are_killed_by_the_picture_alone() -> None:
    survivors = {m.name for m in MUTANTS if not fates()[m.name].image}
    assert survivors <= {m.name for m in MUTANTS if m.hidden or m.survives}
    assert len(survivors) <= 0.15 * len(MUTANTS)
