"""Cases, what is handed in for them, and the referee."""

from __future__ import annotations

from functools import cache
from typing import Any

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.cases.shadows import CASES
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.faults.shadows import Port
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.shadows import ShadowsReferee
from tests.oracle.judgements import in_bytes

Arrays = dict[str, Any]

REFEREE = ShadowsReferee()
"""One for all: it keeps what follows from the last case and device."""
REAL = "shadows-stage"
SMALL = tuple(name for name in CASES if name != REAL)


@cache
def case(name: str) -> Case:
    return CASES[name]()


@cache
def reference(name: str) -> Arrays:
    """The reference's own frame, as a port would hand it in."""
    frame = case(name).frame
    stages = {array: value for array, value in frame.stages.items() if "margin" not in array}
    return {**stages, "color": frame.color, "depth": frame.depth}


def drawn(name: str, policy: Policy = Policy(), port: Any = Port) -> Arrays:  # noqa: B008
    """What a plain port hands in: a picture that is held in bytes as bytes."""
    described = case(name)
    arrays: Arrays = port(described.scene, described.params, policy, described.inputs).render()
    return arrays | in_bytes(arrays) if policy.color_bits else arrays


@cache
def plain(name: str) -> Arrays:
    """The plain port's, in floats."""
    return drawn(name)


def stages(name: str, handed: Arrays, profile: str | None = None) -> list[Judgement]:
    return REFEREE.judge_stages(case(name), device_of(profile or case(name).profile), handed)


def image(name: str, handed: Arrays, profile: str | None = None) -> Judgement:
    return REFEREE.judge_image(case(name), device_of(profile or case(name).profile), handed)
