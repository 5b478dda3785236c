"""Stage 4: the map as a texture on everything that is seen."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.shadows.lights import Lights
from ibr_ref.oracle.ports.shadows.raster import Raster
from ibr_ref.oracle.ports.shadows.sampler import Sampler
from ibr_ref.oracle.ports.shadows.surface import Surface

TEXTURE_FROM_NDC = np.array([[0.5, 0.0, 0.0, 0.5], [0.0, -0.5, 0.0, 0.5], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""s to the right, t downwards, both in [0, 1]."""


class Project(Lights):
    """Texture coordinates from world positions, and what the map says there."""

    def projected(self, surface: Surface, place: Floats, image: Floats) -> tuple[Floats, Floats]:
        """coord (N, 3) and shadow (N,) of the fragments, for one sample of the light."""
        q = self.texture_coordinates(surface.world, place)
        s, t, r = self.divided(q)
        r = self.clamped(r)
        shadow = np.zeros(len(s))
        lit = np.flatnonzero(self.in_map(s, t) & self.before_light(q[3]))
        shadow[lit] = self.shadow(image, s[lit], t[lit], r[lit])
        return np.stack([s, t, r], axis=-1), np.where(self.exempt(surface.casts), 0.0, shadow)

    def texture_coordinates(self, world: list[Floats], place: Floats) -> list[Floats]:
        """q, four (N,): the three matrices one after another."""
        raster = Raster(self.ops)
        q = [*world, np.ones_like(world[0])]
        for matrix in (self.projecting_view(place), self.clip_from_light, self.texture_matrix()):
            q = raster.transform(matrix, q)
        return q

    def projecting_view(self, place: Floats) -> Floats:
        """(4, 4) view_from_world of the sample whose map is projected."""
        return self.light_view(place)

    def texture_matrix(self) -> Floats:
        """(4, 4) from the light's NDC to (s, t, r): the bias matrix."""
        return TEXTURE_FROM_NDC

    def divided(self, q: list[Floats]) -> list[Floats]:
        """s, t, r."""
        return [self.ops.divide(component, q[3]) for component in q[:3]]

    def clamped(self, r: Floats) -> Floats:
        """Depth in the light's range."""
        return np.clip(r, 0.0, 1.0)

    def in_map(self, s: Floats, t: Floats) -> Bools:
        """Whether the map has something to say; its border belongs to it."""
        return (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)

    def before_light(self, w: Floats) -> Bools:
        """Whether it is on the side that the light looks to."""
        return w > 0.0

    def exempt(self, casts: Bools) -> Bools:
        """The caster's own fragments, which masks cannot tell from what lies behind them."""
        return casts if self.params.content == "mask" else np.zeros_like(casts)

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        """(N,) 0 lit to 1, within the map."""
        sampler = self.shadow_sampler(self.ops)
        if self.params.content == "mask":
            return sampler.bilinear(image, s, t)
        if not self.params.pcf:
            return self.compared(r, sampler.nearest(image, s, t))
        return self.filtered(sampler, image, s, t, r)

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        """The mix of four comparisons."""
        texels, fx, fy = sampler.taps(image, s, t)
        return sampler.mix([self.compared(r, texel) for texel in texels], fx, fy)

    def compared(self, r: Floats, texel: Floats) -> Floats:
        """1 where something is nearer to the light."""
        here = self.biased(r)
        if self.params.quantize is not None:
            here, texel = self.quantized(here), self.quantized(texel)
        return np.where(self.behind(here, texel), 1.0, 0.0)

    def biased(self, r: Floats) -> Floats:
        """Depth, as it is compared."""
        return self.ops.subtract(r, self.ops.number(self.params.bias))

    def quantized(self, depth: Floats) -> Floats:
        """Steps of 8 bits."""
        return np.floor(self.ops.add(self.ops.multiply(depth, 255.0), 0.5))

    def behind(self, here: Floats, texel: Floats) -> Bools:
        """The comparison."""
        return here > texel
