"""The texture unit of a device: fetches of one channel."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.programs.program import Floats, Ints, right


class Sampler:
    """Clamped fetches from images (H, W) at (u, v) in [0, 1], row 0 at v = 0."""

    def __init__(self, do: Any) -> None:
        self.do = do

    def wrap(self, index: Ints, size: int) -> Ints:
        """The texel that an index means."""
        return np.clip(index, 0, size - 1)

    def position(self, u: Floats, size: int) -> Floats:
        """In texels, from the centre of the first."""
        return self.do.subtract(self.do.multiply(u, size), 0.5)

    def index(self, u: Floats, size: int) -> Ints:
        """The texel that holds u."""
        return self.do.whole(self.do.multiply(u, size)).astype(np.int64)

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
        left, top = self.do.whole(x), self.do.whole(y)
        column, row = left.astype(np.int64), top.astype(np.int64)
        texels = [self.texel(image, column + i, row + j) for j in (0, 1) for i in (0, 1)]
        return texels, self.do.weight(self.do.subtract(x, left)), self.do.weight(self.do.subtract(y, top))

    def mix(self, texels: list[Floats], fx: Floats, fy: Floats) -> Floats:
        """Of four texels by their weights."""
        upper, lower = (self.do.filtered(self.do.lerp(texels[k], texels[k + 1], fx), texels) for k in (0, 2))
        return self.do.filtered(self.do.lerp(upper, lower, fy), texels)

    def bilinear(self, image: Floats, u: Floats, v: Floats) -> Floats:
        """The mix of the four texels around. Of the right filter the bounds are known as a whole."""
        if self.do.bounded and right(self, "wrap", "position", "texel", "taps", "mix"):
            return self.do.fetch(image, u, v, repeat=False)
        return self.mix(*self.taps(image, u, v))
