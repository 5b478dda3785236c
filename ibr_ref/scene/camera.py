"""The camera: two matrices and a picture size."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import checks
from ibr_ref.scene.trigonometry import sine_cosine, tangent_of_degrees
from ibr_ref.scene.vectors import Array, cross, dot, length, unit

MOST_PIXELS = 65536
"""Largest width and height of a picture."""

_FARTHEST = 1e50
_LEAST_FOV = 1e-6


class AxisAngle(NamedTuple):
    """What `Camera.axis_angle` was given. Files keep these numbers, not the matrices made of them."""

    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    field_of_view: tuple[float, float]


def _moderate(field: str, value: ArrayLike) -> Array:
    """A vector whose products of four components do not overflow."""
    result = checks.vector(field, value)
    if not abs(result).max() <= _FARTHEST:
        raise checks.reject(field, result.tolist(), f"numbers between {-_FARTHEST:g} and {_FARTHEST:g}")
    return result


def _view(eye: ArrayLike, target: ArrayLike, up: ArrayLike) -> NDArray[np.float64]:
    """view_from_world for a camera at `eye` that looks at `target`."""
    eye, target, up = _moderate("eye", eye), _moderate("target", target), _moderate("up", up)
    forward = target - eye
    if dot(forward, forward) == 0.0:
        raise checks.reject("target", target.tolist(), "a point other than the eye")
    right = cross(forward, up)
    if dot(right, right) <= 1e-24 * dot(forward, forward) * dot(up, up):
        raise checks.reject("up", up.tolist(), "a direction that is not parallel to the line of sight")
    forward, right = forward / length(forward), right / length(right)
    top = cross(right, forward)
    view = np.eye(4)
    for row, axis in enumerate((right, top, -forward)):
        view[row, :3] = axis
        view[row, 3] = -dot(axis, eye)
    return view


def _depth_row(near: float, far: float, perspective: bool) -> tuple[float, float]:
    """Entries 2 and 3 of the clip matrix' row z: 0 at the near plane and w at the far plane."""
    return (far if perspective else 1.0) / (near - far), (near * far if perspective else near) / (near - far)


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """Where the picture is taken from, and how it is projected.

    View space is right-handed, looks down -z, +y up; NDC has y up and z in [0, 1], 0 at the near plane. Prefer
    `look_at`, `orthographic`, `calibrated` and `axis_angle` to the constructor.

    Raises ValueError for near or far out of order, a picture without pixels, matrices that are not invertible, or a
    projection that is off the view's -z axis, which no intrinsics express.
    """

    view_from_world: NDArray[np.float64]
    """(4, 4), rigid up to measurement error; its last row is (0, 0, 0, 1)."""
    clip_from_view: NDArray[np.float64]
    """(4, 4); its last row is (0, 0, -1, 0) for a perspective camera, (0, 0, 0, 1) for an orthographic one."""
    near: float
    """Distance of the near plane along the view axis, world units, > 0 (orthographic: any below far)."""
    far: float
    """Distance of the far plane, > near."""
    width: int
    """Columns of the picture."""
    height: int
    """Rows of the picture."""
    eye: NDArray[np.float64] = None  # type: ignore[assignment]
    """(4,) in world space: the eye (x, y, z, 1), or, orthographic, the unit direction towards it (x, y, z, 0). Left out,
    it is computed from the matrix."""
    intrinsics: NDArray[np.float64] = None  # type: ignore[assignment]
    """(3, 3) in pixels, [[f_x, s, c_x], [0, f_y, c_y], [0, 0, 1]]: window = intrinsics (x/-z, -y/-z, 1), or, orthographic,
    intrinsics (x, -y, 1), f_x and f_y then pixels a world unit. Left out, they are computed from the matrix."""
    afx: AxisAngle | None = field(default=None, init=False)
    """The fields that `axis_angle` made the camera of; None for all others."""

    def __post_init__(self) -> None:
        set_field = object.__setattr__
        set_field(self, "width", checks.whole("width", self.width, low=1, high=MOST_PIXELS))
        set_field(self, "height", checks.whole("height", self.height, low=1, high=MOST_PIXELS))
        set_field(self, "view_from_world", checks.matrix("view_from_world", self.view_from_world, 4, 4))
        set_field(self, "clip_from_view", checks.matrix("clip_from_view", self.clip_from_view, 4, 4))
        perspective = self.clip_from_view[3].tolist() == [0.0, 0.0, -1.0, 0.0]
        if not perspective and self.clip_from_view[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
            raise checks.reject("clip_from_view[3]", self.clip_from_view[3].tolist(), "[0, 0, -1, 0] or [0, 0, 0, 1]")
        if perspective:
            set_field(self, "near", checks.number("near", self.near, above=0.0))
        else:
            set_field(self, "near", checks.number("near", self.near))
        set_field(self, "far", checks.number("far", self.far))
        if not self.far > self.near:
            raise checks.reject("far", self.far, f"> near = {self.near:g}")
        if self.view_from_world[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
            raise checks.reject("view_from_world[3]", self.view_from_world[3].tolist(), "[0, 0, 0, 1]")
        for name in ("view_from_world", "clip_from_view"):
            if not abs(np.linalg.det(getattr(self, name))) > 0.0:
                raise checks.reject(name, "a singular matrix", "an invertible one")
        eye = self._eye(perspective) if self.eye is None else self.eye
        set_field(self, "eye", checks.vector("eye", eye, 4))
        if self.eye[3] != float(perspective):
            raise checks.reject("eye[3]", float(self.eye[3]), "1 for a perspective camera, 0 for an orthographic one")
        set_field(self, "intrinsics", self._checked_intrinsics())

    def _eye(self, perspective: bool) -> NDArray[np.float64]:
        if perspective:
            return np.append(self.world_from_view[:3, 3], 1.0)
        axis = self.world_from_view[:3, 2]
        return np.append(axis / length(axis), 0.0)

    def _checked_intrinsics(self) -> NDArray[np.float64]:
        """The matrix' own, or those given, which may differ from them by rounding."""
        half_width, half_height = self.width / 2.0, self.height / 2.0
        x, y = self.clip_from_view[:2].tolist()
        if self.perspective:
            unused, shift_x, shift_y = (x[3], y[0], y[3]), -x[2], y[2]
        else:
            unused, shift_x, shift_y = (x[2], y[0], y[2]), x[3], -y[3]
        if any(unused):
            form = "[[a, b, c, 0], [0, d, e, 0]]" if self.perspective else "[[a, b, 0, c], [0, d, 0, e]]"
            raise checks.reject("clip_from_view[:2]", [x, y], form)
        row_x = [x[0] * half_width, 0.0 - x[1] * half_width, (1.0 + shift_x) * half_width]
        row_y = [0.0, y[1] * half_height, (1.0 + shift_y) * half_height]
        computed = checks.matrix("intrinsics", [row_x, row_y, [0.0, 0.0, 1.0]], 3, 3)
        given = computed if self.intrinsics is None else checks.matrix("intrinsics", self.intrinsics, 3, 3)
        if not np.abs(given - computed).max() <= 1e-9 * np.abs(computed).max():
            raise checks.reject(
                "intrinsics", given.tolist(), f"those of clip_from_view and the size, {computed.tolist()}"
            )
        return given

    @property
    def world_from_view(self) -> NDArray[np.float64]:
        """(4, 4) inverse of `view_from_world`: adjugate over determinant, as a measured rotation's transpose is not it."""
        r, t = self.view_from_world[:3, :3], self.view_from_world[:3, 3]
        columns = (cross(r[1], r[2]), cross(r[2], r[0]), cross(r[0], r[1]))
        inverse = np.stack(columns, axis=1) / dot(r[0], columns[0])
        result = np.eye(4)
        result[:3, :3] = inverse
        result[:3, 3] = [-dot(row, t) for row in inverse]
        return result

    @property
    def clip_from_world(self) -> NDArray[np.float64]:
        """(4, 4) product of the two matrices. The stages apply them one after the other instead."""
        return self.clip_from_view @ self.view_from_world

    @property
    def perspective(self) -> bool:
        """Whether lines of sight meet in the eye."""
        return bool(self.eye[3] == 1.0)

    @classmethod
    def look_at(
        cls,
        *,
        eye: ArrayLike,
        target: ArrayLike,
        up: ArrayLike = (0.0, 0.0, 1.0),
        vertical_fov: float = 45.0,
        near: float = 0.1,
        far: float = 100.0,
        width: int = 640,
        height: int = 480,
    ) -> Camera:
        """A perspective camera; `vertical_fov` in degrees, above 0 and below 180.

        Raises ValueError if the eye is the target, `up` is parallel to the line of sight, or the projection degenerate.
        """
        view = _view(eye, target, up)
        fov = checks.number("vertical_fov", vertical_fov)
        if not _LEAST_FOV <= fov < 180.0:
            raise checks.reject("vertical_fov", vertical_fov, f"degrees from {_LEAST_FOV:g}, and below 180")
        near, far = _planes(near, far, above=0.0)
        width, height = _size(width, height)
        focal = 1.0 / tangent_of_degrees(fov / 2.0)
        clip = np.zeros((4, 4))
        clip[0, 0] = focal * height / width
        clip[1, 1] = focal
        clip[2, 2:] = _depth_row(near, far, perspective=True)
        clip[3, 2] = -1.0
        eye = np.append(checks.vector("eye", eye), 1.0)  # as given: the inverse would return it rounded
        return cls(view_from_world=view, clip_from_view=clip, near=near, far=far, width=width, height=height, eye=eye)

    @classmethod
    def orthographic(
        cls,
        *,
        eye: ArrayLike,
        target: ArrayLike,
        up: ArrayLike = (0.0, 0.0, 1.0),
        view_height: float,
        near: float = 0.1,
        far: float = 100.0,
        width: int = 640,
        height: int = 480,
    ) -> Camera:
        """A camera with parallel lines of sight; `view_height` is the height of what it sees, in world units, > 0."""
        view = _view(eye, target, up)
        view_height = checks.number("view_height", view_height, above=0.0)
        near, far = _planes(near, far)
        width, height = _size(width, height)
        clip = np.eye(4)
        clip[0, 0] = 2.0 * height / (view_height * width)
        clip[1, 1] = 2.0 / view_height
        clip[2, 2:] = _depth_row(near, far, perspective=False)
        return cls(view_from_world=view, clip_from_view=clip, near=near, far=far, width=width, height=height)

    @classmethod
    def calibrated(
        cls,
        *,
        intrinsics: ArrayLike,
        rotation: ArrayLike,
        translation: ArrayLike,
        near: float,
        far: float,
        width: int,
        height: int,
    ) -> Camera:
        """A measured camera: p_view = rotation p_world + translation, window = intrinsics (x/-z, -y/-z, 1).

        intrinsics (3, 3) in pixels, with the pixels' centres at half-integers: [[f_x, s, c_x], [0, f_y, c_y], [0, 0, 1]].
        Raises ValueError if it has another form or is not invertible, or if the rotation is not one (Frobenius norm of
        R^T R - I above 1e-3, or a mirroring).
        """
        k = checks.matrix("intrinsics", intrinsics, 3, 3)
        if not (k[0, 0] * k[1, 1] != 0.0 and k[1, 0] == 0.0 and k[2].tolist() == [0.0, 0.0, 1.0]):
            raise checks.reject("intrinsics", k.tolist(), "an invertible [[f_x, s, c_x], [0, f_y, c_y], [0, 0, 1]]")
        r = checks.matrix("rotation", rotation, 3, 3)
        defect = float(np.linalg.norm(r.T @ r - np.eye(3)))
        if defect > 1e-3 or np.linalg.det(r) < 0.0:
            raise checks.reject(
                "rotation", r.tolist(), f"a rotation (|R^T R - I| = {defect:.3g} must be <= 1e-3, det > 0)"
            )
        near, far = _planes(near, far, above=0.0)
        width, height = _size(width, height)
        view = np.eye(4)
        view[:3, :3] = r
        view[:3, 3] = checks.vector("translation", translation)
        clip = np.zeros((4, 4))
        clip[0, :3] = 2.0 * k[0, 0] / width, -2.0 * k[0, 1] / width, 1.0 - 2.0 * k[0, 2] / width
        clip[1, 1:3] = 2.0 * k[1, 1] / height, 2.0 * k[1, 2] / height - 1.0
        clip[2, 2:] = _depth_row(near, far, perspective=True)
        clip[3, 2] = -1.0
        return cls(
            view_from_world=view,
            clip_from_view=clip,
            near=near,
            far=far,
            width=width,
            height=height,
            intrinsics=k,  # as given: the matrix would return them rounded
        )

    @classmethod
    def axis_angle(
        cls,
        *,
        position: ArrayLike,
        orientation: ArrayLike,
        field_of_view: ArrayLike,
        orthographic: bool = False,
        near: float = 0.1,
        far: float = 100.0,
        width: int = 640,
        height: int = 480,
    ) -> Camera:
        """The camera of an MPEG-4 AFX `DepthImage` (ISO/IEC 14496-16).

        position (3,) in world space. orientation (x, y, z, angle): the turn, by an angle in radians about an axis of any
        length but 0, from a camera that looks down -z of the world, +y up. field_of_view: the full horizontal and
        vertical angles in radians, above 0 and below pi; orthographic, the width and height of what it sees, in world
        units, > 0. The numbers given stay in `afx`. Raises ValueError for others.
        """
        at = checks.vector("position", position)
        turn = checks.vector("orientation", orientation, 4)
        fov = checks.vector("field_of_view", field_of_view, 2)
        near, far = _planes(near, far, above=-np.inf if orthographic else 0.0)
        width, height = _size(width, height)
        view = np.eye(4)
        # The rotation is world from view; it is orthogonal to the last bit or two, so its transpose is its inverse.
        view[:3, :3] = _rotation(turn).T
        view[:3, 3] = [-dot(row, at) for row in view[:3, :3]]
        clip = np.eye(4)
        clip[0, 0], clip[1, 1] = _scales(fov, orthographic)
        clip[2, 2:] = _depth_row(near, far, perspective=not orthographic)
        if not orthographic:
            clip[3, 2:] = -1.0, 0.0
        camera = cls(
            view_from_world=view,
            clip_from_view=clip,
            near=near,
            far=far,
            width=width,
            height=height,
            eye=None if orthographic else np.append(at, 1.0),  # type: ignore[arg-type]
        )
        object.__setattr__(camera, "afx", AxisAngle(tuple(at.tolist()), tuple(turn.tolist()), tuple(fov.tolist())))
        return camera


def _rotation(orientation: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) by Rodrigues' formula, from (x, y, z, angle)."""
    longest = float(np.abs(orientation[:3]).max())
    if longest == 0.0 or not abs(orientation[3]) <= 1e6:
        raise checks.reject("orientation", orientation.tolist(), "an axis that is not zero, an angle from -1e6 to 1e6")
    x, y, z = unit(orientation[:3]).tolist()
    s, c = sine_cosine(float(orientation[3]))
    t = 1.0 - c
    return np.array(
        [
            (t * x * x + c, t * x * y - s * z, t * x * z + s * y),
            (t * x * y + s * z, t * y * y + c, t * y * z - s * x),
            (t * x * z - s * y, t * y * z + s * x, t * z * z + c),
        ]
    )


def _scales(field_of_view: NDArray[np.float64], orthographic: bool) -> tuple[float, float]:
    """NDC x and y at x = y = 1 of the view, at a distance of 1."""
    scales = []
    for size in field_of_view.tolist():
        above, below = (size / 2.0, 1.0) if orthographic else sine_cosine(size / 2.0)
        scale = below / above if above > 0.0 and (orthographic or size < math.pi) else math.inf
        if not 0.0 < scale < math.inf:
            allowed = "a width and a height > 0" if orthographic else "angles in radians above 0 and below pi"
            raise checks.reject("field_of_view", field_of_view.tolist(), allowed)
        scales.append(scale)
    return scales[0], scales[1]


def _planes(near: float, far: float, above: float = -np.inf) -> tuple[float, float]:
    near = checks.number("near", near, above=above)
    far = checks.number("far", far)
    if not far > near:
        raise checks.reject("far", far, f"> near = {near:g}")
    return near, far


def _size(width: int, height: int) -> tuple[int, int]:
    return (
        checks.whole("width", width, low=1, high=MOST_PIXELS),
        checks.whole("height", height, low=1, high=MOST_PIXELS),
    )
