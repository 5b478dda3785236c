"""Bugs in what becomes a shadow: which surface is in it, biases, comparisons and their mix."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.shadows.systems import MAPPED
from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.sampler import Sampler

COMPARISON = Bugs("project", only=MAPPED)


@COMPARISON.add("project-caster-shadows-itself")
class _OnCaster(Port):
    """Masks fall on the caster's own fragments."""

    def exempt(self, casts: Bools) -> Bools:
        return np.zeros_like(casts)


@COMPARISON.add("project-caster-exempt-from-depths", small=True)
class _Exempt(Port):
    """The caster's own fragments are lit where depths are compared."""

    def exempt(self, casts: Bools) -> Bools:
        return casts


@COMPARISON.add("project-half-or-more")
class _Binary(Port):
    """Shadow is all or nothing: 1 where the mask is at least one half."""

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return np.where(super().shadow(image, s, t, r) >= 0.5, 1.0, 0.0)


@COMPARISON.add("project-bias-sign")
class _BiasSign(Port):
    """The bias is added to r."""

    def biased(self, r: Floats) -> Floats:
        return self.do.add(r, self.do.number(self.params.bias))


@COMPARISON.add("project-no-bias", small=True)
class _NoBias(Port):
    """The bias is left out."""

    def biased(self, r: Floats) -> Floats:
        return r


@COMPARISON.add("project-bias-doubled", small=True)
class _BiasDoubled(Port):
    """The bias is in NDC from -1: twice as much."""

    def biased(self, r: Floats) -> Floats:
        return self.do.subtract(r, self.do.number(2.0 * self.params.bias))


@COMPARISON.add("project-or-equal", small=True)
class _OrEqual(Port):
    """Shadow where depths are equal too."""

    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel


@COMPARISON.add("project-pcf-or-equal", small=True)
class _PcfOrEqual(Port):
    """The four comparisons are GL_LEQUAL's: in shadow only where r - bias >= texel."""

    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel if self.params.pcf else super().behind(here, texel)


@COMPARISON.add("project-compare-ge", small=True)
class _CompareGe(Port):
    """Shadow where depths are equal too, as they are beyond the light's far plane."""

    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel if self.params.quantize is None else super().behind(here, texel)


@COMPARISON.add("project-quantize-truncates", small=True)
class _Truncates(Port):
    """Both sides of the comparison are truncated to bytes."""

    def quantized(self, depth: Floats) -> Floats:
        return np.floor(self.do.multiply(depth, 255.0))


@COMPARISON.add("project-bias-after-quantize", small=True)
class _BiasAfter(Port):
    """The bias is subtracted after r is rounded to bytes."""

    def compared(self, r: Floats, texel: Floats) -> Floats:
        if self.params.quantize is None:
            return super().compared(r, texel)
        here = self.quantized(r) - 255.0 * self.params.bias
        return np.where(self.behind(here, self.quantized(texel)), 1.0, 0.0)


@COMPARISON.add("project-pcf-of-depths")
class _MixedDepths(Port):
    """Depths are mixed and then compared."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return self.compared(r, sampler.bilinear(image, s, t))


@COMPARISON.add("project-pcf-three-taps", small=True)
class _ThreeTaps(Port):
    """The last of the four comparisons is the third again."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        texels, fx, fy = sampler.taps(image, s, t)
        texels[3] = texels[2]
        return sampler.mix([self.compared(r, texel) for texel in texels], fx, fy)


@COMPARISON.add("project-comparison-reversed")
class _ComparisonReversed(Port):
    """Shadow where r is less than the texel."""

    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here < texel


@COMPARISON.add("project-bias-before-division", small=True)
class _BiasBeforeDivision(Port):
    """The bias is subtracted from q_z, before the division by q_w."""

    def divided(self, q: Vector) -> Vector:
        return super().divided([q[0], q[1], self.do.subtract(q[2], self.do.number(self.params.bias)), q[3]])

    def biased(self, r: Floats) -> Floats:
        return r


@COMPARISON.add("project-pcf-equal-weights")
class _EqualWeights(Port):
    """The four comparisons are averaged, not mixed by the fractions."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        texels, fx, _ = sampler.taps(image, s, t)
        half = np.full(np.shape(fx), 0.5)
        return sampler.mix([self.compared(r, texel) for texel in texels], half, half)


@COMPARISON.add("project-pcf-one-tap")
class _OneTap(Port):
    """A single comparison with the nearest texel: the sampler does not filter."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return self.compared(r, sampler.nearest(image, s, t))
