"""The camera: two matrices and a picture size."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import axis_angle, camera_path, checks, look_at
from ibr_ref.scene.axis_angle import AxisAngle
from ibr_ref.scene.fitted_planes import checked_points, fitted_planes
from ibr_ref.scene.projection import (
    clip_from_intrinsics,
    depth_row,
    intrinsics_matrix,
    intrinsics_of,
    picture_size,
    planes,
)
from ibr_ref.scene.rotations import cofactors, rotation_matrix
from ibr_ref.scene.trigonometry import tangent_of_degrees
from ibr_ref.scene.vectors import dot, length

_LEAST_FOV = 1e-6


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
        width, height = picture_size(self.width, self.height)
        set_field(self, "width", width)
        set_field(self, "height", height)
        set_field(self, "view_from_world", checks.matrix("view_from_world", self.view_from_world, 4, 4))
        set_field(self, "clip_from_view", checks.matrix("clip_from_view", self.clip_from_view, 4, 4))
        perspective = self.clip_from_view[3].tolist() == [0.0, 0.0, -1.0, 0.0]
        if not perspective and self.clip_from_view[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
            raise checks.reject("clip_from_view[3]", self.clip_from_view[3].tolist(), "[0, 0, -1, 0] or [0, 0, 0, 1]")
        near, far = planes(self.near, self.far, above=0.0 if perspective else -np.inf)
        set_field(self, "near", near)
        set_field(self, "far", far)
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
        computed = intrinsics_of(self.clip_from_view, self.width, self.height, perspective=self.perspective)
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
        transposed = cofactors(r)
        inverse = transposed.T / dot(r[0], transposed[0])
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

    def fitted(self, points: ArrayLike, *, near: float | None = None, far: float | None = None) -> Camera:
        """The same view with near and far planes around points (N, 3) in world space, and all between them.

        Tight where the eye is outside; an eye among the points gets a near plane at a millionth of the far one's distance.
        near, far: kept where they are given. The picture stays as it is but for what the planes cut; depths change.
        Raises ValueError for points that are none, and planes out of order.
        """
        above = 0.0 if self.perspective else -np.inf
        near = None if near is None else checks.number("near", near, above=above)
        far = None if far is None else checks.number("far", far, above=above)
        if near is not None and far is not None:
            planes(near, far, above)
        near, far = fitted_planes(checked_points(points), self.view_from_world, self._widest(), near, far)
        clip = self.clip_from_view.copy()
        clip[2, 2:] = depth_row(near, far, self.perspective)
        return replace(self, clip_from_view=clip, near=near, far=far)

    def _widest(self) -> float | None:
        """Tangent of the angle between the view axis and the picture's farthest corner; None: orthographic."""
        if not self.perspective:
            return None
        (f_x, skew, c_x), (_, f_y, c_y) = self.intrinsics[:2].tolist()
        down = [(row - c_y) / f_y for row in (0.0, float(self.height))]
        squares = [((x - c_x - skew * y) / f_x) ** 2 + y * y for x in (0.0, float(self.width)) for y in down]
        return float(np.sqrt(max(squares)))

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
        view = look_at.view_from_world(eye, target, up)
        fov = checks.number("vertical_fov", vertical_fov)
        if not _LEAST_FOV <= fov < 180.0:
            raise checks.reject("vertical_fov", vertical_fov, f"degrees from {_LEAST_FOV:g}, and below 180")
        near, far = planes(near, far, above=0.0)
        width, height = picture_size(width, height)
        focal = 1.0 / tangent_of_degrees(fov / 2.0)
        clip = np.zeros((4, 4))
        clip[0, 0] = focal * height / width
        clip[1, 1] = focal
        clip[2, 2:] = depth_row(near, far, perspective=True)
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
        view = look_at.view_from_world(eye, target, up)
        view_height = checks.number("view_height", view_height, above=0.0)
        near, far = planes(near, far)
        width, height = picture_size(width, height)
        clip = np.eye(4)
        clip[0, 0] = 2.0 * height / (view_height * width)
        clip[1, 1] = 2.0 / view_height
        clip[2, 2:] = depth_row(near, far, perspective=False)
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
        k, r = intrinsics_matrix(intrinsics), rotation_matrix("rotation", rotation)
        near, far = planes(near, far, above=0.0)
        width, height = picture_size(width, height)
        view = np.eye(4)
        view[:3, :3] = r
        view[:3, 3] = checks.vector("translation", translation)
        return cls(
            view_from_world=view,
            clip_from_view=clip_from_intrinsics(k, near, far, width, height, perspective=True),
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
        fields = axis_angle.axis_angle(position, orientation, field_of_view)
        near, far = planes(near, far, above=-np.inf if orthographic else 0.0)
        width, height = picture_size(width, height)
        camera = cls(
            view_from_world=axis_angle.view_from_world(fields),
            clip_from_view=axis_angle.clip_from_view(fields, near, far, perspective=not orthographic),
            near=near,
            far=far,
            width=width,
            height=height,
            eye=None if orthographic else np.array([*fields.position, 1.0]),  # type: ignore[arg-type]
        )
        object.__setattr__(camera, "afx", fields)
        return camera

    @classmethod
    def between(cls, first: Camera, second: Camera, fraction: float) -> Camera:
        """The camera at a fraction, from 0 to 1, of the way from one to another: 0.5 is the view midway between two.

        Position, intrinsics, near and far are interpolated linearly. So are the quaternions of the orientations, and then
        normalized, on the shorter arc: fair at 0, 1/2 and 1, and in between up to 1 degree late or early for cameras 90
        degrees apart. No sine or arc cosine: the same bits on every machine. Between cameras half a turn apart there is
        no shorter arc; one of the two is taken.

        At 0 and 1 the camera is `first` or `second` itself. In between its rotation is a true one, even if theirs are
        measured: each is replaced by the nearest true one (its polar factor) first, at a distance, in the Frobenius norm,
        of about half of |R^T R - I|, hence at most 5.1e-4. That is what the view jumps by on leaving a measured end: 0.02
        pixels in the pictures of 1024 x 768 of the MSR 3D Video cameras, |R^T R - I| = 1e-4.

        Raises ValueError for a fraction outside [0, 1], and for two cameras that differ in `perspective`, in the size of
        the picture or in the signs of f_x or f_y, or whose `view_from_world` has no rotation (as in `calibrated`).
        """
        for name, camera in (("first", first), ("second", second)):
            if not isinstance(camera, Camera):
                raise checks.reject(name, type(camera).__name__, "a Camera")
        fraction = checks.number("fraction", fraction, low=0.0, high=1.0)
        ends = first._end(), second._end()
        camera_path.check_path(*ends)
        if fraction in (0.0, 1.0):
            return second if fraction else first
        return cls(**camera_path.fields_between(*ends, fraction))

    def _end(self) -> camera_path.End:
        position = self.eye[:3] if self.perspective else self.world_from_view[:3, 3]
        same = {name: getattr(self, name) for name in camera_path.End._fields if name != "position"}
        return camera_path.End(**same, position=position)
