"""What the port is given, as it is uploaded to the device, and the vector arithmetic that all stages share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Program, Vector

__all__ = ["Bools", "Case", "Floats", "Ints", "Patch", "Vector"]


@dataclass(frozen=True, kw_only=True)
class Patch:
    """A base polygon on the device, with the eye and the light in its patch space."""

    number: int
    corner: Vector
    edge_u: Vector
    edge_v: Vector
    normal: Vector
    up: Vector
    """s n."""
    rows: Sequence[Vector]
    """The reciprocal basis of (U, V, s n); the first two are U* and V* as well."""
    eye: Vector
    """(u, v, h, 1), or the direction towards it (u, v, h, 0)."""
    light: Vector
    scale: Floats
    repeat: bool
    heights: Floats
    colors: Floats
    normals: Floats | None
    facade: Floats | None
    facade_tile: Vector


class Case(Program):
    """The uniforms and textures of a scene, and operations on vectors."""

    floor: ClassVar[float] = 0.0
    """h of the volume's bottom."""

    def __init__(self, scene: Any, params: Any, policy: Policy, inputs: dict[str, Any]) -> None:
        """A displacement scene and its parameters; `inputs` is not used: the scene holds everything."""
        self.width: int = scene.camera.width
        self.height: int = scene.camera.height
        super().__init__(scene, params, policy, inputs)

    def on(self, do: Any) -> Self:
        """On another arithmetic: a device's, or bounds of what devices make of it."""
        super().on(do)
        self.multiplied: dict[int, tuple[Patch, list[Vector], list[Vector]]] = {}
        camera = self.scene.camera
        self.view_from_world, self.clip_from_view = do.matrix(camera.view_from_world), do.matrix(camera.clip_from_view)
        self.eye, self.light = self.upload(camera.eye), self.upload(self.scene.light.homogeneous)
        return self

    def upload(self, vector: Floats) -> Vector:
        """A vector in a uniform buffer."""
        return list(self.do.number(vector))

    def above_floor(self, h: Floats) -> Floats:
        """Heights above the volume's bottom."""
        return self.do.subtract(h, self.floor) if self.floor else h

    def multiply_add(self, a: Floats, b: Floats, c: Floats) -> Floats:
        """A b + c."""
        return self.do.dot([c, a], [1.0, b])

    def scaled(self, a: Vector, factor: Floats) -> Vector:
        """A vector times a number."""
        return [self.do.multiply(x, factor) for x in a]

    def combined(self, vectors: Sequence[Vector], factors: Sequence[Floats]) -> Vector:
        """The sum of vectors times numbers."""
        return [self.do.dot([vector[k] for vector in vectors], factors) for k in range(len(vectors[0]))]

    def towards(self, goal: Vector, point: Vector) -> Vector:
        """The way from points to a homogeneous goal (x, y, z, w): goal - w point. A direction needs no point."""
        if goal[3] == 0.0:
            return [self.do.in_lanes(x, point[0]) for x in goal[:3]]
        return [self.do.subtract(x, p) for x, p in zip(goal[:3], point, strict=True)]
