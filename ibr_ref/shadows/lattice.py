"""Points spread evenly over a parallelogram: what rays are cast to, and where maps are asked."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats

_GOLDEN = 0.6180339887498949
"""(sqrt 5 - 1)/2: its multiples leave the smallest gaps modulo 1."""


def lattice(count: int) -> Floats:
    """(N, 2) points in [-1, 1]^2, shares of two half-edges.

    The golden-ratio lattice: point i at ((i + 1/2)/N, (i + 1/2) golden modulo 1), so that any half-plane's share of the
    points is its share of the area to about log N/N (a regular grid: to 1/sqrt N, where an edge runs along its rows).
    """
    i = np.arange(count) + 0.5
    v = i * _GOLDEN
    return np.stack([2.0 * i / count - 1.0, 2.0 * (v - np.floor(v)) - 1.0], axis=1)


def on_parallelogram(centre: Floats, half_edges: Floats, count: int) -> Floats:
    """(N, K) points centre + g_i a + g_j b, for a centre (K,) and the half-edges a and b (2, K)."""
    g = lattice(count)
    points: Floats = centre + (g[:, :1] * half_edges[0] + g[:, 1:] * half_edges[1])
    return points
