"""A method as someone ports it: written once, run on a device's numbers and on numbers with bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar, Self

from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy

Floats = Any
"""Numbers of the arithmetic that the program runs on: arrays of a device's, or `Number`s with bounds."""
Vector = Any
"""Components of one vector, or of many: each numbers of any one shape."""
Ints = Any
Bools = Any
"""Decided, or a `Truth`."""
PROGRAMS = __name__.rpartition(".")[0]


def right(program: Any, *names: str) -> bool:
    """Whether no fault changes these methods of a program, or of a part of one."""
    return all(getattr(type(program), name).__module__.startswith(PROGRAMS) for name in names)


def overridden(kind: type[Any], right: type[Any]) -> set[str]:
    """The names of which a program with a bug has others than the right one."""
    own = {name for each in kind.__mro__ if not issubclass(right, each) for name in vars(each)}
    return own - {"__doc__", "__module__"}


class Program:
    """What every program has at hand. A known bug is a subclass that overrides one method."""

    limits: ClassVar[dict[str, Any]] = {}
    """Numbers of the device that a fault takes for others."""
    taken: ClassVar[dict[str, Any]] = {}
    """Parameters that a fault takes for others."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """The case; `inputs`: what it hands over besides scene and parameters."""
        self.scene = scene
        self.params = replace(params, **self.taken) if self.taken else params
        self.inputs = inputs
        self.do: Any
        self.on(Arithmetic(policy))

    def on(self, do: Any) -> Self:
        """On another arithmetic: a device's, or bounds of what devices make of it."""
        self.do = do
        return self

    def right(self, *names: str) -> bool:
        """Whether no fault changes these methods: only then does another legal form stand beside what they compute."""
        return right(self, *names)

    def cross(self, a: Vector, b: Vector) -> Vector:
        """The cross product."""
        return [
            self.do.dot([a[i], -a[j]], [b[j], b[i]])  # a_i b_j - a_j b_i
            for i, j in ((1, 2), (2, 0), (0, 1))
        ]

    def transform(self, matrix: Any, point: Sequence[Any]) -> Vector:
        """The rows of a matrix (rows, 4), uploaded, applied to a point (x, y, z, 1), each summed from left to right."""
        return [self.do.dot(list(row), [*point, 1.0]) for row in self.do.matrix(matrix)]
