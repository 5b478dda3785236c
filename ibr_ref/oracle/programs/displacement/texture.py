"""The texture unit: bilinear fetches with two wrap modes."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Case, Floats, Ints, Patch, Vector

FILTER = ("fetch", "texel_and_weight", "texel_position", "wrapped", "bilinear", "lerp")
"""The methods that a fetch is made of."""


class TextureUnit(Case):
    """Fetches from a texture (rows, columns) or (rows, columns, channels) at (u, v)."""

    def height_at(self, patch: Patch, u: Floats, v: Floats) -> Floats:
        """H(u, v)."""
        return self.fetch(patch.heights, u, v, patch.repeat)

    def color_at(self, patch: Patch, u: Floats, v: Floats) -> Vector:
        """The colour map."""
        return list(self.fetch(patch.colors, u, v, patch.repeat).T)

    def fetch(self, texture: Floats, u: Floats, v: Floats, repeat: bool) -> Floats:
        """Bilinear: (F,), or (F, channels). Of the right filter the bounds are known as a whole."""
        if self.do.bounded and self.right(*FILTER):
            return self.do.fetch(texture, u, v, repeat)
        rows, columns = texture.shape[:2]
        column, fx = self.texel_and_weight(u, columns)
        row, fy = self.texel_and_weight(v, rows)
        left, right = self.wrapped(column, columns, repeat), self.wrapped(column + 1.0, columns, repeat)
        upper, lower = self.wrapped(row, rows, repeat), self.wrapped(row + 1.0, rows, repeat)
        fx, fy = self.do.named("f_x", fx), self.do.named("f_y", fy)  # both f and 1 - f are factors
        if texture.ndim == 3:
            fx, fy = fx[:, np.newaxis], fy[:, np.newaxis]
        texels = (texture[upper, left], texture[upper, right], texture[lower, left], texture[lower, right])
        return self.do.settled(self.bilinear(texels, fx, fy), u, v)

    def texel_and_weight(self, coordinate: Floats, size: int) -> tuple[Floats, Floats]:
        """The texel whose centre lies at or before a coordinate, and the way from there to the next, in texels."""
        position = self.texel_position(coordinate, size)
        texel = self.do.whole(position)
        return texel, self.do.weight(self.do.subtract(position, texel))

    def texel_position(self, coordinate: Floats, size: int) -> Floats:
        """Texture coordinates in texels, from the first one's centre."""
        return self.multiply_add(coordinate, float(size), -0.5)

    def wrapped(self, texel: Floats, size: int, repeat: bool) -> Ints:
        """The texel's index by the wrap mode."""
        index = np.mod(texel, size) if repeat else np.clip(texel, 0, size - 1)
        return index.astype(np.int64)

    def bilinear(self, texels: tuple[Floats, Floats, Floats, Floats], fx: Floats, fy: Floats) -> Floats:
        """The mean of four texels: t00, t10, t01, t11, tXY with X to the right and Y down."""
        t00, t10, t01, t11 = texels
        upper, lower = (self.do.filtered(self.lerp(a, b, fx), texels) for a, b in ((t00, t10), (t01, t11)))
        return self.do.filtered(self.lerp(upper, lower, fy), texels)

    def lerp(self, a: Floats, b: Floats, f: Floats) -> Floats:
        """A (1 - f) + b f."""
        return self.do.lerp(a, b, f)
