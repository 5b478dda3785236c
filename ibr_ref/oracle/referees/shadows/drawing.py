"""A pass of a program on numbers with bounds: its triangles in a window, and what is interpolated over them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.coverage import Fragments, fragments
from ibr_ref.oracle.accept.seams import Owners, owners
from ibr_ref.oracle.accept.winners import Winners, winners
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.programs.shadows.raster import Raster
from ibr_ref.oracle.referees.shadows.clipping import Cut, clipped
from ibr_ref.oracle.referees.shadows.model import Model, stacked
from ibr_ref.oracle.referees.shadows.transform import gamma
from ibr_ref.oracle.referees.shadows.varyings import Triangles, linear, perspective


@dataclass(frozen=True, eq=False)
class Varyings:
    """What a program asks of its rasterizer once it knows its fragments."""

    model: Model
    raster: Raster
    triangles: Triangles

    def linear(self, found: Fragments, corners: Number) -> Number:
        """(n,) of values (T, 3): linear in the window."""
        (result,) = linear(self.triangles, found, [self.model.bounded(corners)])
        return self.model.number(result)

    def perspective(self, found: Fragments, w: Number, varyings: Sequence[Number]) -> list[Number]:
        """Each (n,), of values (T, 3) at corners whose clip w is (T, 3): linear in space."""
        corners = [self.model.bounded(varying) for varying in varyings]
        return self.model.numbers(perspective(self.triangles, found, corners, self.model.bounded(w)))


@dataclass(frozen=True, eq=False)
class Pass:
    """Triangles on their way through a program's rasterizer."""

    model: Model
    raster: Raster
    width: int
    height: int

    def cut(self, numbers: Sequence[Bounded], triangles: NDArray[np.integer], names: Ints) -> Cut:
        """Clipped; numbers (V,): x, y, z, w and attributes."""
        size = self.width, self.height
        return clipped(numbers, triangles, names, size, self.window, self.raster.planes)

    @property
    def shift(self) -> float:
        """How far the pixels that are looked at lie from where the reference has them."""
        return 0.5 - float(self.raster.centre(np.zeros((), np.int64)))

    def window(self, clip: Sequence[Bounded]) -> list[Bounded]:
        """Window x, y and depth, as if the pixels that are looked at were where the reference has them."""
        corners = stacked([self.model.number(c) for c in clip], axis=-1)
        with np.errstate(all="ignore"):
            x, y, z = (self.model.bounded(c) for c in self.raster.window(corners, self.width, self.height))
        shift = self.shift
        # From [-1, 1]: a quotient, a half and a sum, of numbers up to 1.
        depth = z.widened(gamma(z.device, 2.0, 1.0)) if z.device.minus_one else z
        return [Bounded(x.value + shift, x.error, x.device), Bounded(y.value + shift, y.error, y.device), depth]

    def cover(self, x: Bounded, y: Bounded) -> Fragments:
        """The pixels that triangles (T, 3) may cover."""
        return fragments(x, y, self.width, self.height, owns_border=self.owns_border)

    def owns_border(self, dx: int, dy: int) -> bool:
        """Whether pixels on an edge belong to the triangle on its right hand."""
        owned = self.raster.owned(np.asarray(dx), np.asarray(dy))
        return bool(self.raster.inside(np.zeros((), np.int64), owned))

    def varyings(self, cut: Cut) -> Varyings:
        """Over what is left of triangles."""
        return Varyings(self.model, self.raster, Triangles.of(cut.x, cut.y, self.width, self.height, cut.setups))

    def owners(self, found: Fragments, names: Ints) -> Owners:
        """Which fragments are one."""
        return owners(found, names, self.width)

    def winners(self, pixel: Ints, drawn: Bools, depth: Bounded, owner: Ints) -> Winners:
        """By the program's depth test: LESS, or one by which the farther fragment stays."""
        farther = bool(self.raster.passes(np.asarray(0.75), np.asarray(0.25)))
        low, high = (1.0 - depth.high, 1.0 - depth.low) if farther else (depth.low, depth.high)
        return winners(pixel, drawn, low, high, self.width * self.height, owner=owner)


def names_of(points: Any) -> Ints:
    """(V,) one number for vertices (V, 3) that are one point."""
    return np.unique(np.asarray(points, np.float64), axis=0, return_inverse=True)[1].reshape(-1)


def pixels_of(found: Fragments, width: int) -> Ints:
    """(n,) row * width + column."""
    return found.rows * width + found.columns


def weights_inside(found: Fragments) -> Bools:
    """(n,) whether the pixel is inside in exact arithmetic."""
    return np.asarray((found.weights >= 0.0).all(axis=1))
