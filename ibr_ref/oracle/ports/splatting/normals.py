"""Stage 1, once per reference image: normals from the neighbours' positions, in 8 bits."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.stage import Vector
from ibr_ref.oracle.ports.splatting.unproject import Unprojection

COLUMNS, ROWS = 1, 0
"""The axes of an image's arrays along which neighbours are sought."""


class Normals(Unprojection):
    """World-space normals."""

    def codes(self, image: Any) -> NDArray[np.uint8]:
        """(H, W, 3) of one image; (0, 0, 0) off the mask."""
        _, depth, mask = image.arrays
        depth = np.where(mask, self.alu.number(depth), np.nan)
        rows, columns = np.indices(depth.shape)
        points = self.world_point(image.camera, self.view_point(image.camera, columns, rows, depth))
        across, down = (self.difference(points, depth, axis) for axis in (COLUMNS, ROWS))
        towards = self.towards(self.seen_from(image.camera), points)
        normal = self.normal(self.cross(across, down), towards)
        codes = np.stack([self.encode(value) for value in normal], axis=2)
        return np.where(mask[:, :, None], codes, self.unused()).astype(np.uint8)

    def difference(self, points: Vector, depth: Floats, axis: int) -> list[Floats]:
        """From each point to its neighbour along an axis; NaN where none is usable."""
        next_depth, last_depth = (self.neighbour(depth, axis, step) for step in (1, -1))
        next_gap, last_gap = (np.abs(self.alu.subtract(other, depth)) for other in (next_depth, last_depth))
        next_usable, last_usable = self.usable(next_gap, depth), self.usable(last_gap, depth)
        forward = next_usable & (~last_usable | self.prefers_next(next_gap, last_gap))
        result = []
        for values in points:
            other = np.where(forward, self.neighbour(values, axis, 1), self.neighbour(values, axis, -1))
            result.append(np.where(forward | last_usable, self.alu.subtract(other, values), np.nan))
        return result

    def neighbour(self, values: Floats, axis: int, step: int) -> Floats:
        """(H, W) each pixel's neighbour's values; NaN off the image."""
        shifted = np.roll(values, -step, axis)
        edge = [slice(None), slice(None)]
        edge[axis] = slice(-1, None) if step > 0 else slice(0, 1)
        shifted[tuple(edge)] = np.nan
        return shifted

    def usable(self, gap: Floats, depth: Floats) -> Bools:
        """Whether a neighbour lies on the same surface; one that is NaN does not."""
        return np.asarray(gap <= self.alu.multiply(self.alu.number(0.05), depth))

    def prefers_next(self, next_gap: Floats, last_gap: Floats) -> Bools:
        """Of two usable neighbours, whether the right or lower one counts."""
        return np.asarray(next_gap <= last_gap)

    def cross(self, a: Vector, b: Vector) -> list[Floats]:
        """The cross product."""
        return [self.alu.dot([a[i], -a[j]], [b[j], b[i]]) for i, j in ((1, 2), (2, 0), (0, 1))]

    def seen_from(self, camera: Any) -> ArrayLike:
        """(4,) the homogeneous eye that normals face: the reference camera's."""
        eye: ArrayLike = camera.eye
        return eye

    def normal(self, cross: Vector, towards: Vector) -> list[Floats]:
        """Unit normals that face the eye; towards it where there is no product."""
        none = np.isnan(cross[0]) | ((cross[0] == 0.0) & (cross[1] == 0.0) & (cross[2] == 0.0))
        unit = self.normalized(cross)
        sign = np.where(self.faces_away(self.alu.dot(unit, towards)), -1.0, 1.0)
        lone = self.without_neighbours(towards)
        return [np.where(none, alone, sign * value) for alone, value in zip(lone, unit, strict=True)]

    def normalized(self, cross: Vector) -> list[Floats]:
        """Unit vectors of products."""
        return self.alu.unit(cross)

    def faces_away(self, cosine: Floats) -> Bools:
        """Whether a normal is turned round; the cosine is that to the line of sight."""
        return np.asarray(cosine < 0.0)

    def without_neighbours(self, towards: Vector) -> Vector:
        """The normals of points that no pair of neighbours belongs to."""
        return towards

    def encode(self, value: Floats) -> Floats:
        """The code of a coordinate from -1 to 1."""
        return np.floor(self.alu.dot([127.0, 128.5], [value, 1.0]))

    def unused(self) -> int:
        """The code off the mask."""
        return 0
