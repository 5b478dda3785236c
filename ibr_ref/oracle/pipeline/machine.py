"""Bounds with a texture unit: all that a shader's program calls."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ibr_ref.array_types import Ints
from ibr_ref.oracle.accept.fetch import Texture
from ibr_ref.oracle.arithmetic.bounds import Bounds
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.pipeline.texture import below_highest, fetch, texel_position


class Machine(Bounds):
    """A device."""

    def __init__(self, device: Device) -> None:
        self._textures: dict[Any, tuple[Any, Texture]] = {}
        self._positions: dict[Any, tuple[Number, Number]] | None = None
        super().__init__(device)

    @contextmanager
    def one_place(self) -> Iterator[None]:
        """Fetches at the same coordinate are so at the same texel position, rounding and all."""
        self._positions = {}
        try:
            yield
        finally:
            self._positions = None

    def fetch(self, texels: Any, u: Any, v: Any, repeat: bool) -> Number:
        """Bilinear."""
        texture = self._texture(texels, repeat)
        height, width = texture.texels.shape[:2]
        return fetch(self, texture, self._position(self.of(u), width), self._position(self.of(v), height))

    def below_highest(self, texels: Any, u: Any, v: Any, h: Any, repeat: bool) -> Ints:
        """The samples that are not certainly above every texel around them."""
        return below_highest(self, self._texture(texels, repeat), self.of(u), self.of(v), self.of(h))

    def _texture(self, texels: Any, repeat: bool) -> Texture:
        key = texels.__array_interface__["data"][0], texels.shape, texels.strides, repeat
        if key not in self._textures:
            self._textures[key] = texels, Texture(np.asarray(texels), repeat)
        return self._textures[key][1]

    def _position(self, coordinate: Number, size: int) -> Number:
        if self._positions is None:
            return texel_position(self, coordinate, size)
        key = id(coordinate), size
        if key not in self._positions:
            position = self.named("texel", texel_position(self, coordinate, size))
            self._positions[key] = coordinate, position
        return self._positions[key][1]
