"""A sphere: the closed form among the meshes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ibr_ref.models.loft import capped, turn
from ibr_ref.scene import Mesh, checks
from ibr_ref.scene.trigonometry import sine_cosine

_MOST = 4096
_SOUTH, _EQUATOR, _NORTH = (0.12, 0.22, 0.62), (0.92, 0.86, 0.7), (0.86, 0.3, 0.12)


def sphere(radius: float = 1.0, segments: int = 64) -> Mesh:
    """A globe around the origin, z up: segments x (segments/2 - 1) vertices on circles of latitude, and two poles.

    The vertices lie on the sphere to rounding, and no point nearer to the centre than radius sqrt(cos(2 pi/segments)).
    segments: even, 4 to 4096; 2 segments (segments/2 - 1) triangles. ValueError for others, or a radius not > 0.
    """
    radius = checks.number("radius", radius, above=0.0)
    segments = checks.whole("segments", segments, low=4, high=_MOST)
    if segments % 2:
        raise checks.reject("segments", segments, "an even number")
    south_to_north = [sine_cosine(2.0 * math.pi * k / segments) for k in range(1, segments // 2)]
    rings = [
        [(radius * sine * x, radius * sine * y, -radius * cosine) for x, y in turn(segments).tolist()]
        for sine, cosine in south_to_north
    ]
    pole = (0.0, 0.0, radius)
    return capped(np.array(rings), (0.0, 0.0, -radius), pole, _bands(np.array(south_to_north)[:, 1]))


def _bands(cosines: NDArray[np.float64]) -> NDArray[np.float64]:
    """(rings, 3) colours from the south pole (cosine 1) over the equator to the north pole."""
    share = cosines[:, None]
    return np.where(
        share > 0.0,
        np.array(_EQUATOR) * (1.0 - share) + np.array(_SOUTH) * share,
        np.array(_EQUATOR) * (1.0 + share) - np.array(_NORTH) * share,
    )
