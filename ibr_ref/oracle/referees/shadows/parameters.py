"""The continuous parameters of a scene of shadows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.judgement import Parameter
from ibr_ref.scene import Camera
from ibr_ref.shadows.prepared import source_of

STEP = 2.0**-10
"""Of difference quotients, as a share of the parameter's size (at least of 1): far above rounding, whose share of a quotient
is 2^-53 / STEP, and small enough for a second-order error of STEP^2."""


def parameters(case: Case) -> list[Parameter]:
    """Those of the light, the object's place, the bias, the background and the eye."""
    scene, params = case.scene, case.params
    light = scene.light
    found = [
        _of("ambient", scene.ambient, lambda value: _scene(case, ambient=value)),
        _of("light.vertical_fov", light.vertical_fov, lambda value: _light(case, vertical_fov=value)),
    ]
    found += _components("light.position", light.position, lambda place: _light(case, position=place))
    if _spread(case):
        edges = np.asarray(light.half_edges)
        found.append(_of("light.size", 1.0, lambda value: _light(case, half_edges=value * edges)))
    found += _components("offset", scene.offset, lambda place: _scene(case, offset=place), "xy")
    if params.content == "depth":
        found.append(_of("bias", params.bias, lambda value: replace(case, params=replace(params, bias=value))))
    found += _components("background", scene.background, lambda color: _scene(case, background=color), "rgb")
    if scene.camera.perspective:
        found += _components("camera.eye", scene.camera.eye[:3], lambda eye: _with_eye(case, eye))
    return found


def _spread(case: Case) -> bool:
    """Whether the light's samples follow its size."""
    return not isinstance(case.params.light_samples, np.ndarray) and int(case.params.light_samples) > 1


def _of(name: str, value: float, moved: Callable[[float], Case]) -> Parameter:
    return Parameter(name=name, value=float(value), step=STEP * max(1.0, abs(float(value))), moved=moved)


def _components(name: str, vector: Any, moved: Callable[[Any], Case], letters: str = "xyz") -> list[Parameter]:
    start = np.asarray(vector, np.float64)

    def component(axis: int) -> Callable[[float], Case]:
        return lambda value: moved(np.where(np.arange(len(start)) == axis, value, start))

    return [_of(f"{name}.{letter}", start[axis], component(axis)) for axis, letter in enumerate(letters)]


def _scene(case: Case, **changes: Any) -> Case:
    return replace(case, scene=replace(case.scene, **changes))


def _light(case: Case, **changes: Any) -> Case:
    """Another light on the maps that are given: that is what a port has whose light is not where it should be."""
    moved = _scene(case, light=replace(case.scene.light, **changes))
    maps = case.inputs.get("maps")
    if maps is None:
        return moved
    return replace(moved, inputs={**case.inputs, "maps": replace(maps, source=source_of(moved.scene))})


def _with_eye(case: Case, eye: Any) -> Case:
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
    return _scene(case, camera=moved)
