"""Stages 5 and 6: the sum over the light's samples, and the colour."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.ports.shadows.lights import Lights
from ibr_ref.oracle.ports.shadows.surface import Surface


class Resolve(Lights):
    """Blending and shading."""

    def accumulated(self, shadows: list[Floats]) -> Floats:
        """(H, W) the sum of all samples' shadows, each times 1/N."""
        total = np.zeros_like(shadows[0])
        alpha = self.stored(self.alpha(len(shadows)))
        for shadow in self.contributions(shadows):
            total = self.stored(self.blended(total, shadow, alpha))
        return np.minimum(total, 1.0)

    def alpha(self, count: int) -> Floats:
        """Weight of one sample."""
        return self.ops.divide(1.0, count)

    def contributions(self, shadows: list[Floats]) -> list[Floats]:
        """In the order in which they are added."""
        return shadows[::-1] if self.ops.policy.backwards else shadows

    def blended(self, total: Floats, shadow: Floats, alpha: Floats) -> Floats:
        """GL_SRC_ALPHA, GL_ONE."""
        return self.ops.dot([total, shadow], [1.0, alpha])

    def stored(self, value: Floats) -> Floats:
        """As the frame buffer that is blended into holds it."""
        if self.params.accumulation == "float":
            return value
        return self.ops.divide(np.floor(self.ops.add(self.ops.multiply(np.minimum(value, 1.0), 255.0), 0.5)), 255.0)

    def resolved(self, surface: Surface, shadow: Floats) -> Floats:
        """(N, 3) colours: surface colour (ambient + (1 - ambient) (1 - shadow) max(0, n.l))."""
        ops, ambient = self.ops, self.ambient()
        direct = ops.multiply(self.direct_share(ambient), self.visibility(shadow))
        brightness = ops.add(ambient, ops.multiply(direct, self.cosine(surface)))
        return np.stack([ops.multiply(color, brightness) for color in surface.color], axis=-1)

    def ambient(self) -> Floats:
        """Share of the light that reaches shadows."""
        return self.ops.number(self.scene.ambient)

    def direct_share(self, ambient: Floats) -> Floats:
        """Share of the light that does not."""
        return self.ops.subtract(1.0, ambient)

    def visibility(self, shadow: Floats) -> Floats:
        """Of the light."""
        return self.ops.subtract(1.0, shadow)

    def cosine(self, surface: Surface) -> Floats:
        """max(0, n.l)."""
        normal = self.turned(surface.normal, self.toward_eye(surface.world))
        return self.lambert(self.ops.dot(normal, self.toward_light(surface.world)))

    def lambert(self, cosine: Floats) -> Floats:
        """Nothing from behind."""
        return np.maximum(cosine, 0.0)

    def toward_eye(self, world: list[Floats]) -> list[Floats]:
        """From the fragments, of any length."""
        eye = self.ops.number(self.scene.camera.eye)
        if eye[3] == 0.0:
            return [np.full_like(p, at) for p, at in zip(world, eye[:3], strict=True)]
        return [self.ops.subtract(at, p) for p, at in zip(world, eye[:3], strict=True)]

    def toward_light(self, world: list[Floats]) -> list[Floats]:
        """Unit vectors from the fragments to the light's centre."""
        return self.ops.unit([self.ops.subtract(at, p) for p, at in zip(world, self.centre, strict=True)])

    def turned(self, normal: list[Floats], toward: list[Floats]) -> list[Floats]:
        """Normals on the side of a direction."""
        sign = np.where(self.ops.dot(normal, toward) < 0.0, -1.0, 1.0)
        return [sign * component for component in normal]

    def background(self) -> Floats:
        """(3,) where nothing is seen."""
        return self.ops.number(self.scene.background)
