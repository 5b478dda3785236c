"""Bugs in drawing the picture's surfaces; its depth shows them first."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import FAR, Fragments, Raster
from ibr_ref.oracle.programs.shadows.surface import Picture

DEPTH = Bugs("depth")

EXACT = "the picture is made with the exact depth"


class _Greater(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return (held == 1.0) | (depth > held)


@DEPTH.add("depth-greater")
class _Farther(Port):
    """The farther surface stays."""

    surface_raster = _Greater


@DEPTH.add("depth-perspective")
class _PerspectiveDepth(Port):
    """Window depth is interpolated as a varying."""

    def window_depth(self, raster: Raster, fragments: Fragments, z: Floats, w: Floats) -> Floats:
        return raster.perspective(fragments, w, [z])[0]


@DEPTH.add("depth-gl-depth", hidden="the same surfaces are seen")
class _GLDepth(Port):
    """Window depth is (z + 1)/2 of a z that is in [0, 1] already."""

    def window_depth(self, raster: Raster, fragments: Fragments, z: Floats, w: Floats) -> Floats:
        return self.do.multiply(self.do.add(super().window_depth(raster, fragments, z, w), 1.0), 0.5)


class _Unclipped(Raster):
    planes = (FAR,)


@DEPTH.add("depth-no-near-clip")
class _NoNearClip(Port):
    """Triangles are not clipped at the near plane."""

    surface_raster = _Unclipped


class _Corners(Raster):
    def centre(self, pixel: Ints) -> Floats:
        return pixel


@DEPTH.add("depth-pixel-corners")
class _PixelCorners(Port):
    """Surfaces are sampled at the pixels' corners."""

    surface_raster = _Corners


class _Lower(Raster):
    def row(self, y: Floats, height: int) -> Floats:
        return self.do.add(super().row(y, height), 1.0 / 16.0)


@DEPTH.add("depth-viewport-shifted")
class _Shifted(Port):
    """The viewport is a sixteenth of a pixel too low."""

    surface_raster = _Lower


@DEPTH.add("depth-half-floats", small=True, hidden=EXACT)
class _HalfDepth(Port):
    """Depth is read back in half floats."""

    def read_back(self, depth: Floats) -> Floats:
        return half(depth)


@DEPTH.add("depth-caster-not-moved")
class _CasterNotMoved(Port):
    """The caster is drawn about its own origin."""

    def caster_vertices(self, offset: Floats) -> Vector:
        drawn = offset is self.offset and self.params.method == "warp"
        return Picture.caster_vertices(self, np.zeros(2) if drawn else offset)


@DEPTH.add("depth-16-bits", small=True, hidden=EXACT)
class _Of16Bits(Port):
    """Depth is read back in 16 bits."""

    def read_back(self, depth: Floats) -> Floats:
        return np.rint(depth * 65535.0) / 65535.0


@DEPTH.add("depth-linear", hidden=EXACT)
class _Linear(Port):
    """The depth that is handed in is made linear: that before the eye, over far."""

    def read_back(self, depth: Floats) -> Floats:
        near, far = self.scene.camera.near, self.scene.camera.far
        below = self.do.subtract(far, self.do.multiply(depth, far - near))
        return np.where(depth < 1.0, self.do.divide(near, below), 1.0)


@DEPTH.add("depth-reversed", hidden=EXACT)
class _Reversed(Port):
    """The depth that is handed in is 1 - z."""

    def read_back(self, depth: Floats) -> Floats:
        return np.where(depth < 1.0, self.do.subtract(1.0, depth), 1.0)


class _YUp(Raster):
    def row(self, y: Floats, height: int) -> Floats:
        return super().row(-y, height)


@DEPTH.add("depth-y-upwards")
class _YUpwards(Port):
    """The picture's y runs upwards."""

    surface_raster = _YUp


class _Narrow(Raster):
    def column(self, x: Floats, width: int) -> Floats:
        return super().column(x, width - 1)


@DEPTH.add("depth-viewport-one-less")
class _ViewportOneLess(Port):
    """The picture's viewport is a pixel narrower."""

    surface_raster = _Narrow
