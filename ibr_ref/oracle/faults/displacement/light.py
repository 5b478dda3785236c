"""Bugs of shading: light and self-shadow."""

from __future__ import annotations

from functools import reduce

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.port import Port

LIGHT = Bugs("shade")

# --- Phong -----------------------------------------------------------------------------------------------------------


@LIGHT.add("ambient off by 2 %", small=True)
class _Ambient(Port):
    """Ambient is 1.02 times what it should be."""

    def ambient(self) -> Floats:
        return super().ambient() * 1.02


@LIGHT.add("ambient as a byte", small=True)
class _AmbientByte(Port):
    """Ambient is rounded to a multiple of 1/255."""

    def ambient(self) -> Floats:
        return np.rint(super().ambient() * 255.0) / 255.0


@LIGHT.add("diffuse off by 1 %", small=True)
class _Diffuse(Port):
    """Diffuse light is 0.99 times what it should be."""

    def diffuse_cosine(self, cosine: Floats) -> Floats:
        return super().diffuse_cosine(cosine) * 0.99


@LIGHT.add("specular off by 2 %", small=True)
class _Specular(Port):
    """Highlights are 1.02 times what they should be."""

    def highlight(self, normal: Vector, to_light: Vector, to_eye: Vector, cosine: Floats) -> Floats:
        return super().highlight(normal, to_light, to_eye, cosine) * 1.02


@LIGHT.add("exponent off by one", small=True)
class _Exponent(Port):
    """The highlight's exponent is e - 1."""

    def exponent(self) -> int:
        return super().exponent() - 1


@LIGHT.add("lamp from the polygon's corner")
class _LampFromCorner(Port):
    """The direction to a lamp is that from P0, everywhere."""

    def light_way(self, patch: Patch, world: Vector) -> Vector:
        return super().light_way(patch, [np.broadcast_to(c, x.shape) for c, x in zip(patch.corner, world, strict=True)])


@LIGHT.add("lamp a little aside")
class _LampAside(Port):
    """The lamp's position is off by 1/50."""

    def light_way(self, patch: Patch, world: Vector) -> Vector:
        return super().light_way(patch, [world[0] + 0.02, *world[1:]])


@LIGHT.add("light shines away")
class _LightAway(Port):
    """The way to the light has the wrong sign."""

    def light_way(self, patch: Patch, world: Vector) -> Vector:
        return [-x for x in super().light_way(patch, world)]


@LIGHT.add("eye of parallel lines as a point")
class _EyeAsPoint(Port):
    """Highlights take the direction to an orthographic eye for its position."""

    def eye_way(self, patch: Patch, world: Vector) -> Vector:
        return self.towards([*self.eye[:3], np.ones(())], world)


@LIGHT.add("two-sided light", small=True)
class _TwoSided(Port):
    """|n.l| instead of max(0, n.l)."""

    def diffuse_cosine(self, cosine: Floats) -> Floats:
        return np.abs(cosine)


@LIGHT.add("wrapped light")
class _HalfLambert(Port):
    """(n.l + 1)/2, as many engines soften it."""

    def diffuse_cosine(self, cosine: Floats) -> Floats:
        return self.do.multiply(self.do.add(cosine, 1.0), 0.5)


@LIGHT.add("reflection the wrong way")
class _Reflection(Port):
    """r = l - 2 (n.l) n."""

    def reflected(self, normal: Vector, to_light: Vector, cosine: Floats) -> Vector:
        return [-x for x in super().reflected(normal, to_light, cosine)]


@LIGHT.add("half-way vector")
class _Blinn(Port):
    """Blinn's (n.h)^e for Phong's (r.v)^e."""

    def highlight(self, normal: Vector, to_light: Vector, to_eye: Vector, cosine: Floats) -> Floats:
        middle = self.do.unit([self.do.add(a, b) for a, b in zip(to_light, to_eye, strict=True)])
        base = np.maximum(self.do.dot(normal, middle), 0.0)
        return self.do.multiply(self.do.number(self.scene.light.specular), self.do.power(base, self.exponent()))


@LIGHT.add("highlights on the far side", small=True)
class _ShinesBehind(Port):
    """Highlights where n.l <= 0 as well."""

    def shines(self, cosine: Floats, lit: Bools) -> Bools:
        return lit


@LIGHT.add("highlights in the shadow", small=True)
class _ShinesInShadow(Port):
    """Highlights are not shadowed."""

    def shines(self, cosine: Floats, lit: Bools) -> Bools:
        return cosine > 0.0


@LIGHT.add("coloured highlights", small=True)
class _ColoredHighlight(Port):
    """The highlight is multiplied by the albedo."""

    def lighted(self, albedo: Floats, brightness: Floats, highlight: Floats) -> Floats:
        return self.do.multiply(albedo, self.do.add(brightness, highlight))


@LIGHT.add("no clamp", small=True, hidden="an 8-bit picture is clamped when it is written")
class _Unclamped(Port):
    """Colours above 1 are written."""

    def clamped(self, color: Floats) -> Floats:
        return color


@LIGHT.add("brightness clamped")
class _ClampedBrightness(Port):
    """Ambient and diffuse light together are at most 1."""

    def brightness(self, cosine: Floats, lit: Bools) -> Floats:
        return np.minimum(super().brightness(cosine, lit), 1.0)


@LIGHT.add("diffuse light in the shadow")
class _DiffuseInShadow(Port):
    """lit only switches the highlight."""

    def brightness(self, cosine: Floats, lit: Bools) -> Floats:
        return super().brightness(cosine, np.ones(lit.shape, bool))


@LIGHT.add("ambient shadowed")
class _AmbientShadowed(Port):
    """Shadow is black."""

    def brightness(self, cosine: Floats, lit: Bools) -> Floats:
        return np.where(lit, super().brightness(cosine, lit), 0.0)


# --- Self-shadow -----------------------------------------------------------------------------------------------------


@LIGHT.add("shadow samples at j/S", small=True)
class _FractionsOfS(Port):
    """The last sample lies at the end of the stretch."""

    def shadow_fraction(self, j: int) -> Floats:
        return self.do.divide(float(j), float(self.params.shadow_steps))


@LIGHT.add("shadow samples from the hit on")
class _FromHit(Port):
    """j from 0: the hit, just below the surface, may shadow itself."""

    def shadow_samples(self) -> range:
        return range(self.params.shadow_steps + 1)


@LIGHT.add("last shadow sample left out", small=True)
class _LastSampleMissing(Port):
    """j to S - 1."""

    def shadow_samples(self) -> range:
        return range(1, self.params.shadow_steps)


@LIGHT.add("one shadow sample more", small=True)
class _OneSampleMore(Port):
    """j to S + 1: the last sample lies at the end of the stretch."""

    def shadow_samples(self) -> range:
        return range(1, self.params.shadow_steps + 2)


@LIGHT.add("first shadow sample left out", small=True)
class _FirstSampleMissing(Port):
    """j from 2."""

    def shadow_samples(self) -> range:
        return range(2, self.params.shadow_steps + 1)


@LIGHT.add("shadow bias with the wrong sign", small=True)
class _NegativeBias(Port):
    """h - bias < H."""

    def shadow_bias(self, patch: Patch) -> Floats:
        return -super().shadow_bias(patch)


@LIGHT.add("shadow bias in world units", small=True)
class _WorldBias(Port):
    """The bias is divided by s."""

    def shadow_bias(self, patch: Patch) -> Floats:
        return self.do.divide(super().shadow_bias(patch), patch.scale)


@LIGHT.add("shadow ray to the top only", small=True)
class _ShadowToTop(Port):
    """The stretch ends at h = 1, even where it leaves the volume through a side before."""

    def stretch(self, patch: Patch, hit: Vector, way: Vector) -> Floats:
        return self.until_light(patch, self.share_up(hit[2], way[2]))


@LIGHT.add("shadow ray to the border of a repeated map", small=True)
class _ShadowToBorder(Port):
    """The stretch ends at the sides of the cube although the map is repeated."""

    def stretch(self, patch: Patch, hit: Vector, way: Vector) -> Floats:
        shares = [self.share_to_wall(x, d) for x, d in zip(hit, way, strict=True)]
        return self.until_light(patch, reduce(self.do.least, shares))


@LIGHT.add("shadows from behind the lamp", small=True)
class _BeyondLamp(Port):
    """The stretch does not end at the lamp."""

    def until_light(self, patch: Patch, share: Floats) -> Floats:
        return share


@LIGHT.add("no horizon")
class _NoHorizon(Port):
    """A light below the polygon shines."""

    def light_below_horizon(self, height: Floats) -> Bools:
        return np.zeros(height.shape, np.bool_)
