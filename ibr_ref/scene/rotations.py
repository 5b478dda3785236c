"""Rotations: checked, made true where they were measured, and as quaternions."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.scene import checks
from ibr_ref.scene.vectors import cross, dot

Quaternion = tuple[float, float, float, float]
"""x, y, z, w: the scalar last."""

MOST_DEFECT = 1e-3
"""Of a measured rotation, the Frobenius norm of R^T R - I."""


def rotation_matrix(field: str, value: ArrayLike) -> Floats:
    """(3, 3), checked: a rotation to MOST_DEFECT, and no mirroring."""
    r = checks.matrix(field, value, 3, 3)
    defect = float(np.linalg.norm(r.T @ r - np.eye(3)))
    if defect > MOST_DEFECT or np.linalg.det(r) < 0.0:
        allowed = f"a rotation (|R^T R - I| = {defect:.3g} must be <= {MOST_DEFECT:g}, det > 0)"
        raise checks.reject(field, r.tolist(), allowed)
    return r


def cofactors(m: Floats) -> Floats:
    """(3, 3) of a (3, 3): the transposed adjugate."""
    return np.stack([cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])])


def nearest_rotation(r: Floats) -> Floats:
    """The true rotation Q nearest to a measured one (3, 3), in the Frobenius norm: R's polar factor.

    Newton's iteration R <- (R + R^-T)/2 (Higham 1986) takes a singular value 1 + e to about 1 + e^2/2, so that three
    steps bring the largest defect that is allowed below rounding. |R - Q| is at most |R^T R - I|/(1 + the smallest
    singular value): about half the defect.
    """
    for _ in range(3):
        inverse_transposed = cofactors(r)
        r = (r + inverse_transposed / dot(r[0], inverse_transposed[0])) / 2.0
    return r


def quaternion(r: Floats) -> Quaternion:
    """The quaternion of a rotation (3, 3), not normalized.

    Of the four ways to it the one that cancels nothing (Shepperd 1978).
    """
    (a, b, c), (d, e, f), (g, h, i) = r.tolist()
    return max(
        (h - f, c - g, d - b, 1.0 + a + e + i),
        (1.0 + a - e - i, d + b, c + g, h - f),
        (d + b, 1.0 - a + e - i, h + f, c - g),
        (c + g, h + f, 1.0 - a - e + i, d - b),
        key=lambda candidate: max(candidate),
    )


def normalized(q: Quaternion) -> Quaternion:
    """Of length 1."""
    x, y, z, w = q
    length = math.sqrt(x * x + y * y + z * z + w * w)
    return x / length, y / length, z / length, w / length


def rotation_of(q: Quaternion) -> Floats:
    """(3, 3) of a quaternion of length 1."""
    x, y, z, w = q
    return np.array(
        [
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)),
            (2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)),
            (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)),
        ]
    )
