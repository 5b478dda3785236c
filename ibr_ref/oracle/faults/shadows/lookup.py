"""Bugs in what is fetched from the map: texels, borders, formats."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.shadows.systems import ALL, MAPPED
from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.sampler import Sampler

LOOKUP = Bugs("project", only=MAPPED)


@LOOKUP.add("project-outside-clamped")
class _OutsideClamped(Port):
    """Beside the map its border is fetched."""

    def in_map(self, s: Floats, t: Floats) -> Bools:
        return np.isfinite(s) & np.isfinite(t)


class _NoHalf(Sampler):
    def position(self, u: Floats, size: int) -> Floats:
        return self.do.multiply(u, size)


@LOOKUP.add("project-half-a-texel", only=ALL)
class _HalfTexel(Port):
    """Fetches from texel s S, not s S - 0.5."""

    shadow_sampler = _NoHalf


class _Nearest(Sampler):
    def bilinear(self, image: Floats, u: Floats, v: Floats) -> Floats:
        return self.nearest(image, u, v)


@LOOKUP.add("project-nearest-fetch")
class _NearestFetch(Port):
    """The nearest texel of the mask is fetched."""

    shadow_sampler = _Nearest


class _Rounding(Sampler):
    def index(self, u: Floats, size: int) -> Ints:
        return np.rint(self.do.multiply(u, size)).astype(np.int64)


@LOOKUP.add("project-texel-rounded", only=ALL, small=True)
class _TexelRounded(Port):
    """The nearest texel is round(s S), not floor."""

    shadow_sampler = _Rounding


class _Repeat(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.mod(index, size)


@LOOKUP.add("project-repeat", small=True)
class _Repeated(Port):
    """Fetches wrap around the map's border."""

    shadow_sampler = _Repeat


class _LastTexelLeftOut(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.clip(index, 0, size - 2)


@LOOKUP.add("project-pcf-last-texel", small=True)
class _PcfLastTexel(Port):
    """Comparisons are clamped to the last texel but one."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return super().filtered(_LastTexelLeftOut(self.do), image, s, t, r)


class _WeightsExchanged(Sampler):
    def mix(self, texels: Vector, fx: Floats, fy: Floats) -> Floats:
        return super().mix(texels, fy, fx)


@LOOKUP.add("project-weights-exchanged")
class _Weights(Port):
    """The bilinear weights of s and t are exchanged."""

    shadow_sampler = _WeightsExchanged


@LOOKUP.add("project-shadow-beside-the-map")
class _BesideInShadow(Port):
    """Beside the map everything is in shadow: a border colour of the wrong kind."""

    def shadowed(self, image: Floats, at: Vector, casts: Bools) -> Floats:
        inside = np.asarray(self.in_map(at[0], at[1]) & self.before_light(at[3]))
        return np.where(inside | self.exempt(casts), super().shadowed(image, at, casts), 1.0)


@LOOKUP.add("project-border-texels-lit", small=True)
class _BorderLit(Port):
    """Half a texel along the map's border is left out."""

    def in_map(self, s: Floats, t: Floats) -> Bools:
        half = 0.5 / self.params.map_size
        return (s >= half) & (s <= 1.0 - half) & (t >= half) & (t <= 1.0 - half)


@LOOKUP.add("project-beyond-far-lit")
class _BeyondFarLit(Port):
    """What lies beyond the light's far plane is lit."""

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return np.where(r >= 1.0, 0.0, super().shadow(image, s, t, r))


@LOOKUP.add("project-texels-of-bytes", small=True)
class _TexelsOfBytes(Port):
    """The map's depths are read from a texture of bytes, the port's own r is not rounded."""

    def compared(self, r: Floats, texel: Floats) -> Floats:
        return super().compared(r, np.rint(texel * 255.0) / 255.0)


@LOOKUP.add("project-mask-inverted")
class _MaskInverted(Port):
    """The mask is read as light, not as shadow."""

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return self.do.subtract(1.0, super().shadow(image, s, t, r))


@LOOKUP.add("project-mask-of-srgb")
class _MaskOfSrgb(Port):
    """The mask is fetched through a texture of sRGB: it is made linear once more."""

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        found = super().shadow(image, s, t, r)
        return found**2.2 if self.params.content == "mask" else found


class _NextTexel(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return super().wrap(index + 1, size)


@LOOKUP.add("project-a-texel-too-far")
class _TexelTooFar(Port):
    """Fetches are a texel too far to the right and down: a textureOffset left in."""

    shadow_sampler = _NextTexel
