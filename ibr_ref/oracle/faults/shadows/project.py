"""Bugs in the projection of the map onto the scene."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from ibr_ref.array_types import Floats as Array
from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.shadows.lights import Matrix
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import Fragments, Raster
from ibr_ref.oracle.programs.shadows.sampler import Sampler

PROJECT = Bugs("project", only=("warp", "direct", "grid"))

ALL = ("warp", "direct", "grid", "pcss")
"""Also where one map is softened."""


@PROJECT.add("project-t-upwards", only=ALL)
class _Upwards(Port):
    """T grows upwards."""

    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[1, 1] = 0.5
        return matrix


@PROJECT.add("project-gl-depth")
class _GLDepth(Port):
    """The bias matrix halves z too, as for NDC from -1."""

    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[2] = 0.0, 0.0, 0.5, 0.5
        return matrix


@PROJECT.add("project-half-texel-in-matrix", only=ALL)
class _HalfInMatrix(Port):
    """The bias matrix adds half a texel."""

    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[:2, 3] += 0.5 / self.params.map_size
        return matrix


@PROJECT.add("project-r-not-divided")
class _DepthNotDivided(Port):
    """R is compared before the division by q_w."""

    def divided(self, q: Vector) -> Vector:
        return [*super().divided(q)[:2], q[2]]


@PROJECT.add("project-world-not-perspective", only=ALL)
class _NotPerspective(Port):
    """World positions are interpolated linearly in the window."""

    def world(self, raster: Raster, fragments: Fragments, w: Floats, corners: Vector) -> Vector:
        return [raster.linear(fragments, corner) for corner in corners]


@PROJECT.add("project-r-not-clamped")
class _NotClamped(Port):
    """R is not clamped to [0, 1]."""

    def clamped(self, r: Floats) -> Floats:
        return r


@PROJECT.add("project-r-half-floats", small=True)
class _HalfDepth(Port):
    """R is held in half floats."""

    def clamped(self, r: Floats) -> Floats:
        return super().clamped(r).astype(np.float16).astype(np.float64)


@PROJECT.add("project-outside-clamped")
class _OutsideClamped(Port):
    """Beside the map its border is fetched."""

    def in_map(self, s: Floats, t: Floats) -> Bools:
        return np.isfinite(s) & np.isfinite(t)


@PROJECT.add("project-behind-light", small=True)
class _BehindLight(Port):
    """The reverse projection behind the light casts shadows too."""

    def before_light(self, w: Floats) -> Bools:
        return np.isfinite(w)


@PROJECT.add("project-caster-shadows-itself")
class _OnCaster(Port):
    """Masks fall on the caster's own fragments."""

    def exempt(self, casts: Bools) -> Bools:
        return np.zeros_like(casts)


@PROJECT.add("project-caster-exempt-from-depths", small=True)
class _Exempt(Port):
    """The caster's own fragments are lit where depths are compared."""

    def exempt(self, casts: Bools) -> Bools:
        return casts


@PROJECT.add("project-centre-matrix")
class _CentreMatrix(Port):
    """All samples' maps are projected from the light's centre."""

    def projecting_view(self, place: Floats) -> Matrix:
        return self.light_view(self.centre)


@PROJECT.add("project-target-left")
class _TargetLeft(Port):
    """The light's target stays in place when a sample moves."""

    def projecting_view(self, place: Floats) -> Matrix:
        back = self.do.unit(list(self.do.subtract(place, self.do.number(self.scene.light.target))))
        right = self.do.unit(self.cross(list(self.do.number(self.scene.light.up)), back))
        rows = [[*axis, -self.do.dot(axis, list(place))] for axis in (right, self.cross(back, right), back)]
        return [*rows, [0.0, 0.0, 0.0, 1.0]]


class _NoHalf(Sampler):
    def position(self, u: Floats, size: int) -> Floats:
        return self.do.multiply(u, size)


@PROJECT.add("project-half-a-texel", only=ALL)
class _HalfTexel(Port):
    """Fetches from texel s S, not s S - 0.5."""

    shadow_sampler = _NoHalf


class _Nearest(Sampler):
    def bilinear(self, image: Floats, u: Floats, v: Floats) -> Floats:
        return self.nearest(image, u, v)


@PROJECT.add("project-nearest-fetch")
class _NearestFetch(Port):
    """The nearest texel of the mask is fetched."""

    shadow_sampler = _Nearest


class _Rounding(Sampler):
    def index(self, u: Floats, size: int) -> Ints:
        return np.rint(self.do.multiply(u, size)).astype(np.int64)


@PROJECT.add("project-texel-rounded", only=ALL, small=True)
class _TexelRounded(Port):
    """The nearest texel is round(s S), not floor."""

    shadow_sampler = _Rounding


class _Repeat(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.mod(index, size)


@PROJECT.add("project-repeat", small=True)
class _Repeated(Port):
    """Fetches wrap around the map's border."""

    shadow_sampler = _Repeat


class _LastTexelLeftOut(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.clip(index, 0, size - 2)


@PROJECT.add("project-pcf-last-texel", small=True)
class _PcfLastTexel(Port):
    """Comparisons are clamped to the last texel but one."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return super().filtered(_LastTexelLeftOut(self.do), image, s, t, r)


@PROJECT.add("project-half-or-more")
class _Binary(Port):
    """Shadow is all or nothing: 1 where the mask is at least one half."""

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return np.where(super().shadow(image, s, t, r) >= 0.5, 1.0, 0.0)


@PROJECT.add("project-bias-sign")
class _BiasSign(Port):
    """The bias is added to r."""

    def biased(self, r: Floats) -> Floats:
        return self.do.add(r, self.do.number(self.params.bias))


@PROJECT.add("project-no-bias", small=True)
class _NoBias(Port):
    """The bias is left out."""

    def biased(self, r: Floats) -> Floats:
        return r


@PROJECT.add("project-bias-doubled", small=True)
class _BiasDoubled(Port):
    """The bias is in NDC from -1: twice as much."""

    def biased(self, r: Floats) -> Floats:
        return self.do.subtract(r, self.do.number(2.0 * self.params.bias))


@PROJECT.add("project-or-equal", small=True)
class _OrEqual(Port):
    """Shadow where depths are equal too."""

    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel


@PROJECT.add("project-pcf-or-equal", small=True)
class _PcfOrEqual(Port):
    """The four comparisons are GL_LEQUAL's: in shadow only where r - bias >= texel."""

    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel if self.params.pcf else super().behind(here, texel)


@PROJECT.add("project-compare-ge", small=True)
class _CompareGe(Port):
    """Shadow where depths are equal too, as they are beyond the light's far plane."""

    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here >= texel if self.params.quantize is None else super().behind(here, texel)


@PROJECT.add("project-quantize-truncates", small=True)
class _Truncates(Port):
    """Both sides of the comparison are truncated to bytes."""

    def quantized(self, depth: Floats) -> Floats:
        return np.floor(self.do.multiply(depth, 255.0))


@PROJECT.add("project-bias-after-quantize", small=True)
class _BiasAfter(Port):
    """The bias is subtracted after r is rounded to bytes."""

    def compared(self, r: Floats, texel: Floats) -> Floats:
        if self.params.quantize is None:
            return super().compared(r, texel)
        here = self.quantized(r) - 255.0 * self.params.bias
        return np.where(self.behind(here, self.quantized(texel)), 1.0, 0.0)


class _WeightsExchanged(Sampler):
    def mix(self, texels: Vector, fx: Floats, fy: Floats) -> Floats:
        return super().mix(texels, fy, fx)


@PROJECT.add("project-weights-exchanged")
class _Weights(Port):
    """The bilinear weights of s and t are exchanged."""

    shadow_sampler = _WeightsExchanged


@PROJECT.add("project-pcf-of-depths")
class _MixedDepths(Port):
    """Depths are mixed and then compared."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return self.compared(r, sampler.bilinear(image, s, t))


@PROJECT.add("project-pcf-three-taps", small=True)
class _ThreeTaps(Port):
    """The last of the four comparisons is the third again."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        texels, fx, fy = sampler.taps(image, s, t)
        texels[3] = texels[2]
        return sampler.mix([self.compared(r, texel) for texel in texels], fx, fy)


class _Changed(Port, ABC):
    """Another bias matrix."""

    def texture_matrix(self) -> Array:
        matrix = super().texture_matrix().copy()
        self.change(matrix)
        return matrix

    @abstractmethod
    def change(self, matrix: Array) -> None:
        """In place."""


@PROJECT.add("project-s-mirrored")
class _Mirrored(_Changed):
    """S grows to the left: the map is looked up mirrored."""

    def change(self, matrix: Array) -> None:
        matrix[0, 0] = -0.5


@PROJECT.add("project-no-half")
class _NoHalfOffset(_Changed):
    """The bias matrix scales by 0.5 and adds no 0.5."""

    def change(self, matrix: Array) -> None:
        matrix[:2, 3] = 0.0


@PROJECT.add("project-ndc-as-coordinates")
class _Unbiased(_Changed):
    """The light's NDC are taken for texture coordinates: there is no bias matrix but for t downwards."""

    def change(self, matrix: Array) -> None:
        matrix[:2, 3] = 0.0
        matrix[0, 0], matrix[1, 1] = 1.0, -1.0


@PROJECT.add("project-bias-matrix-on-the-wrong-side")
class _BiasFirst(_Changed):
    """The bias matrix is transposed: its offsets go into w."""

    def change(self, matrix: Array) -> None:
        matrix[:] = matrix.T.copy()


@PROJECT.add("project-not-divided")
class _NotDivided(Port):
    """S, t and r are not divided by q_w: texture() in the place of textureProj()."""

    def divided(self, q: Vector) -> Vector:
        return [1.0 * component for component in q[:3]]


@PROJECT.add("project-divided-by-z")
class _DividedByZ(Port):
    """S, t and r are divided by q_z."""

    def divided(self, q: Vector) -> Vector:
        return super().divided([*q[:3], q[2]])


@PROJECT.add("project-divided-twice")
class _DividedTwice(Port):
    """Coordinates that are divided already are given to textureProj()."""

    def divided(self, q: Vector) -> Vector:
        return super().divided([*super().divided(q), q[3]])


@PROJECT.add("project-view-transposed")
class _ViewTransposed(Port):
    """The light's rotation is uploaded column by column."""

    def projecting_view(self, place: Floats) -> Matrix:
        rows = [list(row) for row in super().projecting_view(place)]
        return [*([rows[j][i] for j in range(3)] + [rows[i][3]] for i in range(3)), rows[3]]


@PROJECT.add("project-eye-not-rotated")
class _EyeNotRotated(Port):
    """The light's view matrix has -position for its last column, not that in the light's axes."""

    def projecting_view(self, place: Floats) -> Matrix:
        rows = [list(row) for row in super().projecting_view(place)]
        return [*([*rows[i][:3], -list(place)[i]] for i in range(3)), rows[3]]


@PROJECT.add("project-aspect-of-the-picture")
class _AspectOfPicture(_Changed):
    """The light's projection has the picture's aspect ratio, the maps are square."""

    def change(self, matrix: Array) -> None:
        matrix[0, 0] *= self.scene.camera.height / self.scene.camera.width


@PROJECT.add("project-r-linear")
class _LinearDepth(Port):
    """R is the depth between near and far, the map's is that of the window."""

    def coordinates(self, world: Vector, place: Floats) -> Vector:
        s, t, _, w = super().coordinates(world, place)
        near, far = self.scene.light.near, self.scene.light.far
        return [s, t, self.clamped(self.do.divide(self.do.subtract(w, near), far - near)), w]


@PROJECT.add("project-r-reversed")
class _Reversed(Port):
    """R is 1 - z/w: the light's depth is taken for a reversed one."""

    def clamped(self, r: Floats) -> Floats:
        return super().clamped(self.do.subtract(1.0, r))


@PROJECT.add("project-r-16-bits", small=True)
class _Depth16(Port):
    """R is rounded to 16 bits."""

    def clamped(self, r: Floats) -> Floats:
        return np.rint(super().clamped(r) * 65535.0) / 65535.0


@PROJECT.add("project-shadow-beside-the-map")
class _BesideInShadow(Port):
    """Beside the map everything is in shadow: a border colour of the wrong kind."""

    def shadowed(self, image: Floats, at: Vector, casts: Bools) -> Floats:
        inside = np.asarray(self.in_map(at[0], at[1]) & self.before_light(at[3]))
        return np.where(inside | self.exempt(casts), super().shadowed(image, at, casts), 1.0)


@PROJECT.add("project-border-texels-lit", small=True)
class _BorderLit(Port):
    """Half a texel along the map's border is left out."""

    def in_map(self, s: Floats, t: Floats) -> Bools:
        half = 0.5 / self.params.map_size
        return (s >= half) & (s <= 1.0 - half) & (t >= half) & (t <= 1.0 - half)


@PROJECT.add("project-beyond-far-lit")
class _BeyondFarLit(Port):
    """What lies beyond the light's far plane is lit."""

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return np.where(r >= 1.0, 0.0, super().shadow(image, s, t, r))


@PROJECT.add("project-comparison-reversed")
class _ComparisonReversed(Port):
    """Shadow where r is less than the texel."""

    def behind(self, here: Floats, texel: Floats) -> Bools:
        return here < texel


@PROJECT.add("project-texels-of-bytes", small=True)
class _TexelsOfBytes(Port):
    """The map's depths are read from a texture of bytes, the port's own r is not rounded."""

    def compared(self, r: Floats, texel: Floats) -> Floats:
        return super().compared(r, np.rint(texel * 255.0) / 255.0)


@PROJECT.add("project-bias-before-division", small=True)
class _BiasBeforeDivision(Port):
    """The bias is subtracted from q_z, before the division by q_w."""

    def divided(self, q: Vector) -> Vector:
        return super().divided([q[0], q[1], self.do.subtract(q[2], self.do.number(self.params.bias)), q[3]])

    def biased(self, r: Floats) -> Floats:
        return r


@PROJECT.add("project-pcf-equal-weights")
class _EqualWeights(Port):
    """The four comparisons are averaged, not mixed by the fractions."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        texels, fx, _ = sampler.taps(image, s, t)
        half = np.full(np.shape(fx), 0.5)
        return sampler.mix([self.compared(r, texel) for texel in texels], half, half)


@PROJECT.add("project-pcf-one-tap")
class _OneTap(Port):
    """A single comparison with the nearest texel: the sampler does not filter."""

    def filtered(self, sampler: Sampler, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return self.compared(r, sampler.nearest(image, s, t))


@PROJECT.add("project-mask-inverted")
class _MaskInverted(Port):
    """The mask is read as light, not as shadow."""

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        return self.do.subtract(1.0, super().shadow(image, s, t, r))


@PROJECT.add("project-mask-of-srgb")
class _MaskOfSrgb(Port):
    """The mask is fetched through a texture of sRGB: it is made linear once more."""

    def shadow(self, image: Floats, s: Floats, t: Floats, r: Floats) -> Floats:
        found = super().shadow(image, s, t, r)
        return found**2.2 if self.params.content == "mask" else found


class _NextTexel(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return super().wrap(index + 1, size)


@PROJECT.add("project-a-texel-too-far")
class _TexelTooFar(Port):
    """Fetches are a texel too far to the right and down: a textureOffset left in."""

    shadow_sampler = _NextTexel
