"""Broken ports on devices of fewer bits and more freedom than desktops': whether their bugs are still seen.

A mutant is drawn the way of a right port that marks itself as coarse (4 subpixel bits, filters in bytes, polygons that are
cut at the picture's borders), and judged by the device that this one declares. What `FINE` calls wrong should be so there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ibr_ref.oracle.cases import Case, build, names
from ibr_ref.oracle.declaration import device_of
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.faults.kinds import Mutant, PlainPort, Variant
from ibr_ref.oracle.self_test import plain_port, port_output
from ibr_ref.oracle.trials import judge

FINE = "gl,clip_border=none"
"""OpenGL with 8 subpixel bits and a guard band."""


@dataclass(frozen=True, kw_only=True)
class CoarseResult:
    """A mutant on every coarse device of its method, on cases in their order until it is killed."""

    method: str
    mutant: Mutant
    fine: str | None
    """The case on which it is killed by `FINE`; None: on none."""
    found: Mapping[str, str | None]
    """The same by the coarse variants' names; empty where the fine device does not see it either."""


def try_coarse(method: str, *, kinds: Sequence[str]) -> Iterator[CoarseResult]:
    """Every mutant of a method, on its cases of some kinds."""
    module = plain_port(method)
    cases = [case for case in map(build, names(method)) if case.kind in kinds]
    variants = [variant for variant in module.VARIANTS if variant.coarse]
    for mutant in module.MUTANTS:
        mine = [case for case in cases if mutant.applies(case.system)]
        fine = _killed(mutant.port, None, mine, device_of(FINE))
        found = {v.name: _killed(_in_the_way_of(mutant, v), v, mine, device_of(v.profile)) for v in variants if fine}
        yield CoarseResult(method=method, mutant=mutant, fine=fine, found=found)


def _in_the_way_of(mutant: Mutant, variant: Variant) -> type[PlainPort]:
    """The mutant with the order of operations of a right port."""
    if variant.port is None or issubclass(mutant.port, variant.port):
        return mutant.port
    return type(mutant.port.__name__, (mutant.port, variant.port), {})


def _killed(port: type[PlainPort], variant: Variant | None, cases: Sequence[Case], device: Device) -> str | None:
    """The first case on which it is wrong, with stages."""
    for case in cases:
        judged = judge(case, port_output(case, port, variant), device, to_first_wrong=True)
        if any(j.wrong.any() for j in judged):
            return case.name
    return None
