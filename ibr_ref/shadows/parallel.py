"""A map of the caster that lies parallel to the light: what a single map must be like to be softened by the light's size.

Distances h are from the light's plane, towards the caster; a place is (x, y) = what stands there, seen from the light's
centre, divided by h. From the point l of the light the way to a receiver's point at place x and distance r crosses the
distance h at place x + l (1/h - 1/r), which both the convolution and the percentage-closer filter rest on.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.transform import transformed
from ibr_ref.shadows.maps import View

_ROOM = 1e-3
"""Between caster and clipping planes, as a share of the distance."""

_BORDER = 0.01
"""Of the map beside all that may be dark, as a share of its side."""


class Frame(NamedTuple):
    """The light's plane and its centre."""

    view_from_world: Floats
    """(4, 4) the third row is -h."""
    half_edges: Floats
    """(2, 2) a and b in the plane."""


class Window(NamedTuple):
    """The map's frustum, from the light's centre."""

    low: Floats
    high: Floats
    """(2,) places of its border."""
    near: float
    far: float
    """The caster's nearest and farthest distance."""


def distances(frame: Frame, points: Floats) -> Floats:
    """(N,) h of world points (N, 3)."""
    return -transformed(frame.view_from_world, points)[:, 2]


def window_around(frame: Frame, vertices: Floats, farthest: float) -> Window:
    """The window around a caster's corners (U, 3) in front of the light, and around its penumbra as far as `farthest`."""
    seen = transformed(frame.view_from_world, vertices)
    h = -seen[:, 2]
    places = seen[:, :2] / h[:, None]
    near, far = float(h.min()), float(h.max())
    penumbra = np.abs(frame.half_edges).sum(axis=0) * max(0.0, 1.0 / near - 1.0 / farthest)
    low, high = places.min(axis=0) - penumbra, places.max(axis=0) + penumbra
    border = _BORDER * (high - low).max()
    return Window(low - border, high + border, near, far)


def planes(window: Window) -> tuple[float, float]:
    """Distances of the map's near and far plane."""
    return window.near * (1.0 - _ROOM), window.far * (1.0 + _ROOM)


def clip_from_view(window: Window) -> Floats:
    """(4, 4) the projection onto the window, off the axis."""
    (x0, y0), (x1, y1) = window.low, window.high
    n, f = planes(window)
    return np.array(
        [
            [2.0 / (x1 - x0), 0.0, (x1 + x0) / (x1 - x0), 0.0],
            [0.0, 2.0 / (y1 - y0), (y1 + y0) / (y1 - y0), 0.0],
            [0.0, 0.0, -f / (f - n), -f * n / (f - n)],
            [0.0, 0.0, -1.0, 0.0],
        ]
    )


def view_of_caster(frame: Frame, window: Window, vertices: Floats, triangles: NDArray[np.int32]) -> View:
    """What the map is rendered of: vertices (V, 3) in world space."""
    return View(vertices, triangles, np.zeros((2, 3)), frame.view_from_world, clip_from_view(window))


def to_distance(depth: Floats, window: Window) -> Floats:
    """(S, S) distances h from window depths; infinite where nothing is."""
    n, f = planes(window)
    h: Floats = n * f / (f - depth * (f - n))
    return np.where(depth < 1.0, h, np.inf)
