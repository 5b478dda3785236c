"""Stage "normals" of splatting in NumPy, from the specification: what a port is handed where no codes are given."""

from __future__ import annotations

from typing import Any

import numpy as np

JUMP = 0.05
"""A neighbour whose depth differs by more than this part of the pixel's own lies on another surface."""


def normal_codes(image: Any) -> np.ndarray:
    """(H, W, 3) uint8 normals in world space of a depth image, floor(127 n + 128.5); (0, 0, 0) off the mask."""
    mask = np.asarray(image.mask, bool)
    points = world_points(image)
    along_row = _difference(points, image, axis=1)
    along_column = _difference(points, image, axis=0)
    normal = np.cross(along_row, along_column)
    eye = np.asarray(image.camera.eye, float)
    towards = eye[:3] - eye[3] * points
    normal = np.where((normal == 0.0).all(axis=2, keepdims=True), towards, normal)
    normal /= _length(normal)
    normal = np.where((_dot(normal, towards) < 0.0)[..., None], -normal, normal)
    codes = np.floor(127.0 * normal + 128.5)
    return np.where(mask[..., None], codes, 0.0).astype(np.uint8)


def world_points(image: Any) -> np.ndarray:
    """(H, W, 3) world positions of the pixels' centres; off the mask those of depth 1, so that nothing divides by 0."""
    camera, mask = image.camera, np.asarray(image.mask, bool)
    depth = np.where(mask, image.depth, 1.0)
    (f_x, skew, c_x), (_, f_y, c_y), _ = np.asarray(camera.intrinsics, float).tolist()
    rows, columns = np.indices(depth.shape)
    y = (rows + 0.5 - c_y) / f_y
    x = (columns + 0.5 - c_x - skew * y) / f_x
    stretch = depth if camera.perspective else np.ones_like(depth)
    view = (x * stretch, -y * stretch, -depth)
    return np.stack([r[0] * view[0] + r[1] * view[1] + r[2] * view[2] + r[3] for r in camera.world_from_view[:3]], 2)


def _difference(points: np.ndarray, image: Any, axis: int) -> np.ndarray:
    """(H, W, 3): the step to the neighbour along an axis that is nearer in depth (a tie: the next); 0 without one."""
    mask = np.asarray(image.mask, bool)
    after, step_after = _neighbour(points, image, axis, 1)
    before, step_before = _neighbour(points, image, axis, -1)
    step_after = np.where(mask, step_after, np.inf)
    step_before = np.where(mask, step_before, np.inf)
    chosen = np.where((step_after <= step_before)[..., None], after, before)
    usable = np.minimum(step_after, step_before) < np.inf
    return np.where(usable[..., None], chosen - points, 0.0)


def _neighbour(points: np.ndarray, image: Any, axis: int, side: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions (H, W, 3) of the neighbours on one side, and by how much their depths differ (inf: not to be used)."""
    mask, depth = np.asarray(image.mask, bool), np.asarray(image.depth, float)
    there = np.roll(mask, -side, axis)
    edge = [slice(None), slice(None)]
    edge[axis] = -1 if side > 0 else 0  # type: ignore[call-overload]
    there[tuple(edge)] = False
    step = np.abs(np.roll(depth, -side, axis) - depth)
    return np.roll(points, -side, axis), np.where(there & (step <= JUMP * depth), step, np.inf)


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(H, W), summed from left to right."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def _length(a: np.ndarray) -> np.ndarray:
    """(H, W, 1); 1 for a zero vector."""
    length = np.sqrt(_dot(a, a))
    return np.where(length == 0.0, 1.0, length)[..., None]
