"""A walking horse of 5,804 triangles, as many as the polygons of the cow in Kang & Ihm's tables."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.models.loft import capped, joined
from ibr_ref.models.sweep import ellipses, spline
from ibr_ref.scene import Mesh

Section = tuple[float, float, float, float, float]
"""A cut across a limb, an ellipse: x and z of the end of its axis that is on the left as the limb goes, as one sees it from
-y with +x to the right, then of the other end; and half its width."""

_COAT, _BLACK, _MUZZLE, _HOOF = (0.50, 0.24, 0.09), (0.09, 0.06, 0.05), (0.20, 0.12, 0.09), (0.16, 0.14, 0.12)

_BARREL = [
    (-0.875, 1.28, -0.875, 1.14, 0.060), (-0.83, 1.43, -0.82, 1.02, 0.170), (-0.68, 1.535, -0.68, 0.97, 0.240),
    (-0.45, 1.560, -0.45, 0.93, 0.265), (-0.18, 1.495, -0.18, 0.87, 0.275), (0.08, 1.475, 0.08, 0.83, 0.275),
    (0.30, 1.555, 0.30, 0.84, 0.240), (0.48, 1.540, 0.50, 0.90, 0.215), (0.62, 1.400, 0.63, 0.99, 0.165),
    (0.695, 1.285, 0.70, 1.10, 0.100), (0.715, 1.220, 0.715, 1.16, 0.030),
]  # fmt: skip
_NECK = [
    (0.12, 1.480, 0.55, 1.000, 0.150), (0.30, 1.640, 0.66, 1.180, 0.140), (0.45, 1.810, 0.735, 1.400, 0.110),
    (0.58, 1.960, 0.80, 1.590, 0.088), (0.70, 2.060, 0.87, 1.740, 0.078), (0.80, 2.100, 0.92, 1.840, 0.070),
]  # fmt: skip
_HEAD = [
    (0.80, 2.105, 0.755, 1.900, 0.060), (0.885, 2.075, 0.80, 1.790, 0.092), (0.975, 1.985, 0.87, 1.715, 0.098),
    (1.06, 1.880, 0.965, 1.680, 0.078), (1.145, 1.770, 1.06, 1.620, 0.060), (1.22, 1.670, 1.13, 1.540, 0.056),
    (1.27, 1.590, 1.18, 1.475, 0.060), (1.275, 1.540, 1.205, 1.455, 0.040),
]  # fmt: skip
_FORELEG = [
    (0.60, 1.300, 0.26, 1.300, 0.070), (0.575, 1.080, 0.315, 1.080, 0.085), (0.53, 0.880, 0.37, 0.880, 0.072),
    (0.505, 0.690, 0.395, 0.690, 0.052), (0.51, 0.560, 0.40, 0.560, 0.054), (0.49, 0.460, 0.41, 0.460, 0.040),
    (0.48, 0.260, 0.41, 0.260, 0.035), (0.49, 0.155, 0.405, 0.155, 0.043), (0.505, 0.090, 0.43, 0.090, 0.040),
    (0.53, 0.060, 0.42, 0.060, 0.056), (0.555, 0.000, 0.41, 0.000, 0.064),
]  # fmt: skip
_HIND_LEG = [
    (-0.48, 1.360, -0.76, 1.360, 0.040), (-0.385, 1.160, -0.860, 1.160, 0.120), (-0.42, 0.960, -0.80, 0.960, 0.098),
    (-0.53, 0.790, -0.785, 0.790, 0.066), (-0.645, 0.650, -0.815, 0.650, 0.050), (-0.69, 0.570, -0.845, 0.570, 0.052),
    (-0.72, 0.460, -0.82, 0.460, 0.043), (-0.71, 0.260, -0.79, 0.260, 0.036), (-0.69, 0.155, -0.785, 0.155, 0.044),
    (-0.67, 0.090, -0.755, 0.090, 0.040), (-0.64, 0.060, -0.76, 0.060, 0.056), (-0.615, 0.000, -0.77, 0.000, 0.064),
]  # fmt: skip
_TAIL = [
    (-0.84, 1.36, -0.80, 1.44, 0.035), (-0.90, 1.33, -0.93, 1.43, 0.045), (-0.92, 1.22, -1.02, 1.28, 0.060),
    (-0.93, 1.03, -1.07, 1.05, 0.070), (-0.94, 0.80, -1.08, 0.80, 0.060), (-0.97, 0.62, -1.05, 0.60, 0.030),
    (-1.01, 0.53, -1.03, 0.52, 0.008),
]  # fmt: skip
_MANE = [
    (0.16, 1.530, 0.24, 1.400, 0.020), (0.27, 1.680, 0.42, 1.520, 0.036), (0.42, 1.850, 0.55, 1.650, 0.036),
    (0.56, 2.005, 0.66, 1.800, 0.034), (0.70, 2.110, 0.77, 1.930, 0.032), (0.84, 2.150, 0.87, 1.980, 0.022),
]  # fmt: skip
_EAR = [(0.765, 2.060, 0.845, 2.050, 0.030), (0.765, 2.130, 0.855, 2.130, 0.032), (0.80, 2.235, 0.825, 2.240, 0.006)]


def horse() -> Mesh:
    """A bay horse that walks towards +x on the plane z = 0: 2.4 long, 0.55 wide, 2.2 high (1.56 at the withers).

    5,804 triangles in eleven closed parts, one inside the other where they meet.
    """
    parts = [
        _limb(_BARREL, 28, 28, _COAT),
        _limb(_NECK, 20, 24, _COAT),
        _limb(_HEAD, 24, 20, [*[_COAT] * 17, *[_MUZZLE] * 7]),
        _limb(_TAIL, 14, 10, _BLACK),
        _limb(_MANE, 11, 6, _BLACK),
        _limb(_EAR, 4, 7, _COAT, y=-0.055),
        _limb(_EAR, 4, 7, _COAT, y=0.055),
    ]
    for knots, y, stride in (
        (_FORELEG, -0.13, 0.26), (_FORELEG, 0.13, -0.14), (_HIND_LEG, -0.14, -0.16), (_HIND_LEG, 0.14, 0.22),
    ):  # fmt: skip
        parts.append(_leg(knots, y, stride))
    return joined(parts)


def _limb(knots: list[Section], count: int, sides: int, color: ArrayLike, y: float = 0.0) -> Mesh:
    """2 count sides triangles through the sections, in the plane y."""
    return _lofted(spline(knots, count), sides, color, y)


def _leg(knots: list[Section], y: float, stride: float) -> Mesh:
    """448 triangles; the hoof is `stride` before the place where it would stand."""
    sections = spline(knots, 16)
    sections[:, [0, 2]] += stride * (1.0 - sections[:, [1, 3]] / knots[0][1])
    stockings = [*[_COAT] * 7, *[_BLACK] * 7, _HOOF, _HOOF]
    return _lofted(sections, 14, stockings, y)


def _lofted(sections: Floats, sides: int, color: ArrayLike, y: float) -> Mesh:
    left_x, left_z, right_x, right_z, half_width = sections.T
    zero = np.zeros(len(sections))
    left = np.stack([left_x, y + zero, left_z], axis=1)
    right = np.stack([right_x, y + zero, right_z], axis=1)
    centers = (left + right) / 2.0
    rings = ellipses(centers, (left - right) / 2.0, np.stack([zero, -half_width, zero], axis=1), sides)
    return capped(rings, centers[0], centers[-1], color)
