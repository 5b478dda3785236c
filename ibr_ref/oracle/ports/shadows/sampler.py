"""The texture unit of a device: fetches of one channel."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats, Ints
from ibr_ref.oracle.arithmetic.device import Arithmetic


class Sampler:
    """Clamped fetches from images (H, W) at (u, v) in [0, 1], row 0 at v = 0."""

    def __init__(self, ops: Arithmetic) -> None:
        self.ops = ops

    def wrap(self, index: Ints, size: int) -> Ints:
        """The texel that an index means."""
        return np.clip(index, 0, size - 1)

    def position(self, u: Floats, size: int) -> Floats:
        """In texels, from the centre of the first."""
        return self.ops.subtract(self.ops.multiply(u, size), 0.5)

    def index(self, u: Floats, size: int) -> Ints:
        """The texel that holds u."""
        return np.floor(self.ops.multiply(u, size)).astype(np.int64)

    def texel(self, image: Floats, column: Ints, row: Ints) -> Floats:
        """As it is held."""
        height, width = image.shape
        return image[self.wrap(row, height), self.wrap(column, width)]

    def nearest(self, image: Floats, u: Floats, v: Floats) -> Floats:
        """The texel there."""
        height, width = image.shape
        return self.texel(image, self.index(u, width), self.index(v, height))

    def taps(self, image: Floats, u: Floats, v: Floats) -> tuple[list[Floats], Floats, Floats]:
        """The four texels around, t00, t10, t01, t11, and the weights of the right and the lower ones."""
        height, width = image.shape
        x, y = self.position(u, width), self.position(v, height)
        left, top = np.floor(x), np.floor(y)
        column, row = left.astype(np.int64), top.astype(np.int64)
        texels = [self.texel(image, column + i, row + j) for j in (0, 1) for i in (0, 1)]
        return texels, self.ops.weight(self.ops.subtract(x, left)), self.ops.weight(self.ops.subtract(y, top))

    def mix(self, texels: list[Floats], fx: Floats, fy: Floats) -> Floats:
        """Of four texels by their weights."""
        upper, lower = (self.ops.filtered(self.ops.lerp(texels[k], texels[k + 1], fx), texels) for k in (0, 2))
        return self.ops.filtered(self.ops.lerp(upper, lower, fy), texels)

    def bilinear(self, image: Floats, u: Floats, v: Floats) -> Floats:
        """The mix of the four texels around."""
        return self.mix(*self.taps(image, u, v))
