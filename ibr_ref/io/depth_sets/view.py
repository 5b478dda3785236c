"""One picture of a depth set: what the set says of it, and the camera and the reference image that this makes."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.io.depth_sets.conventions import Conventions, Options
from ibr_ref.io.depth_sets.maps import read_depth_map
from ibr_ref.io.depth_sets.resample import colors_at
from ibr_ref.io.files import naming
from ibr_ref.io.textures import read_color
from ibr_ref.scene import Camera, DepthImage, checks
from ibr_ref.scene.rotations import cofactors, rotation_matrix
from ibr_ref.scene.vectors import dot

FARTHEST = 1e9
"""World units. A depth this far is a program's word for nothing (1e10, the largest float); a camera, a mistake."""
_MARGIN = 1.05
"""The clip planes lie this much outside the depths: a splat whose centre is just off the picture may reach in."""
_UNKNOWN = (0.1, 100.0)
"""Planes where nothing is valid: those of `Camera.look_at`."""


class View(NamedTuple):
    """What a set says of one picture, in its own conventions."""

    name: str
    where: str
    """The file, and the place in it, that intrinsics and pose are from."""
    color: Path
    depth: Path | None
    intrinsics: Floats
    """(3, 3) of the colour picture."""
    pose: Floats
    """(4, 4)."""
    size: tuple[int, int] | None = None
    """Width and height of the colour picture, if the set says so."""
    depth_intrinsics: Floats | None = None
    """(3, 3) of the depth map, if they are not the picture's."""
    disparity: tuple[float, float] | None = None
    """(b, d0): a stored d means the depth b/(d + d0)."""
    depth_scale: float | None = None
    """Of whole numbers, if the set says so."""
    scales_floats: bool = False
    """Whether it is of floats too."""
    unit: float = 1.0
    """World units of one unit of the scaled depths."""
    planes: tuple[float, float] | None = None
    """near and far, if the set has them."""


def view_camera(view: View, conventions: Conventions, near: float, far: float) -> Camera:
    """The camera of a view for its depth map or, if it has none, its picture."""
    color = read_color(view.color, exif=False)
    shape = color.shape if view.depth is None else read_depth_map(view.depth)[0].shape
    with naming(view.where):
        _, k = _both_intrinsics(view, conventions, color, (shape[1], shape[0]))
        return _camera(k, view, conventions, (shape[1], shape[0]), near, far)


def depth_image(view: View, conventions: Conventions, options: Options) -> tuple[DepthImage, str]:
    """The reference image of a view, and in words what its depth map has stored.

    It has the size of the depth map: colours of another size are looked up at the centres of its pixels.
    """
    if view.depth is None:
        raise FileNotFoundError(f"{checks.named(view.where)}: found no depth map, allowed: a picture that has one")
    color = read_color(view.color, exif=False)
    stored, whole = read_depth_map(view.depth)
    with naming(view.depth):
        depth = _scaled(stored, whole, view, conventions, options)
    size = depth.shape[1], depth.shape[0]
    with naming(view.where):
        k_color, k = _both_intrinsics(view, conventions, color, size)
        depth, valid = _along_the_axis(depth, k, conventions)
        if color.shape[:2] != depth.shape or not np.array_equal(k_color, k):
            color, known = colors_at(color, k_color, k, *size)
            valid &= known
        camera = _camera(k, view, conventions, size, *(view.planes or _planes(depth, valid)))
        return DepthImage(color=color, depth=depth, camera=camera, mask=valid), _words(stored)


def _camera(k: Floats, view: View, conventions: Conventions, size: tuple[int, int], near: float, far: float) -> Camera:
    rotation, translation = _view_from_world(view.pose, conventions)
    return Camera.calibrated(
        intrinsics=k, rotation=rotation, translation=translation, near=near, far=far, width=size[0], height=size[1]
    )


def _both_intrinsics(
    view: View, conventions: Conventions, color: Floats, depth_size: tuple[int, int]
) -> tuple[Floats, Floats]:
    """Those of the picture, and those of the depth map: its own, or the picture's in the map's pixels."""
    height, width = color.shape[:2]
    if view.size is not None and view.size != (width, height):
        found = f"{view.size[0]} x {view.size[1]} pixels"
        raise ValueError(f"found {found}, allowed: {width} x {height}, the size of {view.color.name}")
    k = _centered(view.intrinsics, conventions)
    if view.depth_intrinsics is not None:
        return k, _centered(view.depth_intrinsics, conventions)
    columns, rows = depth_size
    if abs(width * rows - height * columns) > max(width, height):  # the shapes differ by more than a pixel of the map
        found = f"{width} x {height} pixels of colour and {columns} x {rows} of depth"
        raise ValueError(f"found {found}, allowed: both of one size, or of one shape")
    return k, np.array([[columns / width], [rows / height], [1.0]]) * k


def _centered(intrinsics: Floats, conventions: Conventions) -> Floats:
    """Intrinsics with the pixels' centres at half-integers."""
    k = np.array(checks.matrix("intrinsics", intrinsics, 3, 3))
    if not (np.abs(k).max() <= FARTHEST and min(abs(k[0, 0]), abs(k[1, 1])) >= 1.0 / FARTHEST):
        allowed = f"focal lengths other than 0, numbers up to {FARTHEST:g}"
        raise checks.reject("intrinsics", k.tolist(), allowed)
    if conventions.pixel_centers == "integer":
        k[:2, 2] += 0.5
    return k


def _scaled(stored: Floats, whole: bool, view: View, conventions: Conventions, options: Options) -> Floats:
    """Depths in world units, or what else is stored there."""
    if view.disparity is not None:
        baseline, offset = view.disparity
        shifted = stored + offset
        return np.divide(baseline, shifted, out=np.zeros_like(shifted), where=np.isfinite(shifted) & (shifted > 0.0))
    scale = options.depth_scale
    if scale is None and (whole or view.scales_floats):
        scale = conventions.depth_scale if view.depth_scale is None else view.depth_scale
        if scale is None:
            allowed = "a number > 0, the world units of one stored unit (0.001: millimetres in a world of metres)"
            raise ValueError(f"depth_scale: found None with depths in whole numbers, allowed: {allowed}")
    return stored * ((1.0 if scale is None else scale) * view.unit)


def _along_the_axis(depth: Floats, k: Floats, conventions: Conventions) -> tuple[Floats, NDArray[np.bool_]]:
    """Depths along the view axis, and where they are some: > 0, finite and below FARTHEST."""
    valid = (depth > 0.0) & (depth < FARTHEST)
    if conventions.along == "ray":
        rows, columns = depth.shape
        y = (np.arange(rows) + 0.5 - k[1, 2]) / k[1, 1]
        x = (np.arange(columns)[None, :] + 0.5 - k[0, 2] - k[0, 1] * y[:, None]) / k[0, 0]
        depth = depth / np.sqrt(x * x + (y * y)[:, None] + 1.0)
    return np.where(valid, depth, 0.0), valid


def _planes(depth: Floats, valid: NDArray[np.bool_]) -> tuple[float, float]:
    if not valid.any():
        return _UNKNOWN
    return float(depth[valid].min()) / _MARGIN, float(depth[valid].max()) * _MARGIN


def _view_from_world(pose: Floats, conventions: Conventions) -> tuple[Floats, Floats]:
    """Rotation and translation into a space that looks down -z, +y up."""
    pose = checks.matrix("pose", pose, 4, 4)
    if not np.abs(pose[3] - (0.0, 0.0, 0.0, 1.0)).max() <= 1e-6:
        raise checks.reject("pose[3]", pose[3].tolist(), "[0, 0, 0, 1]")
    if not np.abs(pose[:3, 3]).max() <= FARTHEST:
        raise checks.reject("pose[:3, 3]", pose[:3, 3].tolist(), f"numbers from {-FARTHEST:g} to {FARTHEST:g}")
    rotation, translation = rotation_matrix("pose[:3, :3]", pose[:3, :3]), pose[:3, 3]
    if conventions.poses == "camera_to_world":  # the inverse: a measured rotation's transpose is not it
        transposed = cofactors(rotation)
        rotation = transposed.T / dot(rotation[0], transposed[0])
        translation = np.array([-dot(row, translation) for row in rotation])
    if conventions.convention == "opencv":  # +y down, looking down +z
        turned = np.array([1.0, -1.0, -1.0])
        return rotation * turned[:, None], translation * turned
    return rotation, translation


def _words(stored: Floats) -> str:
    finite = stored[np.isfinite(stored)]
    return f"{finite.min():g} to {finite.max():g}" if finite.size else "NaN and infinities"
