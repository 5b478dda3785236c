"""The light of the stage for shadows: the stage's own, or one at any place, whose maps are made to hold the caster."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.scene import AreaLight, Camera, checks
from ibr_ref.scene.boxes import box_corners

POSITION, TARGET = (-1.0, -1.2, 5.0), (0.0, 0.0, 0.0)

_FIELD_OF_VIEW = 27.0
"""Degrees: the caster's shadow stays within the map wherever it is, and for every sample of the light."""
_NEAR, _FAR = 0.5, 12.0
_ROOM = 1.05
"""Beside the caster in the maps of a light that was placed, and between all there is and its planes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StageLight:
    """A light of `shadow_ensemble`. Raises ValueError where it is put on the stage."""

    position: ArrayLike | None = None
    """(3,) where it is; None: (-1, -1.2, 5)."""
    target: ArrayLike | None = None
    """(3,) what is in the middle of its maps; None: the origin. With neither it is the stage's own light."""
    size: ArrayLike = 0.12
    """Half the side of the square light, or of both sides (a, b) along x and y, world units, >= 0."""
    power: float = 1.0
    """Factor of its light, >= 0."""

    def over(self, casters: Floats, reach: float, everything: Floats) -> AreaLight:
        """The light that shows all that may cast a shadow.

        casters: (8, 3), corners of all casters at the origin; reach: how far they move along x and y. everything: (N, 3),
        corners of all that is there. Raises ValueError for a light that has not all casters before it, wherever they stand.
        """
        edges = half_edges(self.size)
        if self.position is None and self.target is None:
            return AreaLight(
                position=POSITION, target=TARGET, vertical_fov=_FIELD_OF_VIEW, near=_NEAR, far=_FAR, half_edges=edges
            )
        place = checks.vector("light_position", POSITION if self.position is None else self.position)
        middle = checks.vector("light_target", TARGET if self.target is None else self.target)
        if np.array_equal(place, middle):
            raise checks.reject("light_target", middle.tolist(), "a point other than the light's position")
        moved = np.append(reach + edges.diagonal(), 0.0)  # as any sample of the light sees them
        return _placed(
            place, middle, edges, box_corners(np.concatenate([casters - moved, casters + moved])), everything
        )


def _placed(place: Floats, middle: Floats, edges: Floats, casters: Floats, everything: Floats) -> AreaLight:
    """The light at a place, in the direction of a middle, whose maps show the casters (8, 3)."""
    along_y = place[0] == middle[0] and place[2] == middle[2]
    up = (0.0, 0.0, 1.0) if along_y else (0.0, 1.0, 0.0)
    world = Camera.look_at(eye=place, target=middle, up=up, width=1, height=1).view_from_world
    across, depths = _seen(world, casters)
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


def half_edges(size: ArrayLike) -> Floats:
    """(2, 3) a and b, along the world's x and y, of half a side, or of half of both."""
    if np.ndim(size) == 0:
        a = b = checks.number("light_size", size, low=0.0)
    else:
        a, b = checks.vector("light_size", size, 2).tolist()
        if min(a, b) < 0.0:
            raise checks.reject("light_size", [a, b], "numbers >= 0")
    return np.array([[a, 0.0, 0.0], [0.0, b, 0.0]])


def _seen(view_from_world: Floats, points: Floats) -> tuple[Floats, Floats]:
    """The larger of the distances across the line of sight, and the depth, of points (N, 3)."""
    local = points @ view_from_world[:3, :3].T + view_from_world[:3, 3]
    return np.abs(local[:, :2]).max(axis=1), -local[:, 2]
