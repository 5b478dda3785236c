"""Bounds with a texture unit and what rasterizers do by themselves: all that a program calls."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Ints
from ibr_ref.oracle.accept.coverage import RASTER
from ibr_ref.oracle.accept.fetch import Texture
from ibr_ref.oracle.arithmetic.bounds import Bounds
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.pipeline.texture import below_highest, fetch, texel_position

SETUP_QUOTIENTS, SETUP_OPERATIONS = 2.0, 5.0
"""Of a rasterizer's depth against z / w of the vertex stage: a division in either; the viewport's product and sum, and the
plane's two products and sum. All of them on numbers of at most 1."""


class Machine(Bounds):
    """A device."""

    def __init__(self, device: Device) -> None:
        self._textures: dict[Any, tuple[Any, Texture]] = {}
        super().__init__(device)

    @contextmanager
    def one_place(self) -> Iterator[None]:
        """Fetches at the same coordinate are so at the same texel position, rounding and all."""
        self.run.positions = {}
        try:
            yield
        finally:
            self.run.positions = None

    def fetch(self, texels: Any, u: Any, v: Any, repeat: bool) -> Number:
        """Bilinear. Texels that have bounds are mixed as their values are."""
        if isinstance(texels, Number):
            found = self.fetch(texels.value, u, v, repeat)
            if not np.any(texels.deviation):
                return found
            off = self.fetch(np.array(np.broadcast_to(texels.deviation, texels.shape)), u, v, repeat).high
            return found.off_by(off)
        texture = self._texture(texels, repeat)
        height, width = texture.texels.shape[:2]
        return fetch(
            self, texture, *(self._position(self.of(x), size, repeat) for x, size in ((u, width), (v, height)))
        )

    def below_highest(self, texels: Any, u: Any, v: Any, h: Any, repeat: bool) -> Ints:
        """The samples that are not certainly above every texel around them."""
        return below_highest(self, self._texture(texels, repeat), self.of(u), self.of(v), self.of(h))

    def snap(self, window: Any) -> Number:
        """A window position on the raster, as the reference has it; what devices do otherwise is in their borders."""
        return self.rising(lambda x: np.rint(RASTER * x) / RASTER, window)

    def border(self, x: Any, sides: float = 1.0) -> Number:
        """What may be off by the borders that devices give to splats, as many."""
        return self.of(x).off_by(sides * self.device.splat_border)

    def flat_depth(self, depth: Any) -> Number:
        """The depth of a primitive that has one, as the depth buffer holds it.

        The conventions' holds the very number, rounded to a float32; a rasterizer computes its own.
        """
        x, device = self.of(depth), self.device
        if not device.subpixel_any:
            return self.rounded(x, 1.0)
        units = SETUP_QUOTIENTS * device.quotient + SETUP_OPERATIONS * device.operation
        size = 1.0 if device.minus_one else np.abs(x.value)
        return x.off_by(units * UNIT * size + device.depth_step)

    def halfway(self, a: Any, b: Any) -> Number:
        """(a + b)/2 not rounded: whether -w <= 2 z - w <= w is whether 0 <= z <= w."""
        between = self.of(a).plus(b)
        return Number.of_rows(self, 0.5 * between.rows, between.names, between.lane)

    def _texture(self, texels: Any, repeat: bool) -> Texture:
        key = texels.__array_interface__["data"][0], texels.shape, texels.strides, repeat
        if key not in self._textures:
            self._textures[key] = texels, Texture(np.asarray(texels), repeat)
        return self._textures[key][1]

    def _position(self, coordinate: Number, size: int, repeat: bool) -> Number:
        positions = self.run.positions
        if positions is None:
            return texel_position(self, coordinate, size, repeat)
        key = id(coordinate), size, repeat
        if key not in positions:
            positions[key] = coordinate, self.named("texel", texel_position(self, coordinate, size, repeat))
        found: Number = positions[key][1]
        return found
