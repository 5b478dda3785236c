"""The continuous parameters of a scene of shadows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.judgement import Parameter
from ibr_ref.oracle.programs.shadows.soft import SOFT
from ibr_ref.oracle.referees.moved import components, with_eye, with_light, with_params, with_scene
from ibr_ref.shadows.prepared import source_of

STEP = 2.0**-10
"""Of difference quotients, as a share of the parameter's size (at least of 1): far above rounding, whose share of a quotient
is 2^-53 / STEP, and small enough for a second-order error of STEP^2."""


def parameters(case: Case) -> list[Parameter]:
    """Those of the light, the object's place, the bias, the background and the eye."""
    scene, params = case.scene, case.params
    light = scene.light
    found = [_of("ambient", scene.ambient, lambda value: with_scene(case, ambient=value))]
    if params.method != SOFT:  # whose map is not the light's own
        found.append(_of("light.vertical_fov", light.vertical_fov, lambda value: _light(case, vertical_fov=value)))
    found += _components("light.position", light.position, lambda place: _light(case, position=place))
    if _spread(case):
        edges = np.asarray(light.half_edges)
        found.append(_of("light.size", 1.0, lambda value: _light(case, half_edges=value * edges)))
    found += _components("offset", scene.offset, lambda place: with_scene(case, offset=place), "xy")
    if params.content == "depth":
        found.append(_of("bias", params.bias, lambda value: with_params(case, bias=value)))
    found += _components("background", scene.background, lambda color: with_scene(case, background=color), "rgb")
    if scene.camera.perspective:
        found += _components("camera.eye", scene.camera.eye[:3], lambda eye: with_eye(case, eye))
    return found


def _spread(case: Case) -> bool:
    """Whether the shadow follows the light's size."""
    given = case.params.light_samples
    return bool(case.params.method == SOFT or (not isinstance(given, np.ndarray) and int(given) > 1))


def _of(name: str, value: float, moved: Callable[[float], Case]) -> Parameter:
    return Parameter(name=name, value=float(value), step=STEP * max(1.0, abs(float(value))), moved=moved)


def _components(name: str, vector: Any, moved: Callable[[Any], Case], letters: str = "xyz") -> list[Parameter]:
    return [_of(f"{name}.{letter}", value, move) for letter, value, move in components(vector, moved, letters)]


def _light(case: Case, **changes: Any) -> Case:
    """Another light on the maps that are given: that is what a port has whose light is not where it should be."""
    moved = with_light(case, **changes)
    maps = case.inputs.get("maps")
    if maps is None:
        return moved
    return replace(moved, inputs={**case.inputs, "maps": replace(maps, source=source_of(moved.scene))})
