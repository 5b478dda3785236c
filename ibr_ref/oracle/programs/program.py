"""A method as someone ports it: written once, run on a device's numbers and on numbers with bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np

from ibr_ref.oracle.arithmetic.device import Arithmetic, Policy

Floats = Any
"""Numbers of the arithmetic that the program runs on: arrays of a device's, or `Number`s with bounds."""
Vector = Any
"""Components of one vector, or of many: each numbers of any one shape."""
Ints = Any
Bools = Any
"""Decided, or a `Truth`."""
PROGRAMS = __name__.rpartition(".")[0]
Path = tuple[str | int, ...]
"""Where a number of a case stands: fields and indices from "scene" or "params" on, `EACH` for all of a sequence."""
EACH = -1
SAID = frozenset({"taken", "read_by", "_abc_impl"})
"""What classes of programs say of themselves, beside names between underscores: no program computes by it."""


def right(program: Any, *names: str) -> bool:
    """Whether no fault changes these methods of a program, or of a part of one."""
    return all(getattr(type(program), name).__module__.startswith(PROGRAMS) for name in names)


def own_names(kind: type[Any], right: type[Any]) -> set[str]:
    """What a program with a bug has otherwise than the right one, but for what every class says of itself."""
    names = {name for each in kind.__mro__ if not issubclass(right, each) for name in vars(each)}
    return {name for name in names if name == "__init__" or not name.startswith("__")} - SAID


def overridden(kind: type[Any], right: type[Any]) -> set[str]:
    """The same, with the methods that read a number which it takes for another."""
    return own_names(kind, right) | {*kind.read_by}


def changed(whole: Any, path: Path, value: Any) -> Any:
    """Something with another number in it; raises ValueError where that is not allowed."""
    if not path:
        return value
    first, rest = path[0], path[1:]
    if isinstance(first, str):
        return replace(whole, **{first: changed(getattr(whole, first), rest, value)})
    parts = [changed(part, rest, value) if first in (EACH, i) else part for i, part in enumerate(whole)]
    return np.array(parts) if isinstance(whole, np.ndarray) else parts


class Program:
    """What every program has at hand. A known bug is a subclass that overrides one method."""

    limits: ClassVar[dict[str, Any]] = {}
    """Numbers of the device that a fault takes for others."""
    taken: ClassVar[Mapping[Path, Any]] = {}
    """Numbers of the case that a port takes for others."""
    read_by: ClassVar[tuple[str, ...]] = ()
    """Methods whose results these change, as if they were overridden."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """The case; `inputs`: what it hands over besides scene and parameters."""
        of = {"scene": scene, "params": params}
        for (root, *path), value in self.taken.items():
            of[str(root)] = changed(of[str(root)], tuple(path), value)
        self.scene, self.params = of["scene"], of["params"]
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
