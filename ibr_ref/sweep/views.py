"""Views of a scene: its camera on the way around."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.scene import Camera, checks
from ibr_ref.scene.roberts import R2
from ibr_ref.scene.trigonometry import sine_cosine
from ibr_ref.scene.vectors import dot

MOST_VIEWS = 4096


def count_of(value: object) -> int:
    """A number of views. Raises ValueError for another."""
    return checks.whole("views", value, low=1, high=MOST_VIEWS)


def around(camera: Camera, points: ArrayLike, count: int) -> list[Camera]:
    """`count` cameras on a circle about the axis z through the middle of points (N, 3): the first is the one given.

    Each has planes that hold the points, as the first one has its own.
    """
    corners = np.asarray(points, np.float64)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
    return [camera, *(_turned(camera, middle, i / count).fitted(corners) for i in range(1, count))]


def _turned(camera: Camera, middle: Floats, share: float) -> Camera:
    """The camera, turned to the left about the middle by a share of the full circle."""
    sine, cosine = sine_cosine(2.0 * math.pi * share)
    back = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])  # from turned to unturned places
    view = np.eye(4)
    for i, row in enumerate(camera.view_from_world[:3]):
        view[i, :3] = [dot(row[:3], column) for column in back.T]
        view[i, 3] = row[3] + dot(row[:3], middle) - dot(view[i, :3], middle)
    return replace(camera, view_from_world=view, eye=None)  # type: ignore[arg-type]


def places(low: Floats, high: Floats, count: int) -> list[Floats]:
    """`count` points (2,) that fill a rectangle evenly, however many there are: Roberts' sequence R2, from the middle on."""
    steps = np.array(R2)
    return [low + (high - low) * ((0.5 + i * steps) % 1.0) for i in range(count)]
