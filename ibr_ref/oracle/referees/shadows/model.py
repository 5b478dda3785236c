"""A program of shadows on the numbers of a device; its results are kept as numbers with bounds.

The program is the right one, or one with a known bug: both are run alike, and judged alike.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.pipeline.machine import Machine
from ibr_ref.oracle.programs.program import overridden
from ibr_ref.oracle.programs.shadows import Port as Program


@dataclass(frozen=True, eq=False)
class Model:
    """One program, one case, one device."""

    case: Case
    device: Device
    kind: type[Program]
    draws: Callable[[Model], Machine]
    """Its device."""

    def changes(self, names: Collection[str]) -> bool:
        """Whether a fault changes what of the program has one of these names."""
        return bool(overridden(self.kind, Program) & {*names})

    @cached_property
    def machine(self) -> Machine:
        """What it runs on."""
        return self.draws(self)

    @cached_property
    def program(self) -> Any:
        """The case's."""
        return self._program(Policy()).on(self.machine)

    @cached_property
    def exact(self) -> Any:
        """The same in doubles: which outcome of a decision is the likeliest."""
        return self._program(Policy(float_bits=64))

    def _program(self, policy: Policy) -> Program:
        return self.kind(self.case.scene, self.case.params, policy, self.case.inputs)

    def number(self, x: Bounded, lane: Any = None, name: str = "") -> Number:
        """For the program; name: of a symbol, where it is used more than once."""
        found = Number(self.machine, x.value, np.broadcast_to(x.error, np.shape(x.value)), {}, lane)
        return self.machine.named(name, found) if name else found

    def numbers(self, vector: Sequence[Bounded], name: str = "") -> list[Number]:
        """Components (n,), of no lanes: what is decided of them is as the values have it."""
        return [self.number(x, None, name) for x in vector]

    def bounded(self, x: Any) -> Bounded:
        """From the program; symbols are errors like others from there on."""
        found = self.machine.of(x)
        return Bounded(found.value, np.broadcast_to(found.deviation, found.shape), self.device)


def stacked(parts: Sequence[Any], axis: int = 0) -> Number:
    """Numbers along a new axis."""
    found: Any = np.stack(parts, axis=axis)
    return found  # type: ignore[no-any-return]
