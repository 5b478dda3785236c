"""Bugs in drawing the picture's surfaces; its depth shows them first."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.ports.shadows.mutants.catalogue import Catalogue
from ibr_ref.oracle.ports.shadows.port import Arrays, Port
from ibr_ref.oracle.ports.shadows.raster import Fragments, Raster
from ibr_ref.oracle.ports.shadows.surface import Picture

fault = Catalogue("depth")


class _Greater(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return np.asarray((held == 1.0) | (depth > held), np.bool_)


@fault("greater", "the farther surface stays")
class _Farther(Port):
    surface_raster = _Greater


@fault("perspective", "window depth is interpolated as a varying")
class _PerspectiveDepth(Port):
    def window_depth(self, raster: Raster, fragments: Fragments, z: Floats, w: Floats) -> Floats:
        return raster.perspective(fragments, w, [z])[0]


@fault("gl-depth", "window depth is (z + 1)/2 of a z that is in [0, 1] already", hidden="the same surfaces are seen")
class _GLDepth(Port):
    def window_depth(self, raster: Raster, fragments: Fragments, z: Floats, w: Floats) -> Floats:
        return self.ops.multiply(self.ops.add(super().window_depth(raster, fragments, z, w), 1.0), 0.5)


class _Unclipped(Raster):
    def distances(self, corner: Floats) -> list[Floats]:
        return [self.ops.subtract(corner[..., 3], corner[..., 2])]


@fault("no-near-clip", "triangles are not clipped at the near plane")
class _NoNearClip(Port):
    surface_raster = _Unclipped


class _Corners(Raster):
    def centre(self, pixel: Ints) -> Floats:
        return np.asarray(pixel, np.float64)


@fault("pixel-corners", "surfaces are sampled at the pixels' corners")
class _PixelCorners(Port):
    surface_raster = _Corners


class _Lower(Raster):
    def row(self, y: Floats, height: int) -> Floats:
        return self.ops.add(super().row(y, height), 1.0 / 16.0)


@fault("viewport-shifted", "the viewport is a sixteenth of a pixel too low")
class _Shifted(Port):
    surface_raster = _Lower


@fault(
    "half-floats", "depth is read back in half floats", small=True, hidden="the picture is made with the exact depth"
)
class _HalfDepth(Port):
    def render(self) -> Arrays:
        arrays = super().render()
        return {**arrays, "depth": arrays["depth"].astype(np.float16).astype(np.float64)}


@fault("caster-not-moved", "the caster is drawn about its own origin")
class _CasterNotMoved(Port):
    def caster_vertices(self, offset: Floats) -> list[Floats]:
        drawn = offset is self.offset and self.params.method == "warp"
        return Picture.caster_vertices(self, np.zeros(2) if drawn else offset)
