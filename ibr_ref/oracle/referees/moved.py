"""Cases with something changed: what the regression of systematic errors draws."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import Camera


def with_scene(case: Case, **changes: Any) -> Case:
    """Fields of the scene."""
    return replace(case, scene=replace(case.scene, **changes))


def with_light(case: Case, **changes: Any) -> Case:
    """Fields of the scene's light."""
    return with_scene(case, light=replace(case.scene.light, **changes))


def with_params(case: Case, **changes: Any) -> Case:
    """Fields of the parameters."""
    return replace(case, params=replace(case.params, **changes))


def with_eye(case: Case, eye: Any) -> Case:
    """The view from elsewhere, in the same direction."""
    camera = case.scene.camera
    view = np.array(camera.view_from_world)
    r = view[:3, :3]
    view[:3, 3] = [-(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2]) for row in r]
    moved = Camera(
        view_from_world=view,
        clip_from_view=camera.clip_from_view,
        near=camera.near,
        far=camera.far,
        width=camera.width,
        height=camera.height,
        eye=np.append(eye, 1.0),
        intrinsics=camera.intrinsics,
    )
    return with_scene(case, camera=moved)


def components(
    vector: Any, moved: Callable[[Any], Case], letters: str = "xyz"
) -> Iterator[tuple[str, float, Callable[[float], Case]]]:
    """Each component of a vector: its letter, its value, and the case with another value of it."""
    start = np.asarray(vector, np.float64)

    def component(axis: int) -> Callable[[float], Case]:
        return lambda value: moved(np.where(np.arange(len(start)) == axis, value, start))

    for axis, letter in enumerate(letters):
        yield letter, float(start[axis]), component(axis)
