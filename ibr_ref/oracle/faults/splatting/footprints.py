"""Bugs of the Jacobians of ellipses, as people make them in shaders of Gaussian splats."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.splatting.case import Floats, Image, Vector
from ibr_ref.oracle.programs.splatting.port import Port

FOOTPRINTS = Bugs("vertex", only=("ellipse",))


@FOOTPRINTS.add("ellipse-without-the-divide's-terms")
class _WithoutDivide(Port):
    """The Jacobian lacks the terms of the perspective divide, -x/w² and -y/w²: only 1/w is left of it."""

    def projected_step(self, x: Floats, ndc: Floats, along: Floats) -> Floats:
        return x


@FOOTPRINTS.add("ellipse-y-upwards")
class _YUpwards(Port):
    """The Jacobian's y points upwards, as in clip space, while the window's points down: ellipses are mirrored."""

    def window_step(self, step: Vector, ndc: Vector, w: Floats) -> Vector:
        x, y = super().window_step(step, ndc, w)
        return [x, np.negative(y)]


@FOOTPRINTS.add("ellipse-jacobian-transposed")
class _Transposed(Port):
    """The covariance is Jᵀ J for J Jᵀ: rows are taken for columns."""

    def squares(self, x_u: Floats, y_u: Floats, x_v: Floats, y_v: Floats) -> Vector:
        return super().squares(x_u, x_v, y_u, y_v)


@FOOTPRINTS.add("ellipse-whole-viewport")
class _WholeViewport(Port):
    """The Jacobian is multiplied by the viewport's size, not by its half: NDC runs from -1 to 1."""

    def window_step(self, step: Vector, ndc: Vector, w: Floats) -> Vector:
        return [self.do.multiply(2.0, x) for x in super().window_step(step, ndc, w)]


@FOOTPRINTS.add("ellipse-width-for-height")
class _WidthForHeight(Port):
    """The Jacobian's y is multiplied by half the viewport's width: the aspect ratio is forgotten."""

    def window_step(self, step: Vector, ndc: Vector, w: Floats) -> Vector:
        x, y = super().window_step(step, ndc, w)
        return [x, self.do.multiply(self.scene.camera.width / self.scene.camera.height, y)]


@FOOTPRINTS.add("ellipse-normal-away")
class _NormalAway(Port):
    """The footprint's normal has the wrong sign: it points away from the reference camera."""

    def tangent_normal(self, codes: Vector) -> Vector:
        return [np.negative(x) for x in super().tangent_normal(codes)]


@FOOTPRINTS.add("ellipse-faces-the-reference")
class _FacesReference(Port):
    """The normal is left out: splats face the reference camera, J is that of steps at a constant depth."""

    def along_plane(self, step: Vector, sight: Vector, normal: Vector, facing: Floats) -> Vector:
        return step


@FOOTPRINTS.add("ellipse-cosine-not-bounded")
class _CosineNotBounded(Port):
    """The cosine of normal and line of sight is not kept from 0: splats that are seen from their edge become spikes."""

    def facing(self, normal: Vector, sight: Vector) -> Floats:
        return self.do.dot(normal, sight)


@FOOTPRINTS.add("ellipse-bound-without-the-length", small=True)
class _BoundWithoutLength(Port):
    """n·d is kept below -1/2, not below -|d|/2: d, at depth 1, is longer than 1 beside the middle."""

    def facing(self, normal: Vector, sight: Vector) -> Floats:
        return np.minimum(self.do.dot(normal, sight), -self.least_cosine())


@FOOTPRINTS.add("ellipse-sight-along-the-axis")
class _SightAlongAxis(Port):
    """The line of sight is the reference camera's axis for every pixel."""

    def sight(self, camera: Any, x_n: Floats, y_n: Floats, one: Floats) -> Vector:
        return [0.0 * one, 0.0 * one, -one]


@FOOTPRINTS.add("ellipse-steps-not-scaled")
class _StepsNotScaled(Port):
    """A reference pixel is as wide at every depth: the step 1/f is not multiplied by the depth."""

    def step_scale(self, camera: Any, depth: Floats) -> Floats:
        return np.ones(np.shape(depth))


@FOOTPRINTS.add("ellipse-steps-not-turned")
class _StepsNotTurned(Port):
    """Steps and line of sight stay in the reference camera's space, while the normal is in world space."""

    def turned(self, camera: Any, step: Vector) -> Vector:
        return step


@FOOTPRINTS.add("ellipse-skew-left-out")
class _SkewLeftOut(Port):
    """The step to the pixel below does not follow the intrinsics' skew."""

    def pixel_steps(self, camera: Any, depth: Floats) -> list[Vector]:
        across, (_, down, flat) = super().pixel_steps(camera, depth)
        return [across, [0.0, down, flat]]


@FOOTPRINTS.add("ellipse-jacobian-half-floats", small=True)
class _JacobianHalfFloats(Port):
    """The Jacobian is kept in half floats: mediump."""

    def jacobian(self, image: Image, texels: Any, view: Vector, clip: Vector) -> Vector:
        return [half(x) for x in super().jacobian(image, texels, view, clip)]
