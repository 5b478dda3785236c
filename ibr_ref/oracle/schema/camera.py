"""A camera in `case.json`: what it was made from, and every matrix that a port may want."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from ibr_ref.oracle.schema.base import Matrix3, Matrix4, Model, Vector2, Vector3, Vector4, numbers
from ibr_ref.scene import Camera, checks
from ibr_ref.scene.projection import MOST_PIXELS, depth_row

Side = Annotated[int, Field(ge=1, le=MOST_PIXELS)]


class AxisAngle(Model):
    """The fields of an MPEG-4 AFX DepthImage (ISO/IEC 14496-16)."""

    position: Vector3
    orientation: Vector4
    """Axis x, y, z and angle in radians."""
    field_of_view: Vector2
    """Horizontal and vertical, radians; orthographic: width and height in world units."""


class CameraFile(Model):
    """Reference matrices are applied one after the other, view_from_world first, each row summed from left to right."""

    projection: Literal["perspective", "orthographic"]
    eye: Vector4
    """World space: the eye (x, y, z, 1), or, orthographic, the unit direction towards it (x, y, z, 0)."""
    view_from_world: Matrix4
    """Right-handed, looking down -z, +y up, +x right. Row by row."""
    world_from_view: Matrix4
    clip_from_view: Matrix4
    """z in [0, 1]: Vulkan, Direct3D, Metal, WebGPU. y up."""
    clip_from_view_gl: Matrix4
    """z in [-1, 1]: OpenGL without glClipControl. Window depth comes out the same."""
    clip_from_world: Matrix4
    clip_from_world_gl: Matrix4
    intrinsics: Matrix3
    """Pixels: window = intrinsics (x/-z, -y/-z, 1) of view space; orthographic: intrinsics (x, -y, 1)."""
    near: float
    """Distance of the near plane along the view axis, world units."""
    far: float
    width: Side
    """Columns of the picture."""
    height: Side
    """Rows of the picture."""
    axis_angle: AxisAngle | None = None
    """What the matrices were made of, where that is known; reference files keep it."""


_PLANES_ROUNDING, _EYE_ROUNDING = 1e-15, 1e-12
"""Relative, by which near and far may differ from clip_from_view, and the eye from view_from_world."""


def describe_camera(camera: Camera) -> CameraFile:
    """The camera as a document. Raises ValueError for one that contradicts itself."""
    found = contradiction(camera)
    if found is not None:
        raise checks.reject(f"camera.{found[0]}", *found[1:])
    view, clip = camera.view_from_world, camera.clip_from_view
    clip_gl = gl_clip(clip)
    afx = camera.afx
    return CameraFile(
        projection="perspective" if camera.perspective else "orthographic",
        eye=numbers(camera.eye),
        view_from_world=numbers(view),
        world_from_view=numbers(camera.world_from_view),
        clip_from_view=numbers(clip),
        clip_from_view_gl=numbers(clip_gl),
        clip_from_world=numbers(product(clip, view)),
        clip_from_world_gl=numbers(product(clip_gl, view)),
        intrinsics=numbers(camera.intrinsics),
        near=camera.near,
        far=camera.far,
        width=camera.width,
        height=camera.height,
        axis_angle=None if afx is None else AxisAngle(**afx._asdict()),
    )


def build_camera(file: CameraFile) -> Camera:
    """The camera of a document, bit for bit."""
    size: dict[str, Any] = {"near": file.near, "far": file.far, "width": file.width, "height": file.height}
    if file.axis_angle is not None:
        fields = file.axis_angle.model_dump()
        return Camera.axis_angle(**fields, orthographic=file.projection == "orthographic", **size)
    return Camera(
        view_from_world=np.array(file.view_from_world),
        clip_from_view=np.array(file.clip_from_view),
        eye=np.array(file.eye),
        intrinsics=np.array(file.intrinsics),
        near=file.near,
        far=file.far,
        width=file.width,
        height=file.height,
    )


def contradiction(camera: Camera) -> tuple[str, Any, str] | None:
    """Which of near, far and eye is not what the matrices say: the field, what was found, what is allowed.

    near and far give the row of z of clip_from_view, within 1e-15 of its entries; the eye is where view_from_world has it,
    within 1e-12 of the numbers that it is made of.
    """
    clip, (c, d) = camera.clip_from_view, camera.clip_from_view[2, 2:].tolist()
    row = np.array([0.0, 0.0, *depth_row(camera.near, camera.far, camera.perspective)])
    if not (np.abs(clip[2] - row) <= _PLANES_ROUNDING * np.abs(row)).all():
        with np.errstate(all="ignore"):
            near, far = (np.float64(d) / c, np.float64(d) / (c + camera.perspective)) if d else (np.nan, np.nan)
            far = far if camera.perspective else near - np.float64(1.0) / c
        field, own, of_matrix = ("near", camera.near, near) if abs(camera.near - near) > 1e-9 * abs(near) else (
            "far", camera.far, far)  # fmt: skip
        return field, own, f"{of_matrix:.12g}, which clip_from_view[2] = {clip[2].tolist()} makes of it"
    inverse, back = camera.world_from_view, camera.view_from_world[:3, 3]
    if camera.perspective:
        eye, scale = inverse[:3, 3], np.abs(inverse[:3, :3]) @ np.abs(back)
    else:
        eye, scale = inverse[:3, 2] / np.sqrt((inverse[:3, 2] ** 2).sum()), np.ones(3)
    if not (np.abs(camera.eye[:3] - eye) <= _EYE_ROUNDING * scale).all():
        return "eye", camera.eye.tolist(), f"{[*eye.tolist(), camera.eye[3]]}, which view_from_world makes of it"
    return None


def gl_clip(clip: NDArray[np.float64]) -> NDArray[np.float64]:
    """(4, 4) the projection for z in [-1, 1]: z_gl = 2 z - w, so that (z_gl / w + 1) / 2 is the same depth."""
    result = clip.copy()
    result[2] = 2.0 * clip[2] - clip[3]
    return result


def product(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """(4, 4) a b, each entry summed from left to right: the same bits on every machine, unlike those of a BLAS."""
    return np.asarray(a[:, 0:1] * b[0] + a[:, 1:2] * b[1] + a[:, 2:3] * b[2] + a[:, 3:4] * b[3])
