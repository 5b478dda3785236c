"""Cases, drawn by ports: each at most once, as several tests look at the same pictures."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.cases.displacement import CASES
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.programs.displacement.port import Port
from ibr_ref.oracle.referees.displacement import DisplacementReferee
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.replay import Port as Replayed
from ibr_ref.oracle.referees.displacement.stages import STAGES, Stages

Arrays = dict[str, Any]

REFEREE = DisplacementReferee()
REAL_SIZED = "displacement-metropolis"
SMALL = tuple(name for name in CASES if name != REAL_SIZED)


@cache
def case(name: str) -> Case:
    return CASES[name]()


def reference(name: str) -> Arrays:
    frame = case(name).frame
    return {**frame.stages, "color": frame.color, "depth": frame.depth}


def draw(name: str, policy: Policy, port: type[Any] | None = None) -> Arrays:
    """All arrays of a plain port; a picture of eight bits as bytes."""
    what = case(name)
    arrays = (port or Port)(what.scene, what.params, policy, what.inputs).render()
    if policy.color_bits == 8:
        arrays["color"] = color_bytes(arrays["color"])
    return arrays


@cache
def plain(name: str) -> Arrays:
    """What the plain port in float32 draws: every stage of it is right (`test_mutants`)."""
    return draw(name, Policy())


def first_wrong(name: str, arrays: Arrays) -> str:
    """The first wrong stage of a port with a bug, by the case's own profile; empty: none.

    Stages before the first array that differs from the plain port's are that port's, and are not judged again.
    """
    right = plain(name)
    stages = Stages(Replayed(model=Model(case(name), PROFILES[case(name).profile]), handed=arrays))
    differs = False
    for stage in STAGES:
        judged = (*stages.names(stage), *(["color"] if stage == "shade" else []))  # lighting is a part of it
        differs = differs or any(changed(arrays[array], right[array]) for array in judged)
        with np.errstate(all="ignore"):
            if differs and stages.judge(stage).wrong.any():
                return stage
    return ""


def changed(array: Any, right: Any) -> bool:
    """Whether a number is another one."""
    return not np.array_equal(array, right, equal_nan=array.dtype.kind == "f")


def wrong(judgements: list[Judgement]) -> list[tuple[str, str, int, list[int]]]:
    """Of each stage that has any: the array that is blamed first, how many elements, the first of them."""
    found = []
    for judgement in judgements:
        if judgement.wrong.any():
            first = np.argwhere(judgement.wrong)[0]
            name = judgement.arrays[judgement.blame[tuple(first)]]
            found.append((judgement.stage, name, int(judgement.wrong.sum()), first.tolist()))
    return found


def image(arrays: Arrays) -> Arrays:
    """The final picture alone."""
    return {name: arrays[name] for name in ("color", "depth")}


def profiles_from(name: str) -> list[str]:
    """A profile and all that are looser."""
    names = list(PROFILES)
    return names[names.index(name) :]
