"""Bugs in shading."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.faults.shadows.hidden import BELOW_A_BYTE
from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import Fragments, Raster

RESOLVE = Bugs("resolve")


def _fast_inverse_root(square: Any) -> Any:
    """-1 / sqrt(x), nearly: by its bits, and one Newton step."""
    x = np.asarray(square, np.float64).astype(np.float32)
    guess = (np.int32(0x5F3759DF) - (x.view(np.int32) >> 1)).view(np.float32).astype(np.float64)
    return -guess * (1.5 - 0.5 * x * guess * guess)


@RESOLVE.add("resolve-ambient-2-percent", small=True)
class _AmbientMore(Port):
    """Ambient is 2 % too much."""

    def ambient(self) -> Floats:
        return super().ambient() * 1.02


@RESOLVE.add("resolve-ambient-byte", small=True)
class _AmbientByte(Port):
    """Ambient is held as a byte."""

    def ambient(self) -> Floats:
        return np.rint(super().ambient() * 255.0) / 255.0


@RESOLVE.add("resolve-ambient-added")
class _AmbientAdded(Port):
    """Light is added to ambient whole, not times 1 - ambient."""

    def direct_share(self, ambient: Floats) -> Floats:
        return np.ones(())


@RESOLVE.add("resolve-ambient-shadowed")
class _AmbientShadowed(Port):
    """Shadows take the ambient light away too."""

    def shaded(self, color: Vector, shadow: Floats, cosine: Floats) -> Vector:
        left = 1.0 - shadow
        return [channel * left for channel in super().shaded(color, np.zeros_like(shadow), cosine)]


@RESOLVE.add("resolve-shadow-of-bytes", small=True, hidden=BELOW_A_BYTE)
class _ShadowTruncated(Port):
    """The shadow is read from a texture of bytes, truncated."""

    def visibility(self, shadow: Floats) -> Floats:
        return super().visibility(np.floor(shadow * 255.0) / 255.0)


@RESOLVE.add("resolve-normal-not-turned")
class _NotTurned(Port):
    """Normals are taken as triangles are wound."""

    def turned(self, normal: Vector, toward: Vector) -> Vector:
        return normal


@RESOLVE.add("resolve-turned-to-light")
class _TurnedToLight(Port):
    """Normals are turned to the light: |n.l|."""

    def lambert(self, cosine: Floats) -> Floats:
        return np.abs(cosine)


@RESOLVE.add("resolve-no-max")
class _NoMax(Port):
    """Light from behind is negative."""

    def lambert(self, cosine: Floats) -> Floats:
        return cosine


@RESOLVE.add("resolve-turned-by-view-axis")
class _TurnedByAxis(Port):
    """Normals are turned by the view axis, not by the line of sight."""

    def toward_eye(self, world: Vector) -> Vector:
        axis = list(self.do.number(self.scene.camera.view_from_world[2, :3]))
        return [self.do.in_lanes(component, p) for p, component in zip(world, axis, strict=True)]


@RESOLVE.add("resolve-light-not-normalized")
class _LightLong(Port):
    """L is not of unit length."""

    def toward_light(self, world: Vector) -> Vector:
        return [self.do.subtract(at, p) for p, at in zip(world, self.centre, strict=True)]


@RESOLVE.add("resolve-normal-not-normalized")
class _NormalLong(Port):
    """N is the cross product itself."""

    def normals(self, world: Vector) -> Vector:
        first, second = ([self.do.subtract(p[:, k], p[:, 0]) for p in world] for k in (1, 2))
        return self.cross(first, second)


@RESOLVE.add("resolve-fast-inverse-root", small=True, hidden=BELOW_A_BYTE)
class _FastInverseRoot(Port):
    """L is normalized by bit tricks and one Newton step."""

    def toward_light(self, world: Vector) -> Vector:
        light = [self.do.subtract(at, p) for p, at in zip(world, self.centre, strict=True)]
        inverse = -self.do.rising(_fast_inverse_root, self.do.dot(light, light))
        return [component * inverse for component in light]


@RESOLVE.add("resolve-normal-half-floats", small=True, hidden=BELOW_A_BYTE)
class _HalfNormals(Port):
    """Normals are read from a texture of half floats."""

    def normals(self, world: Vector) -> Vector:
        return [half(component) for component in super().normals(world)]


@RESOLVE.add("resolve-light-from-target")
class _Directional(Port):
    """L is the direction from the light's target, the same everywhere."""

    def toward_light(self, world: Vector) -> Vector:
        toward = self.do.unit(list(self.centre - self.do.number(self.scene.light.target)))
        return [self.do.in_lanes(component, p) for p, component in zip(world, toward, strict=True)]


@RESOLVE.add("resolve-light-at-last-sample")
class _LastSample(Port):
    """L points to the last sample of the light, not to its centre."""

    def toward_light(self, world: Vector) -> Vector:
        return self.do.unit([self.do.subtract(at, p) for p, at in zip(world, self.places[-1], strict=True)])


@RESOLVE.add("resolve-colors-flat")
class _Flat(Port):
    """The last corner's colour is the triangle's."""

    def colors(self, raster: Raster, fragments: Fragments, w: Floats, corners: Vector) -> Vector:
        return [corner[fragments.triangle, 2] for corner in corners]


@RESOLVE.add("resolve-colors-not-perspective")
class _ColorsLinear(Port):
    """Colours are interpolated linearly in the window."""

    def colors(self, raster: Raster, fragments: Fragments, w: Floats, corners: Vector) -> Vector:
        return [raster.linear(fragments, corner) for corner in corners]


@RESOLVE.add("resolve-colors-of-bytes", small=True)
class _ColorsOfBytes(Port):
    """Vertex colours are truncated to bytes."""

    def colors(self, raster: Raster, fragments: Fragments, w: Floats, corners: Vector) -> Vector:
        return super().colors(raster, fragments, w, [np.floor(corner * 255.0) / 255.0 for corner in corners])


@RESOLVE.add("resolve-bgr")
class _BGR(Port):
    """Colours come out blue first."""

    def written(self, color: Floats) -> Floats:
        return color[..., ::-1]


@RESOLVE.add("resolve-rows-flipped")
class _RowsFlipped(Port):
    """The picture is read back bottom row first."""

    def turned_rows(self, picture: Floats) -> Floats:
        return picture[::-1]


@RESOLVE.add("resolve-background-black")
class _Black(Port):
    """The picture is cleared to black."""

    def background(self) -> Floats:
        return np.zeros(3)


@RESOLVE.add("resolve-background-of-bytes", small=True)
class _BackgroundOfBytes(Port):
    """The background is truncated to bytes."""

    def background(self) -> Floats:
        return np.floor(super().background() * 255.0) / 255.0


@RESOLVE.add("resolve-bytes-truncated", small=True)
class _Truncated(Port):
    """Colours are truncated to bytes, not rounded."""

    def shaded(self, color: Vector, shadow: Floats, cosine: Floats) -> Vector:
        return [np.floor(channel * 255.0) / 255.0 for channel in super().shaded(color, shadow, cosine)]


class _LessOrEqual(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return depth <= held


@RESOLVE.add("resolve-lequal", survives="equal depths are closer than any device's rounding: either surface is legal")
class _LEqual(Port):
    """The depth test is LEQUAL: the later of two equal depths stays."""

    surface_raster = _LessOrEqual


@RESOLVE.add("resolve-encoded-for-screens")
class _Encoded(Port):
    """The picture goes through the sRGB curve."""

    def written(self, color: Floats) -> Floats:
        return np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1.0 / 2.4) - 0.055)


@RESOLVE.add("resolve-decoded-for-screens")
class _Decoded(Port):
    """The picture is made linear once more: a gamma of 2.2 for 1/2.2."""

    def written(self, color: Floats) -> Floats:
        return color**2.2


@RESOLVE.add("resolve-columns-mirrored")
class _ColumnsMirrored(Port):
    """The picture's columns run from the right."""

    def turned_rows(self, picture: Floats) -> Floats:
        return picture[:, ::-1]


@RESOLVE.add("resolve-ten-bits-a-channel", small=True)
class _TenBits(Port):
    """The frame buffer has ten bits a channel."""

    def written(self, color: Floats) -> Floats:
        return np.rint(1023.0 * color) / 1023.0


@RESOLVE.add("resolve-five-bits-a-channel")
class _FiveBits(Port):
    """The frame buffer has five bits a channel."""

    def written(self, color: Floats) -> Floats:
        return np.rint(31.0 * color) / 31.0


@RESOLVE.add("resolve-shadow-as-light")
class _ShadowAsLight(Port):
    """The shadow is taken for what is lit: 1 - shadow is left out."""

    def visibility(self, shadow: Floats) -> Floats:
        return 1.0 * shadow


@RESOLVE.add("resolve-no-ambient")
class _NoAmbient(Port):
    """Ambient light is left out."""

    def ambient(self) -> Floats:
        return self.do.number(0.0)


@RESOLVE.add("resolve-half-lambert")
class _HalfLambert(Port):
    """Light wraps round: 0.5 n.l + 0.5."""

    def lambert(self, cosine: Floats) -> Floats:
        return self.do.dot([cosine, 0.5], [0.5, 1.0])


@RESOLVE.add("resolve-lit-from-the-eye")
class _FromEye(Port):
    """L points to the eye: a lamp on the camera."""

    def toward_light(self, world: Vector) -> Vector:
        return self.do.unit(self.toward_eye(world))


@RESOLVE.add("resolve-hard-shadow")
class _Hard(Port):
    """The shadow is all or nothing, from one half on."""

    def visibility(self, shadow: Floats) -> Floats:
        return np.where(shadow >= 0.5, 0.0, 1.0)


@RESOLVE.add("resolve-cosine-squared")
class _CosineSquared(Port):
    """The cosine is multiplied twice."""

    def lambert(self, cosine: Floats) -> Floats:
        found = super().lambert(cosine)
        return self.do.multiply(found, found)
