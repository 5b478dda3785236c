"""Cases, what is handed in for them, and the referee."""

from __future__ import annotations

from functools import cache
from typing import Any

from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.cases import Case
from ibr_ref.oracle.cases.splatting import CASES
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.faults.splatting import Port
from ibr_ref.oracle.judgement import Judgement
from ibr_ref.oracle.referees.splatting import SplattingReferee

Arrays = dict[str, Any]

REFEREE = SplattingReferee()
REAL = "splatting-kettle"
SMALL = tuple(name for name in CASES if name != REAL)


@cache
def case(name: str) -> Case:
    return CASES[name]()


@cache
def reference(name: str) -> Arrays:
    """The reference's own frame, as a port would hand it in."""
    frame = case(name).frame
    return {**frame.stages, "color": frame.color, "depth": frame.depth}


def drawn(name: str, policy: Policy = Policy(), port: Any = Port) -> Arrays:  # noqa: B008
    """What a plain port makes of a case."""
    described = case(name)
    arrays: Arrays = port(described.scene, described.params, policy, described.inputs).render()
    if policy.color_bits == 8:
        arrays["color"] = color_bytes(arrays["color"])
    return arrays


@cache
def plain(name: str) -> Arrays:
    """The plain port's, in float32."""
    return drawn(name)


def stages(name: str, handed: Arrays, profile: str | None = None) -> list[Judgement]:
    return REFEREE.judge_stages(case(name), device_of(profile or case(name).profile), handed)


def image(name: str, handed: Arrays, profile: str | None = None) -> Judgement:
    return REFEREE.judge_image(case(name), device_of(profile or case(name).profile), handed)
