"""A stage for shadows: a caster that moves over a floor with two steps, under a light from above and aside."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.models.stage_light import StageLight
from ibr_ref.scene import Camera, Mesh, checks
from ibr_ref.scene.boxes import box_corners
from ibr_ref.shadows import Caster, Ensemble, Scene

REACH = 0.6
"""The caster's offset on either axis, in units of its largest extent, which is 1 on the stage."""

EYE, TARGET, FIELD_OF_VIEW = (1.4, -3.0, 2.1), (0.15, 0.35, -0.1), 40.0
"""Of the camera."""

_FLOOR = -0.5
_FOOT = _FLOOR + 1.0 / 128.0

_FLOOR_COLOR, _STEP_COLORS = (0.78, 0.74, 0.66), ((0.55, 0.62, 0.72), (0.72, 0.55, 0.5))


def shadow_stage(
    caster: Mesh,
    *,
    offset: ArrayLike = (0.0, 0.0),
    light_size: ArrayLike = 0.12,
    light_position: ArrayLike | None = None,
    light_target: ArrayLike | None = None,
    eye: ArrayLike = EYE,
    target: ArrayLike = TARGET,
    width: int = 640,
    height: int = 480,
    near: float | None = None,
    far: float | None = None,
) -> Scene:
    """A scene for `ibr_ref.shadows`: the caster, z up, scaled to a largest extent of 1, over a floor with two steps.

    Vertices of no triangle are left out.
    offset: (x, y), each from -0.6 to 0.6: the object moves along the world's x and y. light_size: half the side of the
    square light, or of both sides (a, b) along x and y, world units, >= 0. light_position, light_target: where it is, and
    what is in the middle of its maps; None: (-1, -1.2, 5), and the origin. Placed otherwise, its maps are made to show the
    caster wherever it stands. eye, target: the camera's, world space; width, height: its picture, pixels. near, far:
    of its planes; None: around all that is there.
    Raises ValueError for a mesh that is none or has no extent, a light that has not the whole caster before it, and what
    makes no scene.
    """
    return shadow_ensemble(
        [caster],
        offsets=[offset],
        lights=[StageLight(position=light_position, target=light_target, size=light_size)],
        eye=eye,
        target=target,
        width=width,
        height=height,
        near=near,
        far=far,
    ).scene(0, 0)


def shadow_ensemble(
    casters: Sequence[Mesh],
    *,
    offsets: Sequence[ArrayLike],
    lights: Sequence[StageLight] = (StageLight(),),
    eye: ArrayLike = EYE,
    target: ArrayLike = TARGET,
    width: int = 640,
    height: int = 480,
    near: float | None = None,
    far: float | None = None,
) -> Ensemble:
    """The same stage for several casters and lights.

    casters: each as `shadow_stage` takes it, of an extent of 1. offsets: one (x, y) for each. lights: those that are placed
    have maps that show every caster wherever it stands; the others are the stage's own. eye to far: as there.
    Raises ValueError where that does, and for another number of offsets than of casters.
    """
    meshes = [_scaled(_mesh(name, mesh).compact()) for name, mesh in _numbered("caster", casters)]
    places = [checks.vector(name, offset, 2) for name, offset in _numbered("offset", offsets)]
    if len(places) != len(meshes):
        raise checks.reject("offsets", len(places), f"{len(meshes)}, one for each caster")
    receivers = _receivers()
    above = np.array_equal(checks.vector("eye", eye)[:2], checks.vector("target", target)[:2])
    up = (0.0, 1.0, 0.0) if above else (0.0, 0.0, 1.0)
    camera = Camera.look_at(eye=eye, target=target, up=up, vertical_fov=FIELD_OF_VIEW, width=width, height=height)
    placed = [mesh.bounds + np.append(place, 0.0) for mesh, place in zip(meshes, places, strict=True)]
    around = box_corners(np.concatenate([*(mesh.bounds for mesh in receivers), *placed]))
    bounds = box_corners(np.concatenate([mesh.bounds for mesh in meshes]))
    return Ensemble(
        receivers=receivers,
        casters=[
            Caster(mesh=mesh, offset=place, offset_range=((-REACH, REACH), (-REACH, REACH)))
            for mesh, place in zip(meshes, places, strict=True)
        ],
        lights=[light.over(bounds, REACH, around) for light in lights],
        powers=[light.power for light in lights],
        camera=camera.fitted(around, near=near, far=far),
        ambient=0.25,
        background=(0.82, 0.88, 0.94),
    )


def _mesh(name: str, value: object) -> Mesh:
    if not isinstance(value, Mesh):
        raise checks.reject(name, type(value).__name__, "a Mesh")
    return value


def _numbered(name: str, values: Sequence[Any]) -> list[tuple[str, Any]]:
    """Each with its name: the plain one where there is but one."""
    return [(name if len(values) == 1 else f"{name}s[{i}]", value) for i, value in enumerate(values)]


def _scaled(mesh: Mesh) -> Mesh:
    """Its largest extent 1, the middle of its bounding box above the origin, its lowest point just above the floor."""
    vertices, (low, high) = np.asarray(mesh.vertices), mesh.bounds
    extent = float((high - low).max())
    if not 0.0 < extent < math.inf:
        raise checks.reject("caster.vertices", f"a box from {low.tolist()} to {high.tolist()}", "an extent > 0")
    middle = (low + high) / 2.0
    foot = np.array([middle[0], middle[1], low[2]])
    return Mesh(
        vertices=(vertices - foot) / extent + np.array([0.0, 0.0, _FOOT]),
        triangles=mesh.triangles,
        color=mesh.color,
    )


def _receivers() -> list[Mesh]:
    """The floor, and two steps at its back."""
    floor = _box((-3.0, -3.0, -0.7), (3.0, 3.0, _FLOOR), _FLOOR_COLOR)
    steps = [
        _box((-3.0, y, _FLOOR), (3.0, 3.0, z), color)
        for (y, z), color in zip(((0.75, -0.4), (1.25, -0.2)), _STEP_COLORS, strict=True)
    ]
    return [floor, *steps]


def _box(low: tuple[float, float, float], high: tuple[float, float, float], color: ArrayLike) -> Mesh:
    """A box with outward triangles."""
    x, y, z = zip(low, high, strict=True)
    vertices: NDArray[np.float64] = np.array([(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)])
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [corner for a, b, c, d in quads for corner in ((a, b, c), (a, c, d))]
    return Mesh(vertices=vertices, triangles=triangles, color=color)
