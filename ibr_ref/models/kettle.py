"""A kettle of 1,152 triangles, as many as the polygons of the teapot in Kang & Ihm's tables."""

from __future__ import annotations

import numpy as np

from ibr_ref.models.loft import capped, joined, turn
from ibr_ref.models.sweep import spline, tube
from ibr_ref.scene import Mesh

_PROFILE = np.array(
    [
        (0.480, 0.000), (0.545, 0.015), (0.575, 0.080), (0.565, 0.185), (0.525, 0.300), (0.445, 0.405), (0.340, 0.475),
        (0.268, 0.500), (0.268, 0.525), (0.200, 0.560), (0.060, 0.585), (0.034, 0.625), (0.080, 0.665), (0.062, 0.712),
    ]
)  # fmt: skip
"""Radius and height: bottom, belly, shoulder; the lid from the ninth on, its knob from the eleventh."""
_TOP = 0.73

_ENAMEL, _RIM, _LID, _KNOB = (0.10, 0.42, 0.50), (0.90, 0.88, 0.80), (0.13, 0.48, 0.56), (0.16, 0.11, 0.09)
_STEEL, _WOOD, _DARK = (0.62, 0.63, 0.66), (0.42, 0.24, 0.12), (0.03, 0.05, 0.06)
_BODY_COLORS = [_RIM, *[_ENAMEL] * 6, _RIM, _RIM, _LID, _LID, _KNOB, _KNOB, _KNOB]

_SPOUT = [(0.40, 0.20, 0.150), (0.58, 0.24, 0.115), (0.70, 0.34, 0.080), (0.78, 0.47, 0.060), (0.87, 0.55, 0.058)]
"""x, z and radius."""
_BAIL = [(0.41, 0.42), (0.47, 0.62), (0.37, 0.88), (0.0, 1.0), (-0.37, 0.88), (-0.47, 0.62), (-0.41, 0.42)]
"""x and z of the handle, from front to back over the lid."""


def kettle() -> Mesh:
    """A kettle on the plane z = 0, its spout towards +x: 1.2 wide in the body, 1.5 long, 1.0 high; 1,152 triangles."""
    return joined([_body(), _spout(), _bail()])


def _body() -> Mesh:
    """With the lid: 672 triangles."""
    radius, height = _PROFILE.T
    x, y = turn(24).T
    rings = np.stack([radius[:, None] * x, radius[:, None] * y, height[:, None] + 0.0 * x], axis=2)
    return capped(rings, (0.0, 0.0, 0.0), (0.0, 0.0, _TOP), _BODY_COLORS)


def _spout() -> Mesh:
    """240 triangles; the last ring is the inner edge of the mouth, and the pole lies deep in it."""
    x, z, radii = spline(_SPOUT, 11).T
    path = np.stack([x, 0.0 * x, z], axis=1)
    rings = tube(path, radii, (0.0, 1.0, 0.0), 10)
    inner = path[-1] + 0.75 * (rings[-1:] - path[-1])
    rings = np.concatenate([rings, inner])
    return capped(rings, path[0], path[-3], [*[_ENAMEL] * 9, _RIM, _RIM, _DARK])


def _bail() -> Mesh:
    """240 triangles: steel, and a thicker grip of wood."""
    x, z = spline(_BAIL, 15).T
    path = np.stack([x, 0.0 * x, z], axis=1)
    radii = [0.026] * 4 + [0.030, 0.048, 0.052, 0.052, 0.052, 0.048, 0.030] + [0.026] * 4
    rings = tube(path, radii, (0.0, 1.0, 0.0), 8)
    return capped(rings, path[0], path[-1], [*[_STEEL] * 5, *[_WOOD] * 5, *[_STEEL] * 5])
