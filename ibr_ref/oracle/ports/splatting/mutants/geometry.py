"""Bugs in stage 3: where the points are."""
# An override does what its parent says, but for the fault in the class's docstring.
# ruff: noqa: D102

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.atlas import Integers
from ibr_ref.oracle.ports.splatting.mutants.seeded import mutant
from ibr_ref.oracle.ports.splatting.vertex import Vertex


class PixelCorners(Vertex):
    """Pixels are unprojected from their corners, not from their centres."""

    def center(self, index: ArrayLike) -> Floats:
        return np.asarray(index, np.float64)


class SquarePixels(Vertex):
    """f_x is used for rows, too."""

    def intrinsics(self, camera: Any) -> Floats:
        k = super().intrinsics(camera).copy()
        k[1, 1] = k[0, 0]
        return k


class NoSkew(Vertex):
    """The skew is left out."""

    def intrinsics(self, camera: Any) -> Floats:
        k = super().intrinsics(camera).copy()
        k[0, 1] = 0.0
        return k


class DepthAlongTheRay(Vertex):
    """The depth is taken as the distance from the eye."""

    def view_point(self, camera: Any, columns: ArrayLike, rows: ArrayLike, depth: Floats) -> list[Floats]:
        point = super().view_point(camera, columns, rows, depth)
        shorter = self.alu.divide(depth, self.length(point))
        return [self.alu.multiply(shorter, value) for value in point]


class AlwaysPerspective(Vertex):
    """Lines of sight of an orthographic reference camera spread from its eye."""

    def stretch(self, camera: Any, x: Floats, y: Floats, depth: Floats) -> tuple[Floats, Floats]:
        return self.alu.multiply(x, depth), self.alu.multiply(y, depth)


class TransposeForInverse(Vertex):
    """T_R→W is made with the transpose of the measured rotation."""

    def world_from_view(self, camera: Any) -> ArrayLike:
        matrix: NDArray[np.float64] = np.eye(4)
        matrix[:3, :3] = camera.view_from_world[:3, :3].T
        matrix[:3, 3] = -matrix[:3, :3] @ camera.view_from_world[:3, 3]
        return matrix


class RotationTransposed(Vertex):
    """T_R→W is uploaded with rows for columns in its rotation."""

    def world_from_view(self, camera: Any) -> ArrayLike:
        matrix: NDArray[np.float64] = camera.world_from_view.copy()
        matrix[:3, :3] = matrix[:3, :3].T.copy()
        return matrix


class FirstCameraForAll(Vertex):
    """T_R→W of the first image is used for all: the uniform is not updated."""

    def world_from_view(self, camera: Any) -> ArrayLike:
        return super().world_from_view(self.scene.images[0].camera)


class WindowUpwards(Vertex):
    """Window y grows upwards."""

    def window_y(self, y: Floats) -> Floats:
        return super().window_y(-y)


class LastPixelForSize(Vertex):
    """Window x is scaled by width − 1."""

    def window_x(self, x: Floats) -> Floats:
        return self.alu.multiply(self.alu.multiply(0.5, self.alu.add(x, 1.0)), self.scene.camera.width - 1.0)


class HalfPixelShift(Vertex):
    """Window positions have the pixels' centres at whole numbers."""

    def window_x(self, x: Floats) -> Floats:
        return self.alu.subtract(super().window_x(x), 0.5)


class TwoSubpixelsShift(Vertex):
    """Window y is off by 1/128 pixel."""

    def window_y(self, y: Floats) -> Floats:
        return self.alu.add(super().window_y(y), 1.0 / 128.0)


class DepthFromMinusOne(Vertex):
    """Window depth is z of a space from −1 to 1, halved and moved, though it is from 0 to 1 already."""

    def window_depth(self, z: Floats) -> Floats:
        return self.alu.multiply(0.5, self.alu.add(z, 1.0))


class NearPlaneOpen(Vertex):
    """Points between the eye and the near plane are kept."""

    def inside_planes(self, z: Floats, w: Floats) -> Bools:
        return z <= w


class BehindTheEye(Vertex):
    """Points behind the eye are kept: the sign of w is not looked at."""

    def kept(self, window: tuple[Floats, Floats], z: Floats, w: Floats) -> Bools:
        return np.asarray(super().kept(window, z, w) | (w < 0.0))


class CulledByTheCenter(Vertex):
    """Splats whose centre lies outside the picture are dropped, as GL does with point sprites."""

    def kept(self, window: tuple[Floats, Floats], z: Floats, w: Floats) -> Bools:
        (x, y), camera = window, self.scene.camera
        inside = (x >= 0.0) & (x <= camera.width) & (y >= 0.0) & (y <= camera.height)
        return np.asarray(super().kept(window, z, w) & inside)


class ColumnsFirst(Vertex):
    """Sources are handed in as (image, column, row)."""

    def source(self, number: int, rows: Integers, columns: Integers) -> Integers:
        return super().source(number, columns, rows)


class HalfOfAByte(Vertex):
    """Centres of pixels are at 127/255, the middle of a byte, not at one half."""

    def center(self, index: ArrayLike) -> Floats:
        return self.alu.add(index, 127.0 / 255.0)


class RoundedRadian(Vertex):
    """The projection is made with 57.3 degrees a radian: 7/100000 too narrow."""

    def clip_point(self, view: list[Floats]) -> list[Floats]:
        x, y, z, w = super().clip_point(view)
        return [self.alu.multiply(1.00007, x), self.alu.multiply(1.00007, y), z, w]


class FourDecimals(Vertex):
    """T_W→C is read from a text with four decimals."""

    def camera_point(self, world: list[Floats]) -> list[Floats]:
        return self.transform(np.round(self.scene.camera.view_from_world, 4), world)[:3]


MUTANTS = (
    mutant(PixelCorners),
    mutant(SquarePixels),
    mutant(NoSkew),
    mutant(DepthAlongTheRay),
    mutant(AlwaysPerspective),
    mutant(TransposeForInverse, small=True),
    mutant(RotationTransposed),
    mutant(FirstCameraForAll),
    mutant(WindowUpwards),
    mutant(LastPixelForSize),
    mutant(HalfPixelShift),
    mutant(TwoSubpixelsShift, small=True),
    mutant(DepthFromMinusOne, hidden="the depths keep their order, hence the colours"),
    mutant(NearPlaneOpen),
    mutant(BehindTheEye, hidden="their depths are above 1 and never win"),
    mutant(CulledByTheCenter),
    mutant(ColumnsFirst, hidden="nothing but the check reads vertex.source"),
    mutant(HalfOfAByte, small=True),
    mutant(RoundedRadian, small=True),
    mutant(FourDecimals, small=True),
)
