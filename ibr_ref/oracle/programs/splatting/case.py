"""What all stages of splatting share."""

from __future__ import annotations

from typing import Any

from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Program, Vector

__all__ = ["Bools", "Case", "Floats", "Image", "Ints", "Vector"]

Image = Any
"""A reference image, `scene.DepthImage`."""


class Case(Program):
    """The scene's cameras and lights, on the device."""

    @property
    def elliptic(self) -> bool:
        """Whether splats are ellipses whose colours are averaged."""
        return bool(self.params.shape == "ellipse")

    def towards(self, source: Any, point: Vector) -> Vector:
        """Unit vectors from points to a homogeneous source (4,): an eye, or a light. One at infinity is one already."""
        *place, w = self.do.number(source)
        if w == 0.0:
            way = [self.do.add(self.do.in_lanes(value, x), 0.0) for value, x in zip(place, point, strict=True)]
            return self.do.either(way, lambda: self.do.unit(way))
        return self.do.unit([self.do.subtract(value, x) for value, x in zip(place, point, strict=True)])
