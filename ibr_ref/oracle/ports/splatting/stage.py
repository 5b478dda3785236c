"""What every stage of the port has at hand: the device's arithmetic, the scene and the parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.oracle.arithmetic.device import Arithmetic

Vector = Sequence[Floats]
"""Coordinates, or channels, of many points: an array each."""


class Stage:
    """A shader with its uniforms."""

    def __init__(self, alu: Arithmetic, scene: Any, params: Any) -> None:
        self.alu = alu
        self.scene = scene
        self.params = params

    def transform(self, matrix: ArrayLike, point: Sequence[ArrayLike]) -> list[Floats]:
        """The four rows of a matrix (4, 4) applied to a point (x, y, z, 1), each summed from left to right."""
        return [self.alu.dot(row, [*point, 1.0]) for row in self.alu.number(matrix)]

    def towards(self, source: ArrayLike, point: Vector) -> list[Floats]:
        """Unit vectors from points to a homogeneous source (4,): an eye, or a light. One at infinity is one already."""
        *place, w = self.alu.number(source)
        if w == 0.0:
            return [self.alu.add(value, 0.0 * x) for value, x in zip(place, point, strict=True)]
        return self.alu.unit([self.alu.subtract(value, x) for value, x in zip(place, point, strict=True)])
