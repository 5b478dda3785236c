"""Broken ports are found out, and the first wrong stage is where the bug is.

By their pictures every fifth; `ibr-ref check --self-test` tries all.
"""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.oracle.faults.kinds import Mutant
from tests.oracle.displacement.drawn import (
    REFEREE,
    SMALL,
    Arrays,
    case,
    changed,
    draw,
    first_wrong,
    plain,
    wrong,
)

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
    for name in (name for name in SMALL if mutant.applies(case(name).system)):
        arrays = draw(name, Policy(), mutant.port)
        if not stages and (found := first_wrong(name, arrays)):
            stages, stage = name, found
        if by_picture and not picture and pictured(name, arrays):
            picture = name
        if stages and (picture or mutant.hidden or not by_picture):
            break
    return Fate(stages, stage, picture)


def shown(arrays: Arrays) -> Arrays:
    """The picture in bytes, alone."""
    return {"color": color_bytes(arrays["color"])}


def pictured(name: str, arrays: Arrays) -> bool:
    """Whether the picture alone is wrong; the plain port's is right."""
    if not changed(shown(arrays)["color"], shown(plain(name))["color"]):
        return False
    return bool(REFEREE.judge_image(case(name), PROFILES[case(name).profile], shown(arrays)).wrong.any())


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", SMALL)
def test_the_plain_port_is_right(name: str) -> None:
    """What a mutant shares with it is not judged again."""
    device = PROFILES[case(name).profile]
    assert not wrong(REFEREE.judge_stages(case(name), device, plain(name)))
    assert not wrong([REFEREE.judge_image(case(name), device, shown(plain(name)))])


@pytest.mark.sampled(4)
@pytest.mark.parametrize("mutant", [m for m in MUTANTS if not m.survives], ids=lambda mutant: mutant.name)
def test_a_bug_is_found_where_it_is(mutant: Mutant) -> None:
    found = fate(mutant, by_picture=mutant in PICTURED)
    assert found.stages, "with stages no case shows it"
    assert found.stage == mutant.stage
    assert found.image or mutant.hidden or mutant not in PICTURED, "by its picture no case shows it"


def test_few_are_not_found() -> None:
    assert sum(bool(mutant.survives) for mutant in MUTANTS) <= 0.05 * len(MUTANTS)
    assert sum(bool(mutant.hidden) for mutant in PICTURED) <= 0.15 * len(PICTURED)
