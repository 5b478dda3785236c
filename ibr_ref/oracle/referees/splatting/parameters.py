"""The continuous parameters of a scene of splatting."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.judgement import Parameter
from ibr_ref.scene import Camera

STEP = 2.0**-10
"""Of difference quotients, as a share of the parameter's size (at least of 1): far above rounding, whose share of a quotient
is 2^-53 / STEP, and small enough for a second-order error of STEP^2."""

LAW = ("alpha", "beta", "gamma", "delta", "min_width", "max_width")
COEFFICIENTS = ("ambient", "diffuse", "specular")


def parameters(case: Case) -> list[Parameter]:
    """Those of the light, the law of the width, the background, and the eye."""
    found = [_of(case, name, getattr(case.params, name), _law(case, name)) for name in LAW]
    light = case.scene.light
    if light is not None:
        found += [_of(case, f"light.{name}", getattr(light, name), _light(case, name)) for name in COEFFICIENTS]
        place = "position" if light.position is not None else "direction"
        found += _components(
            case, f"light.{place}", getattr(light, place), lambda vector: _with_light(case, place, vector)
        )
    found += _components(case, "background", case.scene.background, lambda color: _scene(case, background=color), "rgb")
    if case.scene.camera.perspective:
        found += _components(case, "camera.eye", case.scene.camera.eye[:3], lambda eye: _with_eye(case, eye))
    return found


def _of(case: Case, name: str, value: float, moved: Callable[[float], Case]) -> Parameter:
    return Parameter(name=name, value=float(value), step=STEP * max(1.0, abs(float(value))), moved=moved)


def _law(case: Case, name: str) -> Callable[[float], Case]:
    return lambda value: replace(case, params=replace(case.params, **{name: value}))


def _light(case: Case, name: str) -> Callable[[float], Case]:
    return lambda value: _scene(case, light=replace(case.scene.light, **{name: value}))


def _with_light(case: Case, place: str, vector: Any) -> Case:
    return _scene(case, light=replace(case.scene.light, **{place: vector}))


def _components(
    case: Case, name: str, vector: Any, moved: Callable[[Any], Case], letters: str = "xyz"
) -> list[Parameter]:
    start = np.asarray(vector, np.float64)

    def component(axis: int) -> Callable[[float], Case]:
        return lambda value: moved(np.where(np.arange(3) == axis, value, start))

    return [_of(case, f"{name}.{letter}", start[axis], component(axis)) for axis, letter in enumerate(letters)]


def _scene(case: Case, **changes: Any) -> Case:
    return replace(case, scene=replace(case.scene, **changes))


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
