"""Bugs of the vertex stage: where the points are."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
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


@GEOMETRY.add("rows-upwards")
class _RowsUpwards(Port):
    """Rows of the reference are taken to run upwards: y is not negated when pixels are unprojected."""

    def view_point(self, camera: Any, columns: Ints, rows: Ints, depth: Floats) -> Vector:
        x, y, z = super().view_point(camera, columns, rows, depth)
        return [x, -y, z]


@GEOMETRY.add("center-of-the-image")
class _CenterOfTheImage(Port):
    """The principal point is taken to be the middle of the image."""

    def intrinsics(self, camera: Any) -> Any:
        k = camera.intrinsics.copy()
        k[:2, 2] = 0.5 * camera.width, 0.5 * camera.height
        return k


@GEOMETRY.add("depth-behind-the-near-plane")
class _DepthBehindTheNearPlane(Port):
    """Depths are taken to be measured from the near plane, not from the eye."""

    def view_point(self, camera: Any, columns: Ints, rows: Ints, depth: Floats) -> Vector:
        return super().view_point(camera, columns, rows, self.do.add(depth, self.do.number(camera.near)))


@GEOMETRY.add("view-matrix-transposed")
class _ViewMatrixTransposed(Port):
    """The rotation of T_W→C is uploaded row by row into a shader that reads columns."""

    def camera_point(self, world: Vector) -> Vector:
        matrix = self.scene.camera.view_from_world.copy()
        matrix[:3, :3] = matrix[:3, :3].T.copy()
        return self.transform(matrix, world)[:3]


@GEOMETRY.add("aspect-left-out")
class _AspectLeftOut(Port):
    """The projection is made for a square picture: x is as wide as y is high."""

    def clip_point(self, view: Vector) -> Vector:
        x, y, z, w = super().clip_point(view)
        return [self.do.multiply(x, self.do.number(self.scene.camera.width / self.scene.camera.height)), y, z, w]


@GEOMETRY.add("depth-not-divided")
class _DepthNotDivided(Port):
    """Window depth is z of clip space, not divided by w: gl_FragDepth = gl_Position.z."""

    def projected(self, clip: Vector, view: Vector) -> tuple[Vector, Floats]:
        window, _ = super().projected(clip, view)
        return window, clip[2]


@GEOMETRY.add("linear-depth", hidden="the depths keep their order, hence the colours")
class _LinearDepth(Port):
    """Window depth is linear between the planes, as depth maps often are."""

    def projected(self, clip: Vector, view: Vector) -> tuple[Vector, Floats]:
        near, far = self.do.number(self.scene.camera.near), self.do.number(self.scene.camera.far)
        window, _ = super().projected(clip, view)
        return window, self.do.divide(self.do.subtract(-view[2], near), self.do.subtract(far, near))


@GEOMETRY.add("reversed-depth")
class _ReversedDepth(Port):
    """Window depth is 1 − z, by a reversed projection, and the test is LESS all the same."""

    def window_depth(self, z: Floats) -> Floats:
        return self.do.subtract(1.0, z)


@GEOMETRY.add("far-plane-open", hidden="their depths are above 1 and never win")
class _FarPlaneOpen(Port):
    """Points beyond the far plane are kept."""

    def inside_planes(self, z: Floats, w: Floats) -> Bools:
        return z >= 0.0


@GEOMETRY.add("planes-of-minus-one")
class _PlanesOfMinusOne(Port):
    """Points are kept for −w ≤ z, where clip z begins at 0."""

    def inside_planes(self, z: Floats, w: Floats) -> Bools:
        return (z >= -w) & (z <= w)


@GEOMETRY.add("whole-pixels")
class _WholePixels(Port):
    """Window positions are cast to integers."""

    def window_x(self, x: Floats) -> Floats:
        return np.floor(super().window_x(x))

    def window_y(self, y: Floats) -> Floats:
        return np.floor(super().window_y(y))


@GEOMETRY.add("window-of-half-precision", small=True)
class _WindowOfHalfPrecision(Port):
    """Normalized device coordinates are half floats: mediump."""

    def window_x(self, x: Floats) -> Floats:
        return super().window_x(half(x))

    def window_y(self, y: Floats) -> Floats:
        return super().window_y(half(y))


@GEOMETRY.add("intrinsics-of-two-decimals", small=True)
class _IntrinsicsOfTwoDecimals(Port):
    """The intrinsics are read from a text with two decimals."""

    def intrinsics(self, camera: Any) -> Any:
        return np.round(camera.intrinsics, 2)


@GEOMETRY.add("reference-pose-of-four-decimals", small=True)
class _ReferencePoseOfFourDecimals(Port):
    """T_R→W is read from a text with four decimals."""

    def world_from_view(self, camera: Any) -> Any:
        return np.round(camera.world_from_view, 4)


@GEOMETRY.add("projection-of-four-decimals", small=True)
class _ProjectionOfFourDecimals(Port):
    """T_P is read from a text with four decimals."""

    def clip_point(self, view: Vector) -> Vector:
        return self.transform(np.round(self.scene.camera.clip_from_view, 4), view)


@GEOMETRY.add("far-plane-at-infinity", small=True, hidden="the depths keep their order, hence the colours")
class _FarPlaneAtInfinity(Port):
    """Window depth is that of a projection without a far plane, 1 − near/−z."""

    def projected(self, clip: Vector, view: Vector) -> tuple[Vector, Floats]:
        window, _ = super().projected(clip, view)
        return window, self.do.add(1.0, self.do.divide(self.do.number(self.scene.camera.near), view[2]))
