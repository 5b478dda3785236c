"""The light of the stage for shadows: the stage's own, or one at any place, whose maps are made to hold the caster."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import AreaLight, Camera, checks

POSITION, TARGET = (-1.0, -1.2, 5.0), (0.0, 0.0, 0.0)

_FIELD_OF_VIEW = 27.0
"""Degrees: the caster's shadow stays within the map wherever it is, and for every sample of the light."""
_NEAR, _FAR = 0.5, 12.0
_ROOM = 1.05
"""Beside the caster in the maps of a light that was placed, and between all there is and its planes."""


def half_edges(size: ArrayLike) -> NDArray[np.float64]:
    """(2, 3) a and b, along the world's x and y, of half a side, or of half of both."""
    if np.ndim(size) == 0:
        a = b = checks.number("light_size", size, low=0.0)
    else:
        a, b = checks.vector("light_size", size, 2).tolist()
        if min(a, b) < 0.0:
            raise checks.reject("light_size", [a, b], "numbers >= 0")
    return np.array([[a, 0.0, 0.0], [0.0, b, 0.0]])


def stage_light(
    position: ArrayLike | None,
    target: ArrayLike | None,
    edges: NDArray[np.float64],
    caster: NDArray[np.float64],
    everything: NDArray[np.float64],
) -> AreaLight:
    """The light at a position, in the direction of a target; None: the stage's own.

    edges: (2, 3), its half-edges. caster: (8, 3), corners of all that the caster may fill, as any sample of the light sees
    it: maps of a light that was placed show that. everything: (N, 3), corners of all that is there. Raises ValueError for a
    light that has not the whole caster before it.
    """
    if position is None and target is None:
        return AreaLight(
            position=POSITION, target=TARGET, vertical_fov=_FIELD_OF_VIEW, near=_NEAR, far=_FAR, half_edges=edges
        )
    place = checks.vector("light_position", POSITION if position is None else position)
    middle = checks.vector("light_target", TARGET if target is None else target)
    if np.array_equal(place, middle):
        raise checks.reject("light_target", middle.tolist(), "a point other than the light's position")
    along_y = place[0] == middle[0] and place[2] == middle[2]
    up = (0.0, 0.0, 1.0) if along_y else (0.0, 1.0, 0.0)
    world = Camera.look_at(eye=place, target=middle, up=up, width=1, height=1).view_from_world
    across, depths = _seen(world, caster)
    if not depths.min() > 0.0:
        raise checks.reject(
            "light_position",
            place.tolist(),
            "a place that has the caster before it, towards light_target, wherever it stands",
        )
    behind = _seen(world, everything)[1].max()
    return AreaLight(
        position=place,
        target=middle,
        up=up,
        vertical_fov=math.degrees(2.0 * math.atan(_ROOM * float((across / depths).max()))),
        near=float(depths.min()) / _ROOM,
        far=float(max(depths.max(), behind)) * _ROOM,
        half_edges=edges,
    )


def _seen(
    view_from_world: NDArray[np.float64], points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The larger of the distances across the line of sight, and the depth, of points (N, 3)."""
    local = points @ view_from_world[:3, :3].T + view_from_world[:3, 3]
    return np.abs(local[:, :2]).max(axis=1), -local[:, 2]
