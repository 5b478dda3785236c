"""Bugs of resolve: depth, depth test, colour write."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.port import Port

RESOLVE = Bugs("resolve")
WRITTEN = Bugs("shade")
"""Colours that are written wrongly: nothing tells them from colours that are computed wrongly, which are shading's."""

MONOTONE = "depths keep their order, and the picture shows nothing else of them"


@RESOLVE.add("LEQUAL", survives="depths that tie here need not tie on another device: either polygon may be shown")
class _LessOrEqual(Port):
    """On a tie in depth the later fragment wins."""

    def nearer(self, new: Floats, old: Floats) -> Bools:
        return new <= old


@RESOLVE.add("GREATER")
class _Greater(Port):
    """The farthest fragment wins, of those that are drawn at all."""

    def nearer(self, new: Floats, old: Floats) -> Bools:
        return np.where(old == 1.0, new < old, new > old)


@RESOLVE.add("no depth test")
class _LastWins(Port):
    """The last fragment wins."""

    def nearer(self, new: Floats, old: Floats) -> Bools:
        return new < 1.0


@RESOLVE.add("first fragment wins")
class _FirstWins(Port):
    """What is drawn is never overdrawn."""

    def nearer(self, new: Floats, old: Floats) -> Bools:
        return np.asarray((old == 1.0) & (new < 1.0))


@RESOLVE.add("depth offset", small=True)
class _DepthOffset(Port):
    """A fragment must be nearer by 1/1000 to win."""

    def nearer(self, new: Floats, old: Floats) -> Bools:
        return new < np.where(old == 1.0, old, old - 1e-3)


@RESOLVE.add("depth of the face")
class _FaceDepth(Port):
    """The rasterizer's depth is kept where that of the hit is asked for."""

    def window_depth(self, patch: Patch, hit: Vector, face_depth: Floats) -> Floats:
        return self.do.depth(face_depth)


@RESOLVE.add("depth of the hit", hidden="one polygon, whose hits keep the order of their faces")
class _HitDepth(Port):
    """The depth of the hit is written where that of the polygon is asked for."""

    def window_depth(self, patch: Patch, hit: Vector, face_depth: Floats) -> Floats:
        return self.do.depth(self.hit_depth(patch, hit))


@RESOLVE.add("depth as (z + 1)/2", hidden=MONOTONE)
class _HalvedDepth(Port):
    """GL's depth range, on a z that is in [0, 1] already."""

    def window_depth(self, patch: Patch, hit: Vector, face_depth: Floats) -> Floats:
        return self.do.multiply(self.do.add(super().window_depth(patch, hit, face_depth), 1.0), 0.5)


@RESOLVE.add("linear depth", hidden=MONOTONE)
class _LinearDepth(Port):
    """Depth is the distance along the view axis, from 0 at the near to 1 at the far plane."""

    def hit_depth(self, patch: Patch, hit: Vector) -> Floats:
        near, far = self.scene.camera.near, self.scene.camera.far
        z = self.do.dot(self.view_from_world[2], [*self.to_world(patch, hit), 1.0])
        return self.do.divide(self.do.subtract(-z, near), far - near)


@RESOLVE.add("16-bit depth", small=True, hidden="few fragments are so near to each other, where faces cross")
class _ShortDepth(Port):
    """Depths are multiples of 1/65535."""

    def window_depth(self, patch: Patch, hit: Vector, face_depth: Floats) -> Floats:
        return np.floor(super().window_depth(patch, hit, face_depth) * 65535.0 + 0.5) / 65535.0


@RESOLVE.add("black background")
class _BlackBackground(Port):
    """Where nothing is shown the picture is black."""

    def background(self) -> Floats:
        return np.zeros(3)


@WRITTEN.add("rows of the picture upside down")
class _FlippedColor(Port):
    """The colour buffer's row 0 is the bottom; everything else is right."""

    def rows(self, picture: NDArray[Any]) -> NDArray[Any]:
        return super().rows(picture)[::-1]


@WRITTEN.add("picture in BGR")
class _BgrPicture(Port):
    """Red and blue of the picture are swapped."""

    def written(self, color: Floats) -> Floats:
        return super().written(color)[..., ::-1]


@WRITTEN.add("picture in sRGB")
class _SrgbPicture(Port):
    """The frame buffer encodes colours, about their root."""

    def written(self, color: Floats) -> Floats:
        return super().written(color ** (1.0 / 2.2))


@WRITTEN.add("colours truncated to bytes", small=True)
class _TruncatedBytes(Port):
    """floor(255 c) without the half."""

    def written(self, color: Floats) -> Floats:
        return np.floor(np.clip(color, 0.0, 1.0) * 255.0) / 255.0


@WRITTEN.add("colours in 256 steps", small=True)
class _Steps256(Port):
    """Bytes are floor(256 c), and read as k/256."""

    def written(self, color: Floats) -> Floats:
        return np.floor(np.clip(color, 0.0, 1.0) * 256.0) / 256.0
