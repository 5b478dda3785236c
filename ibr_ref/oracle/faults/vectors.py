"""Vectors of a case as suspects: the right program with the light, or the eye, somewhere else."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.faults.kinds import Mutant, PlainPort
from ibr_ref.oracle.faults.taken import LOOKS_LIKE

AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class Vector:
    """A place or a direction (3,) of a case."""

    name: str
    """As a verdict says it: "light.position"."""
    value: Floats
    """What the case has."""
    stages: tuple[str, ...]
    """Those in which it is read first: a port may have it wrong in one of several."""
    port: Callable[[type[PlainPort], Floats], type[PlainPort]]
    """A program with another vector."""
    place: bool = True
    """It may be the origin; a direction may not."""
    others: Mapping[str, Floats] = field(default_factory=dict)
    """What it may be taken for, by its name."""
    allows: Callable[[Floats], bool] = lambda value: True
    """Whether the case may have it."""

    def listed(self, port: type[PlainPort]) -> list[Mutant]:
        """Those that ports have by mistake."""
        return [m for how, value in self._mistaken() for m in self.suspects(port, value, how=f", {how}")]

    def suspects(self, port: type[PlainPort], value: Floats, joined: str = " = ", how: str = "") -> list[Mutant]:
        """One for each of the stages; nothing where the vector is not allowed."""
        if not self.allows(value):
            return []
        name = f"{self.name}{joined}{spelled(value)}"
        fault = f"The port is right with {self.name} = {spelled(value)}{how}; the case has {spelled(self.value)}."
        return [Mutant(name=name, fault=fault, stage=s, port=self.port(port, value)) for s in self.stages]

    def of_name(self, port: type[PlainPort], name: str) -> list[Mutant]:
        """The suspects whose name says that they were found, not guessed."""
        told, _, value = name.partition(LOOKS_LIKE)
        if told != self.name or not value:
            return []
        return self.suspects(port, np.array([float(x) for x in value.strip("()").split(", ")]), LOOKS_LIKE)

    def _mistaken(self) -> Iterator[tuple[str, Floats]]:
        """How, and what that makes of it, where it is another."""
        known = [self.value]
        for how, value in self._every():
            if not any(np.array_equal(value, each) for each in known):
                known.append(value)
                yield how, value

    def _every(self) -> Iterator[tuple[str, Floats]]:
        if self.place:
            yield "the origin", np.zeros(3)
        yield "all of it negated", -self.value
        for axis, letter in enumerate(AXES):
            yield f"{letter} negated", np.where(np.arange(3) == axis, -self.value, self.value)
        for a, b in combinations(range(3), 2):
            order = np.arange(3)
            order[[a, b]] = b, a
            yield f"{AXES[a]} and {AXES[b]} swapped", self.value[order]
        yield from self.others.items()


def spelled(vector: Sequence[float] | Floats) -> str:
    """(x, y, z), as a verdict says it."""
    return f"({', '.join(f'{x + 0.0:.9g}' for x in vector)})"
