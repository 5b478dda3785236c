"""Bugs in the projection of the map onto the scene."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.ports.shadows.mutants.catalogue import Catalogue
from ibr_ref.oracle.ports.shadows.port import Port
from ibr_ref.oracle.ports.shadows.raster import Fragments, Raster
from ibr_ref.oracle.ports.shadows.sampler import Sampler

fault = Catalogue("project")


@fault("t-upwards", "t grows upwards")
class _Upwards(Port):
    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[1, 1] = 0.5
        return matrix


@fault("gl-depth", "the bias matrix halves z too, as for NDC from -1")
class _GLDepth(Port):
    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[2] = 0.0, 0.0, 0.5, 0.5
        return matrix


@fault("half-texel-in-matrix", "the bias matrix adds half a texel")
class _HalfInMatrix(Port):
    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[:2, 3] += 0.5 / self.params.map_size
        return matrix


@fault("r-not-divided", "r is compared before the division by q_w")
class _DepthNotDivided(Port):
    def divided(self, q: list[Floats]) -> list[Floats]:
        return [*super().divided(q)[:2], q[2]]


@fault("world-not-perspective", "world positions are interpolated linearly in the window")
class _NotPerspective(Port):
    def world(self, raster: Raster, fragments: Fragments, w: Floats, corners: list[Floats]) -> list[Floats]:
        return [raster.linear(fragments, corner) for corner in corners]


@fault("r-not-clamped", "r is not clamped to [0, 1]")
class _NotClamped(Port):
    def clamped(self, r: Floats) -> Floats:
        return r


@fault("r-half-floats", "r is held in half floats", small=True)
class _HalfDepth(Port):
    def clamped(self, r: Floats) -> Floats:
        return super().clamped(r).astype(np.float16).astype(np.float64)


@fault("outside-clamped", "beside the map its border is fetched")
class _OutsideClamped(Port):
    def in_map(self, s: Floats, t: Floats) -> Bools:
        return np.isfinite(s) & np.isfinite(t)


@fault("behind-light", "the reverse projection behind the light casts shadows too", small=True)
class _BehindLight(Port):
    def before_light(self, w: Floats) -> Bools:
        return np.ones(w.shape, np.bool_)


@fault("caster-shadows-itself", "masks fall on the caster's own fragments")
class _OnCaster(Port):
    def exempt(self, casts: Bools) -> Bools:
        return np.zeros_like(casts)


@fault("caster-exempt-from-depths", "the caster's own fragments are lit where depths are compared", small=True)
class _Exempt(Port):
    def exempt(self, casts: Bools) -> Bools:
        return casts


@fault("centre-matrix", "all samples' maps are projected from the light's centre")
class _CentreMatrix(Port):
    def projecting_view(self, place: Floats) -> Floats:
        return self.light_view(self.centre)


@fault("target-left", "the light's target stays in place when a sample moves")
class _TargetLeft(Port):
    def projecting_view(self, place: Floats) -> Floats:
        back = -(np.asarray(self.scene.light.target) - place)
        back = back / np.sqrt(back @ back)
        right = np.cross(np.asarray(self.scene.light.up), back)
        right = right / np.sqrt(right @ right)
        view = np.eye(4)
        view[:3, :3] = right, np.cross(back, right), back
        view[:3, 3] = -view[:3, :3] @ place
        return view


class _NoHalf(Sampler):
    def position(self, u: Floats, size: int) -> Floats:
        return self.ops.multiply(u, size)


@fault("half-a-texel", "fetches from texel s S, not s S - 0.5")
class _HalfTexel(Port):
    shadow_sampler = _NoHalf


class _Nearest(Sampler):
    def bilinear(self, image: Floats, u: Floats, v: Floats) -> Floats:
        return self.nearest(image, u, v)


@fault("nearest-fetch", "the nearest texel of the mask is fetched")
class _NearestFetch(Port):
    shadow_sampler = _Nearest


class _Rounding(Sampler):
    def index(self, u: Floats, size: int) -> Ints:
        return np.rint(self.ops.multiply(u, size)).astype(np.int64)


@fault("texel-rounded", "the nearest texel is round(s S), not floor", small=True)
class _TexelRounded(Port):
    shadow_sampler = _Rounding


class _Repeat(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.mod(index, size)


@fault("repeat", "fetches wrap around the map's border", small=True)
class _Repeated(Port):
    shadow_sampler = _Repeat


class _LastTexelLeftOut(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.clip(index, 0, size - 2)


@fault("pcf-last-texel", "comparisons are clamped to the last texel but one", small=True)
class _PcfLastTexel(Port):
    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return super().filtered(_LastTexelLeftOut(self.ops), image, s, t, r)


@fault("half-or-more", "shadow is all or nothing: 1 where the mask is at least one half")
class _Binary(Port):
    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return np.where(super().shadow(image, s, t, r) >= 0.5, 1.0, 0.0)


@fault("bias-sign", "the bias is added to r")
class _BiasSign(Port):
    def biased(self, r: Floats) -> Floats:
        return self.ops.add(r, self.ops.number(self.params.bias))


@fault("no-bias", "the bias is left out", small=True)
class _NoBias(Port):
    def biased(self, r: Floats) -> Floats:
        return r


@fault("bias-doubled", "the bias is in NDC from -1: twice as much", small=True)
class _BiasDoubled(Port):
    def biased(self, r: Floats) -> Floats:
        return self.ops.subtract(r, self.ops.number(2.0 * self.params.bias))


@fault("or-equal", "shadow where depths are equal too", small=True)
class _OrEqual(Port):
    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel


@fault("pcf-or-equal", "the four comparisons are GL_LEQUAL's: in shadow only where r - bias >= texel", small=True)
class _PcfOrEqual(Port):
    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel if self.params.pcf else super().behind(here, texel)


@fault("compare-ge", "shadow where depths are equal too, as they are beyond the light's far plane", small=True)
class _CompareGe(Port):
    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel if self.params.quantize is None else super().behind(here, texel)


@fault("quantize-truncates", "both sides of the comparison are truncated to bytes", small=True)
class _Truncates(Port):
    def quantized(self, depth: Floats) -> Floats:
        return np.floor(self.ops.multiply(depth, 255.0))


@fault("bias-after-quantize", "the bias is subtracted after r is rounded to bytes", small=True)
class _BiasAfter(Port):
    def compared(self, r: Floats, texel: Floats) -> Floats:
        if self.params.quantize is None:
            return super().compared(r, texel)
        here = self.quantized(r) - 255.0 * self.params.bias
        return np.where(self.behind(here, self.quantized(texel)), 1.0, 0.0)


class _WeightsExchanged(Sampler):
    def mix(self, texels: list[Floats], fx: Floats, fy: Floats) -> Floats:
        return super().mix(texels, fy, fx)


@fault("weights-exchanged", "the bilinear weights of s and t are exchanged")
class _Weights(Port):
    shadow_sampler = _WeightsExchanged


@fault("pcf-of-depths", "depths are mixed and then compared")
class _MixedDepths(Port):
    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return self.compared(r, sampler.bilinear(image, s, t))


@fault("pcf-three-taps", "the last of the four comparisons is the third again", small=True)
class _ThreeTaps(Port):
    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        texels, fx, fy = sampler.taps(image, s, t)
        texels[3] = texels[2]
        return sampler.mix([self.compared(r, texel) for texel in texels], fx, fy)
