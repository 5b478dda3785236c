"""Stages 5 and 6: the sum over the light's samples, and the colour."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.programs.program import Floats, Vector
from ibr_ref.oracle.programs.shadows.lights import Lights
from ibr_ref.oracle.programs.shadows.surface import Surface


class Resolve(Lights):
    """Blending and shading."""

    def accumulated(self, shadows: list[Floats]) -> Floats:
        """The sum of all samples' shadows, each times 1/N."""
        alpha, added = self.quantized_alpha(self.alpha(len(shadows))), self.contributions(shadows)
        total = self.summed(added, alpha, np.zeros(np.shape(shadows[0])))
        if self.params.accumulation == "float" and self.right("summed", "blended", "stored"):
            total = self.do.either(total, lambda: self.weighted(added, alpha))
            if self.right("alpha", "contributions"):
                total = self.do.either(total, lambda: self.mean(added))
        return self.do.either(np.minimum(total, 1.0), lambda: total)  # a float buffer does not saturate

    def mean(self, shadows: list[Floats]) -> Floats:
        """Divided by N at its end."""
        return self.do.divide(self.do.sum(shadows), float(len(shadows)))

    def summed(self, shadows: list[Floats], alpha: Floats, total: Floats) -> Floats:
        """One after another, onto what the buffer is cleared to."""
        for shadow in shadows:
            total = self.stored(self.blended(total, shadow, alpha))
        return total

    def weighted(self, shadows: list[Floats], alpha: Floats) -> Floats:
        """In any order."""
        return self.do.sum([self.do.multiply(shadow, alpha) for shadow in shadows])

    def quantized_alpha(self, alpha: Floats) -> Floats:
        """As the frame buffer's blending has it."""
        if self.params.accumulation == "float":
            return alpha
        return self.do.divide(np.floor(self.do.add(self.do.multiply(alpha, 255.0), 0.5)), 255.0)

    def alpha(self, count: int) -> Floats:
        """Weight of one sample."""
        return self.do.divide(1.0, count)

    def contributions(self, shadows: list[Floats]) -> list[Floats]:
        """In the order in which they are added."""
        return shadows[::-1] if self.do.backwards else shadows

    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        """GL_SRC_ALPHA, GL_ONE."""
        return self.do.dot([total, shadow], [1.0, alpha])

    def stored(self, value: Floats) -> Floats:
        """As the frame buffer that is blended into holds it."""
        if self.params.accumulation == "float":
            return value
        return self.do.blended_byte(value)

    def resolved(self, surface: Surface, shadow: Floats) -> Vector:
        """Channels: surface colour (ambient + (1 - ambient) (1 - shadow) max(0, n.l))."""
        return self.shaded(surface.color, shadow, self.cosine(surface.normal, surface.world))

    def shaded(self, color: Vector, shadow: Floats, cosine: Floats) -> Vector:
        """Channels of surfaces in a shadow, by the cosine of the light; or the sum of an ambient and a direct part."""
        return self.do.either(self.by_brightness(color, shadow, cosine), lambda: self.by_parts(color, shadow, cosine))

    def by_parts(self, color: Vector, shadow: Floats, cosine: Floats) -> Vector:
        """An ambient part, and a direct one."""
        do, ambient = self.do, self.ambient()
        light = do.multiply(self.visibility(shadow), do.multiply(self.direct_share(ambient), cosine))
        return [do.dot([channel, channel], [ambient, light]) for channel in color]

    def by_brightness(self, color: Vector, shadow: Floats, cosine: Floats) -> Vector:
        """Colours times a brightness."""
        ambient = self.ambient()
        direct = self.do.multiply(self.direct_share(ambient), self.visibility(shadow))
        brightness = self.do.add(ambient, self.do.multiply(direct, cosine))
        return [self.do.multiply(channel, brightness) for channel in color]

    def ambient(self) -> Floats:
        """Share of the light that reaches shadows."""
        return self.do.number(self.scene.ambient)

    def direct_share(self, ambient: Floats) -> Floats:
        """Share of the light that does not."""
        return self.do.subtract(1.0, ambient)

    def visibility(self, shadow: Floats) -> Floats:
        """Of the light."""
        return self.do.subtract(1.0, shadow)

    def cosine(self, normal: Vector, world: Vector) -> Floats:
        """max(0, n.l)."""
        normal = self.turned(normal, self.toward_eye(world))
        return self.lambert(self.do.dot(normal, self.toward_light(world)))

    def lambert(self, cosine: Floats) -> Floats:
        """Nothing from behind."""
        return np.maximum(cosine, 0.0)

    def toward_eye(self, world: Vector) -> Vector:
        """From the fragments, of any length."""
        *eye, w = self.do.number(self.scene.camera.eye)
        if w == 0.0:
            return [self.do.in_lanes(at, p) for p, at in zip(world, eye, strict=True)]
        return [self.do.subtract(at, p) for p, at in zip(world, eye, strict=True)]

    def toward_light(self, world: Vector) -> Vector:
        """Unit vectors from the fragments to the light's centre."""
        return self.do.unit([self.do.subtract(at, p) for p, at in zip(world, self.centre, strict=True)])

    def turned(self, normal: Vector, toward: Vector) -> Vector:
        """Normals on the side of a direction."""
        away = self.do.dot(normal, toward) < 0.0
        return [np.where(away, -component, component) for component in normal]

    def background(self) -> Floats:
        """(3,) where nothing is seen."""
        return self.do.number(self.scene.background)

    def written(self, color: Floats) -> Floats:
        """(..., 3) as the picture holds it."""
        return color

    def turned_rows(self, picture: Floats) -> Floats:
        """(H, W, 3) as it is handed in."""
        return picture
