"""Bugs of the vertex stage: where the points are."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.splatting.port import Port

GEOMETRY = Bugs("vertex")


@GEOMETRY.add("pixel-corners")
class _PixelCorners(Port):
    """Pixels are unprojected from their corners, not from their centres."""

    def center(self, index: Ints) -> Floats:
        return np.asarray(index, np.float64)


@GEOMETRY.add("square-pixels")
class _SquarePixels(Port):
    """f_x is used for rows, too."""

    def intrinsics(self, camera: Any) -> Any:
        k = camera.intrinsics.copy()
        k[1, 1] = k[0, 0]
        return k


@GEOMETRY.add("no-skew")
class _NoSkew(Port):
    """The skew is left out."""

    def intrinsics(self, camera: Any) -> Any:
        k = camera.intrinsics.copy()
        k[0, 1] = 0.0
        return k


@GEOMETRY.add("depth-along-the-ray")
class _DepthAlongTheRay(Port):
    """The depth is taken as the distance from the eye."""

    def view_point(self, camera: Any, columns: Ints, rows: Ints, depth: Floats) -> Vector:
        point = super().view_point(camera, columns, rows, depth)
        shorter = self.do.divide(depth, self.length(point))
        return [self.do.multiply(shorter, value) for value in point]


@GEOMETRY.add("always-perspective")
class _AlwaysPerspective(Port):
    """Lines of sight of an orthographic reference camera spread from its eye."""

    def stretch(self, camera: Any, x: Floats, y: Floats, depth: Floats) -> tuple[Floats, Floats]:
        return self.do.multiply(x, depth), self.do.multiply(y, depth)


@GEOMETRY.add("transpose-for-inverse", small=True)
class _TransposeForInverse(Port):
    """T_R→W is made with the transpose of the measured rotation."""

    def world_from_view(self, camera: Any) -> Any:
        matrix = np.eye(4)
        matrix[:3, :3] = camera.view_from_world[:3, :3].T
        matrix[:3, 3] = -matrix[:3, :3] @ camera.view_from_world[:3, 3]
        return matrix


@GEOMETRY.add("rotation-transposed")
class _RotationTransposed(Port):
    """T_R→W is uploaded with rows for columns in its rotation."""

    def world_from_view(self, camera: Any) -> Any:
        matrix = camera.world_from_view.copy()
        matrix[:3, :3] = matrix[:3, :3].T.copy()
        return matrix


@GEOMETRY.add("first-camera-for-all")
class _FirstCameraForAll(Port):
    """T_R→W of the first image is used for all: the uniform is not updated."""

    def world_from_view(self, camera: Any) -> Any:
        return super().world_from_view(self.scene.images[0].camera)


@GEOMETRY.add("window-upwards")
class _WindowUpwards(Port):
    """Window y grows upwards."""

    def window_y(self, y: Floats) -> Floats:
        return super().window_y(-y)


@GEOMETRY.add("last-pixel-for-size")
class _LastPixelForSize(Port):
    """Window x is scaled by width − 1."""

    def window_x(self, x: Floats) -> Floats:
        return self.do.multiply(self.do.multiply(0.5, self.do.add(x, 1.0)), self.scene.camera.width - 1.0)


@GEOMETRY.add("half-pixel-shift")
class _HalfPixelShift(Port):
    """Window positions have the pixels' centres at whole numbers."""

    def window_x(self, x: Floats) -> Floats:
        return self.do.subtract(super().window_x(x), 0.5)


@GEOMETRY.add("two-subpixels-shift", small=True)
class _TwoSubpixelsShift(Port):
    """Window y is off by 1/128 pixel."""

    def window_y(self, y: Floats) -> Floats:
        return self.do.add(super().window_y(y), 1.0 / 128.0)


@GEOMETRY.add("depth-from-minus-one", hidden="the depths keep their order, hence the colours")
class _DepthFromMinusOne(Port):
    """Window depth is z of a space from −1 to 1, halved and moved, though it is from 0 to 1 already."""

    def window_depth(self, z: Floats) -> Floats:
        return self.do.multiply(0.5, self.do.add(z, 1.0))


@GEOMETRY.add("near-plane-open")
class _NearPlaneOpen(Port):
    """Points between the eye and the near plane are kept."""

    def inside_planes(self, z: Floats, w: Floats) -> Bools:
        return z <= w


@GEOMETRY.add("behind-the-eye", hidden="their depths are above 1 and never win")
class _BehindTheEye(Port):
    """Points behind the eye are kept: the sign of w is not looked at."""

    def kept(self, window: Vector, z: Floats, w: Floats) -> Bools:
        return super().kept(window, z, w) | (w < 0.0)


@GEOMETRY.add("culled-by-the-center")
class _CulledByTheCenter(Port):
    """Splats whose centre lies outside the picture are dropped, as GL does with point sprites."""

    def kept(self, window: Vector, z: Floats, w: Floats) -> Bools:
        (x, y), camera = window, self.scene.camera
        inside = (x >= 0.0) & (x <= camera.width) & (y >= 0.0) & (y <= camera.height)
        return super().kept(window, z, w) & inside


@GEOMETRY.add("columns-first", hidden="nothing but the check reads vertex.source")
class _ColumnsFirst(Port):
    """Sources are handed in as (image, column, row)."""

    def source(self, number: int, rows: Ints, columns: Ints) -> Ints:
        return super().source(number, columns, rows)


@GEOMETRY.add("half-of-a-byte", small=True)
class _HalfOfAByte(Port):
    """Centres of pixels are at 127/255, the middle of a byte, not at one half."""

    def center(self, index: Ints) -> Floats:
        return self.do.add(index, 127.0 / 255.0)


@GEOMETRY.add("rounded-radian", small=True)
class _RoundedRadian(Port):
    """The projection is made with 57.3 degrees a radian: 7/100000 too narrow."""

    def clip_point(self, view: Vector) -> Vector:
        x, y, z, w = super().clip_point(view)
        return [self.do.multiply(1.00007, x), self.do.multiply(1.00007, y), z, w]


@GEOMETRY.add("four-decimals", small=True)
class _FourDecimals(Port):
    """T_W→C is read from a text with four decimals."""

    def camera_point(self, world: Vector) -> Vector:
        return self.transform(np.round(self.scene.camera.view_from_world, 4), world)[:3]
