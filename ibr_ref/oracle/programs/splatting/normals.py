"""Stage 1, once per reference image and on its own: normals from the neighbours' positions, in 8 bits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Image, Ints, Vector
from ibr_ref.oracle.programs.splatting.unproject import Unprojection

COLUMNS, ROWS = 1, 0
"""The axes of an image's arrays along which neighbours are sought."""
JUMP = 0.05
"""Neighbours farther apart than this share of the depth lie on different surfaces (splatting/method.md, "Stage normals")."""


@dataclass(frozen=True)
class Surface:
    """An image's pixels as points, row by row, (H W,) each; off the mask at depth 1, where they mean nothing."""

    image: Image
    mask: Bools
    """(H, W)."""
    depth: Floats
    world: Vector


class Preparation(Unprojection):
    """World-space normals: what authors compute before all, by a program of their own."""

    def codes(self, image: Image) -> NDArray[np.uint8]:
        """(H, W, 3) of one image; off the mask as `unused` has it."""
        surface = self.surface(image)
        here = np.flatnonzero(surface.mask)
        codes = np.full((surface.mask.size, 3), self.unused(), np.uint8)
        codes[here] = np.stack(self.codes_at(surface, here), axis=1)
        return codes.reshape(*surface.mask.shape, 3)

    def surface(self, image: Image) -> Surface:
        """The points of an image."""
        _, depth, mask = image.arrays
        rows, columns = (index.reshape(-1) for index in np.indices(depth.shape))
        uploaded = self.do.texels(np.where(mask, depth, 1.0).reshape(-1))
        return Surface(image, mask, uploaded, self.world_point(image, columns, rows, uploaded))

    def codes_at(self, surface: Surface, pixel: Ints) -> Vector:
        """The codes of pixels that are points."""
        points = self.do.rows(surface.world, pixel)
        across, down = (self.difference(surface, pixel, points, axis) for axis in (COLUMNS, ROWS))
        towards = self.towards(self.seen_from(surface.image.camera), points)
        return [self.encode(value) for value in self.normal(self.cross(across, down), towards)]

    def difference(self, surface: Surface, pixel: Ints, points: Vector, axis: int) -> Vector:
        """From each point to its neighbour along an axis; NaN where none is usable."""
        (next_pixel, next_there), (last_pixel, last_there) = (
            self.neighbour(surface, pixel, axis, step) for step in (1, -1)
        )
        depth, next_depth, last_depth = (self.do.rows(surface.depth, at) for at in (pixel, next_pixel, last_pixel))
        next_gap, last_gap = (np.abs(self.do.subtract(other, depth)) for other in (next_depth, last_depth))
        side, other = ("right", "left") if axis == COLUMNS else ("below", "above")
        next_usable = self.do.told(f"{side}: |dz| <= 0.05 z", self.usable(next_gap, depth) & next_there)
        last_usable = self.do.told(f"{other}: |dz| <= 0.05 z", self.usable(last_gap, depth) & last_there)
        alike = self.do.alike(next_depth, last_depth)  # whose gaps are one number on every device
        prefers = self.do.told(f"{side} as near as {other}", self.prefers_next(next_gap, last_gap, alike))
        forward = np.asarray(next_usable & (~last_usable | prefers))
        some = np.asarray(forward | last_usable)
        ways = zip(self.do.rows(surface.world, np.where(forward, next_pixel, last_pixel)), points, strict=True)
        return [np.where(some, self.do.subtract(there, here), np.nan) for there, here in ways]

    def neighbour(self, surface: Surface, pixel: Ints, axis: int, step: int) -> tuple[Ints, Bools]:
        """The neighbours of pixels, and which are there: on the image and its mask."""
        height, width = surface.mask.shape
        row, column = np.divmod(pixel, width)
        row, column = (row + step, column) if axis == ROWS else (row, column + step)
        inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
        at = np.where(inside, row * width + column, pixel)
        return at, inside & surface.mask.reshape(-1)[at]

    def usable(self, gap: Floats, depth: Floats) -> Bools:
        """Whether a neighbour lies on the same surface."""
        return gap <= self.do.multiply(self.do.number(JUMP), depth)

    def prefers_next(self, next_gap: Floats, last_gap: Floats, alike: Bools) -> Bools:
        """Of two usable neighbours, whether the right or lower one counts; of those that are `alike` it does."""
        return (next_gap <= last_gap) | alike

    def seen_from(self, camera: Any) -> Any:
        """(4,) the homogeneous eye that normals face: the reference camera's."""
        return camera.eye

    def normal(self, cross: Vector, towards: Vector) -> Vector:
        """Unit normals that face the eye; towards it where there is no product."""
        zero = (cross[0] == 0.0) & (cross[1] == 0.0) & (cross[2] == 0.0)
        none = np.asarray(zero | self.do.missing(cross[0]))
        unit = self.normalized(cross)
        away = np.asarray(self.do.told("faces away", self.faces_away(self.do.dot(unit, towards)) & ~none))
        lone = self.without_neighbours(towards)
        return [np.where(none, alone, np.where(away, -x, x)) for alone, x in zip(lone, unit, strict=True)]

    def normalized(self, cross: Vector) -> Vector:
        """Unit vectors of products."""
        return self.do.unit(cross)

    def faces_away(self, cosine: Floats) -> Bools:
        """Whether a normal is turned round; the cosine is that to the line of sight."""
        return cosine < 0.0

    def without_neighbours(self, towards: Vector) -> Vector:
        """The normals of points that no pair of neighbours belongs to."""
        return towards

    def encode(self, value: Floats) -> Floats:
        """The code of a coordinate from -1 to 1."""
        return np.floor(self.do.dot([127.0, 128.5], [value, 1.0]))

    def unused(self) -> int:
        """The code off the mask."""
        return 0
