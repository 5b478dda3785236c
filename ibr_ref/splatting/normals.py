"""Stage normals: a normal for every valid reference pixel, in world space, from its neighbours' positions (section 3.2).

Along each axis of the image the neighbour that is nearer in depth counts (a tie: right, down); one off the image, off
the mask or across a jump, abs(dz) > 0.05 z, does not. The normal is the cross product of the two differences, turned to
face the reference camera; without a usable pair, or where the product is zero, it points to the camera. Stored as
floor(127 n + 128.5) in 8 bits, (0, 0, 0) off the mask.

What kernels take: depth and valid (P,), points and codes (P, 3), eye (4,), and of one pixel its point p (3,).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Bytes, Floats, Vector3
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.lighting import unit
from ibr_ref.splatting.buffers import Reference
from ibr_ref.splatting.unproject import world_points

JUMP = 0.05
"""Neighbours farther apart than this share of the depth lie on different surfaces."""


@device
def step_to(depth: Floats, valid: Bools, pixel: int, other: int, inside: bool) -> float:
    """Distance in depth to a neighbouring pixel; infinite if it is no neighbour on the same surface."""
    if not inside or not valid[other]:
        return np.inf
    step = abs(depth[other] - depth[pixel])
    return step if step <= JUMP * depth[pixel] else np.inf


@device
def _nearer(after: float, before: float) -> int:
    """+1 for the neighbour right or below, -1 for the one left or above, 0 for neither."""
    if after == np.inf and before == np.inf:
        return 0
    return 1 if after <= before else -1


@device
def _surface_normal(
    depth: Floats, valid: Bools, points: Floats, rows: int, columns: int, row: int, column: int
) -> Vector3:
    """The cross product of the two differences; zero without a usable pair."""
    pixel = row * columns + column
    right = step_to(depth, valid, pixel, pixel + 1, column + 1 < columns)
    left = step_to(depth, valid, pixel, pixel - 1, column > 0)
    down = step_to(depth, valid, pixel, pixel + columns, row + 1 < rows)
    up = step_to(depth, valid, pixel, pixel - columns, row > 0)
    across, along = _nearer(right, left), _nearer(down, up)
    if across == 0 or along == 0:
        return 0.0, 0.0, 0.0
    p, q, r = points[pixel], points[pixel + across], points[pixel + along * columns]
    ax, ay, az = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    bx, by, bz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@device
def _facing(eye: Floats, p: Floats, x: float, y: float, z: float) -> Vector3:
    """The unit normal that faces the camera; (x, y, z) = 0: towards the camera."""
    ex, ey, ez = eye[0] - eye[3] * p[0], eye[1] - eye[3] * p[1], eye[2] - eye[3] * p[2]
    if x == 0.0 and y == 0.0 and z == 0.0:
        x, y, z = ex, ey, ez
    x, y, z = unit(x, y, z)
    if x * ex + y * ey + z * ez < 0.0:
        return -x, -y, -z
    return x, y, z


@device
def _code(n: float) -> np.uint8:
    return np.uint8(np.floor(127.0 * n + 128.5))


@device
def _row_normals(
    depth: Floats, valid: Bools, points: Floats, eye: Floats, rows: int, columns: int, row: int, codes: Bytes
) -> None:
    for column in range(columns):
        pixel = row * columns + column
        if valid[pixel]:
            x, y, z = _surface_normal(depth, valid, points, rows, columns, row, column)
            x, y, z = _facing(eye, points[pixel], x, y, z)
            codes[pixel, 0], codes[pixel, 1], codes[pixel, 2] = _code(x), _code(y), _code(z)


@kernel
def _normals(depth: Floats, valid: Bools, points: Floats, eye: Floats, rows: int, columns: int, codes: Bytes) -> None:
    for row in prange(rows):
        _row_normals(depth, valid, points, eye, rows, columns, row, codes)


@device
def decoded(x: float, y: float, z: float) -> Vector3:
    """The unit normal that a pixel's code stands for: (k - 128)/127, normalized."""
    return unit(
        (np.float64(x) - 128.0) / 127.0,
        (np.float64(y) - 128.0) / 127.0,
        (np.float64(z) - 128.0) / 127.0,
    )


def valid_mask(reference: Reference) -> NDArray[np.bool_]:
    """(P,) whether a pixel is a point."""
    valid = np.zeros(len(reference.depth), np.bool_)
    valid[reference.pixels] = True
    return valid


def normals(reference: Reference) -> NDArray[np.uint8]:
    """(P, 3) 8-bit normals of a reference image."""
    codes = np.zeros((len(reference.depth), 3), np.uint8)
    rows = len(reference.row_starts) - 1
    valid = valid_mask(reference)
    _normals(reference.depth, valid, world_points(reference), reference.eye, rows, reference.columns, codes)
    return codes
