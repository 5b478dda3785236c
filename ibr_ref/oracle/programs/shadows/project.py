"""Stage 4: the map as a texture on everything that is seen."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats as Array
from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.lights import Lights, Matrix
from ibr_ref.oracle.programs.shadows.sampler import Sampler
from ibr_ref.oracle.programs.shadows.surface import Surface

TEXTURE_FROM_NDC = np.array([[0.5, 0.0, 0.0, 0.5], [0.0, -0.5, 0.0, 0.5], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""s to the right, t downwards, both in [0, 1]."""


class Project(Lights):
    """Texture coordinates from world positions, and what the map says there."""

    def projected(self, surface: Surface, place: Floats, image: Floats) -> tuple[Floats, Floats]:
        """coord (N, 3) and shadow (N,) of the fragments, for one sample of the light."""
        s, t, r, w = self.coordinates(surface.world, place)
        return np.stack([s, t, r], axis=-1), self.shadowed(image, [s, t, r, w], surface.casts)

    def coordinates(self, world: Vector, place: Floats) -> Vector:
        """s, t, r and q_w, (N,) each."""
        q = self.texture_coordinates(world, place)
        s, t, r = self.divided(q)
        return [s, t, self.clamped(r), q[3]]

    def shadowed(self, image: Floats, at: Vector, casts: Bools) -> Floats:
        """(N,) what the map says at s, t, r and q_w."""
        s, t, r, w = at
        lit = np.flatnonzero(self.in_map(s, t) & self.before_light(w))
        shadow = self.do.spread(self.shadow(image, s[lit], t[lit], r[lit]), lit, len(casts), 0.0)
        return np.where(self.exempt(casts), 0.0, shadow)

    def texture_coordinates(self, world: Vector, place: Floats) -> Vector:
        """q, four (N,): the three matrices one after another, or their product."""
        q = self.one_after_another(world, place)
        return self.do.either(q, lambda: self.by_one_matrix(world, place)) if self.right("one_after_another") else q

    def one_after_another(self, world: Vector, place: Floats) -> Vector:
        """View, projection and bias matrix in turn."""
        clip = self.clip_coordinates(self.light_projection, self.projecting_view(place), world)
        return self.applied(self.do.matrix(self.texture_matrix()), clip)

    def by_one_matrix(self, world: Vector, place: Floats) -> Vector:
        """By the product of all three."""
        texture_from_light = self.product(self.do.matrix(self.texture_matrix()), self.do.matrix(self.light_projection))
        return self.by_product(texture_from_light, self.projecting_view(place), world)

    def projecting_view(self, place: Floats) -> Matrix:
        """view_from_world of the sample whose map is projected."""
        return self.light_view(place)

    def texture_matrix(self) -> Array:
        """(4, 4) from the light's NDC to (s, t, r): the bias matrix."""
        return TEXTURE_FROM_NDC

    def divided(self, q: Vector) -> Vector:
        """s, t, r."""
        return [self.do.divide(component, q[3]) for component in q[:3]]

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
        sampler = self.shadow_sampler(self.do)
        if self.params.content == "mask":
            return sampler.bilinear(image, s, t)
        if not self.params.pcf:
            return self.compared(r, sampler.nearest(image, s, t))
        return self.filtered(sampler, image, s, t, r)

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        """The mix of four comparisons."""
        texels, fx, fy = sampler.taps(image, s, t)
        return self.do.of_bytes(sampler.mix([self.compared(r, texel) for texel in texels], fx, fy))

    def compared(self, r: Floats, texel: Floats) -> Floats:
        """1 where something is nearer to the light."""
        here = self.biased(r)
        if self.params.quantize is not None:
            here, texel = self.quantized(here), self.quantized(texel)
        return np.where(self.behind(here, texel), 1.0, 0.0)

    def biased(self, r: Floats) -> Floats:
        """Depth, as it is compared."""
        here = self.do.subtract(r, self.do.number(self.params.bias))
        return self.do.widened(here, operations=1) if self.params.bias else here  # or r > texel + bias

    def quantized(self, depth: Floats) -> Floats:
        """Steps of 8 bits."""
        return np.floor(self.do.add(self.do.multiply(depth, 255.0), 0.5))

    def behind(self, here: Floats, texel: Floats) -> Bools:
        """The comparison."""
        return here > texel
