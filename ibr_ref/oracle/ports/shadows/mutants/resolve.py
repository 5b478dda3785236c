"""Bugs in shading."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.shadows.mutants.catalogue import BELOW_A_BYTE, Catalogue
from ibr_ref.oracle.ports.shadows.port import Arrays, Port
from ibr_ref.oracle.ports.shadows.raster import Fragments, Raster
from ibr_ref.oracle.ports.shadows.surface import Surface

fault = Catalogue("resolve")


@fault("ambient-2-percent", "ambient is 2 % too much", small=True)
class _AmbientMore(Port):
    def ambient(self) -> Floats:
        return np.asarray(super().ambient() * 1.02)


@fault("ambient-byte", "ambient is held as a byte", small=True)
class _AmbientByte(Port):
    def ambient(self) -> Floats:
        return np.asarray(np.rint(super().ambient() * 255.0) / 255.0)


@fault("ambient-added", "light is added to ambient whole, not times 1 - ambient")
class _AmbientAdded(Port):
    def direct_share(self, ambient: Floats) -> Floats:
        return np.ones(())


@fault("ambient-shadowed", "shadows take the ambient light away too")
class _AmbientShadowed(Port):
    def resolved(self, surface: Surface, shadow: Floats) -> Floats:
        return super().resolved(surface, np.zeros_like(shadow)) * (1.0 - shadow)[:, None]


@fault("shadow-of-bytes", "the shadow is read from a texture of bytes, truncated", small=True, hidden=BELOW_A_BYTE)
class _ShadowTruncated(Port):
    def visibility(self, shadow: Floats) -> Floats:
        return super().visibility(np.floor(shadow * 255.0) / 255.0)


@fault("normal-not-turned", "normals are taken as triangles are wound")
class _NotTurned(Port):
    def turned(self, normal: list[Floats], toward: list[Floats]) -> list[Floats]:
        return normal


@fault("turned-to-light", "normals are turned to the light: |n.l|")
class _TurnedToLight(Port):
    def lambert(self, cosine: Floats) -> Floats:
        return np.abs(cosine)


@fault("no-max", "light from behind is negative")
class _NoMax(Port):
    def lambert(self, cosine: Floats) -> Floats:
        return cosine


@fault("turned-by-view-axis", "normals are turned by the view axis, not by the line of sight")
class _TurnedByAxis(Port):
    def toward_eye(self, world: list[Floats]) -> list[Floats]:
        axis = self.ops.number(self.scene.camera.view_from_world[2, :3])
        return [np.full_like(p, component) for p, component in zip(world, axis, strict=True)]


@fault("light-not-normalized", "l is not of unit length")
class _LightLong(Port):
    def toward_light(self, world: list[Floats]) -> list[Floats]:
        return [self.ops.subtract(at, p) for p, at in zip(world, self.centre, strict=True)]


@fault("normal-not-normalized", "n is the cross product itself")
class _NormalLong(Port):
    def normals(self, world: list[Floats]) -> list[Floats]:
        first, second = ([self.ops.subtract(p[:, k], p[:, 0]) for p in world] for k in (1, 2))
        return self.cross(first, second)


@fault(
    "fast-inverse-root",
    "l is normalized by bit tricks and one Newton step",
    small=True,
    hidden=BELOW_A_BYTE,
)
class _FastInverseRoot(Port):
    def toward_light(self, world: list[Floats]) -> list[Floats]:
        light = [self.ops.subtract(at, p) for p, at in zip(world, self.centre, strict=True)]
        square = self.ops.dot(light, light).astype(np.float32)
        guess = (np.int32(0x5F3759DF) - (square.view(np.int32) >> 1)).view(np.float32).astype(np.float64)
        return [component * guess * (1.5 - 0.5 * square * guess * guess) for component in light]


@fault("normal-half-floats", "normals are read from a texture of half floats", small=True, hidden=BELOW_A_BYTE)
class _HalfNormals(Port):
    def normals(self, world: list[Floats]) -> list[Floats]:
        return [component.astype(np.float16).astype(np.float64) for component in super().normals(world)]


@fault("light-from-target", "l is the direction from the light's target, the same everywhere")
class _Directional(Port):
    def toward_light(self, world: list[Floats]) -> list[Floats]:
        toward = self.ops.unit(list(self.centre - self.ops.number(self.scene.light.target)))
        return [np.full_like(p, component) for p, component in zip(world, toward, strict=True)]


@fault("light-at-last-sample", "l points to the last sample of the light, not to its centre")
class _LastSample(Port):
    def toward_light(self, world: list[Floats]) -> list[Floats]:
        return self.ops.unit([self.ops.subtract(at, p) for p, at in zip(world, self.places[-1], strict=True)])


@fault("colors-flat", "the last corner's colour is the triangle's")
class _Flat(Port):
    def colors(self, raster: Raster, fragments: Fragments, w: Floats, corners: list[Floats]) -> list[Floats]:
        return [corner[fragments.triangle, 2] for corner in corners]


@fault("colors-not-perspective", "colours are interpolated linearly in the window")
class _ColorsLinear(Port):
    def colors(self, raster: Raster, fragments: Fragments, w: Floats, corners: list[Floats]) -> list[Floats]:
        return [raster.linear(fragments, corner) for corner in corners]


@fault("colors-of-bytes", "vertex colours are truncated to bytes", small=True)
class _ColorsOfBytes(Port):
    def colors(self, raster: Raster, fragments: Fragments, w: Floats, corners: list[Floats]) -> list[Floats]:
        return super().colors(raster, fragments, w, [np.floor(corner * 255.0) / 255.0 for corner in corners])


@fault("bgr", "colours come out blue first")
class _BGR(Port):
    def render(self) -> Arrays:
        arrays = super().render()
        return {**arrays, "color": arrays["color"][..., ::-1]}


@fault("rows-flipped", "the picture is read back bottom row first")
class _RowsFlipped(Port):
    def render(self) -> Arrays:
        arrays = super().render()
        return {**arrays, "color": arrays["color"][::-1]}


@fault("background-black", "the picture is cleared to black")
class _Black(Port):
    def background(self) -> Floats:
        return np.zeros(3)


@fault("background-of-bytes", "the background is truncated to bytes", small=True)
class _BackgroundOfBytes(Port):
    def background(self) -> Floats:
        return np.asarray(np.floor(super().background() * 255.0) / 255.0)


@fault("bytes-truncated", "colours are truncated to bytes, not rounded", small=True)
class _Truncated(Port):
    def resolved(self, surface: Surface, shadow: Floats) -> Floats:
        return np.asarray(np.floor(super().resolved(surface, shadow) * 255.0) / 255.0)


class _LessOrEqual(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return depth <= held


@fault(
    "lequal",
    "the depth test is LEQUAL: the later of two equal depths stays",
    survives="equal depths are closer than any device's rounding: either surface is legal",
)
class _LEqual(Port):
    surface_raster = _LessOrEqual
