"""Bugs of the raster stage."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.port import Port
from ibr_ref.oracle.programs.displacement.vertex import Quad

RASTER = Bugs("raster")


@RASTER.add("window y up")
class _WindowUp(Port):
    """Window y grows upwards."""

    def window_y(self, ndc: Floats) -> Floats:
        return super().window_y(-ndc)


@RASTER.add("window a pixel narrower")
class _Narrow(Port):
    """Window x is scaled by width - 1."""

    def window_x(self, ndc: Floats) -> Floats:
        return self.do.multiply(super().window_x(ndc), (self.width - 1) / self.width)


@RASTER.add("pixel centres at whole numbers")
class _CornerCentres(Port):
    """Pixels are sampled at their upper left corner."""

    def centre(self) -> float:
        return 0.0


@RASTER.add("varyings at the pixel's corner")
class _CornerVaryings(Port):
    """Covered by the pixel's centre, but interpolated at its upper left corner."""

    def varying_centre(self) -> float:
        return 0.0


@RASTER.add("no perspective correction")
class _Affine(Port):
    """Varyings are linear in window space."""

    def perspective(self, w: Floats) -> Floats:
        return np.ones(np.shape(w))


@RASTER.add("perspective by z")
class _PerspectiveByDepth(Port):
    """Varyings are divided by the distance behind the near plane instead of that from the eye."""

    def perspective(self, w: Floats) -> Floats:
        return np.maximum(w - float(self.scene.camera.near), 1e-6)


@RASTER.add("1/w in half precision", small=True)
class _HalfPrecision(Port):
    """The corners' w are 16-bit floats."""

    def perspective(self, w: Floats) -> Floats:
        return half(w)


@RASTER.add("varyings in half precision", small=True)
class _HalfVaryings(Port):
    """C is a 16-bit vector in the fragment shader."""

    def varying(self, weights: Sequence[Floats], values: Floats, w: Floats) -> Floats:
        return half(super().varying(weights, values, w))


@RASTER.add("1/16 subpixels", small=True)
class _CoarseSubpixels(Port):
    """Window positions are snapped to 1/16 pixel, where the device promises 1/256."""

    limits: ClassVar[dict[str, Any]] = {"subpixel_bits": 4}

    def snapped(self, window: Floats) -> Ints:
        return np.rint(window * 16.0).astype(np.int64) * (self.subpixels() // 16)


@RASTER.add("all borders covered")
class _AllBorders(Port):
    """Edge functions >= 0: right and lower edges are covered as well."""

    def owns_border(self, dx: int, dy: int) -> bool:
        return True


@RASTER.add("no borders covered")
class _NoBorders(Port):
    """Edge functions > 0: cracks between the triangles where a pixel centre lies on an edge."""

    def owns_border(self, dx: int, dy: int) -> bool:
        return False


@RASTER.add("one orientation culled")
class _Culled(Port):
    """Triangles that run anticlockwise on the screen are not drawn."""

    def draws_orientation(self, area: int) -> bool:
        return area > 0


@RASTER.add("strip for fan")
class _Strip(Port):
    """Corners a, b, c, d are drawn as abc and bcd."""

    def triangles_of(self, quad: Quad) -> Sequence[tuple[int, int, int]]:
        return ((0, 1, 2), (1, 2, 3))


@RASTER.add("near plane of z in [-w, w]", small=True, hidden="hits before the near plane are discarded all the same")
class _LooseNear(Port):
    """Clipped at z = -w: what lies in front of the near plane is drawn."""

    def near_distance(self, clip: Floats) -> Floats:
        return clip[2] + clip[3]


@RASTER.add("far plane not clipped")
class _NoFar(Port):
    """What lies behind the far plane is drawn."""

    def far_distance(self, clip: Floats) -> Floats:
        return np.ones(())


@RASTER.add("face numbers of u and v swapped", hidden="the number of a side has no part in its colour")
class _SwappedFaces(Port):
    """Sides of v are numbered 1 and 2, those of u 3 and 4."""

    def face_number(self, face: int) -> int:
        return (0, 3, 4, 1, 2, 5)[face]


@RASTER.add("patches numbered from 1", hidden="the number of a patch has no part in its colour")
class _PatchesFromOne(Port):
    """raster.patch_id begins at 1."""

    def patch_number(self, patch: Patch) -> int:
        return patch.number + 1
