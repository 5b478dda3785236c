"""The continuous parameters of a scene of splatting."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.judgement import Parameter
from ibr_ref.oracle.referees.moved import components, with_eye, with_light, with_params, with_scene

STEP = 2.0**-10
"""Of difference quotients, as a share of the parameter's size (at least of 1): far above rounding, whose share of a quotient
is 2^-53 / STEP, and small enough for a second-order error of STEP^2."""

ELLIPSES = ("footprint", "low_pass", "cutoff", "depth_tolerance", "max_width")
LAW = ("alpha", "beta", "gamma", "delta", "min_width", "max_width")
COEFFICIENTS = ("ambient", "diffuse", "specular")


def parameters(case: Case) -> list[Parameter]:
    """Those of the light, of the law of the width or of the ellipses, the background, and the eye."""
    scene, light = case.scene, case.scene.light
    names = ELLIPSES if case.params.shape == "ellipse" else LAW
    found = [_of(name, getattr(case.params, name), _changed(case, with_params, name)) for name in names]
    if light is not None:
        found += [_of(f"light.{name}", getattr(light, name), _changed(case, with_light, name)) for name in COEFFICIENTS]
        place = "position" if light.position is not None else "direction"
        found += _vector(f"light.{place}", getattr(light, place), _changed(case, with_light, place))
    found += _vector("background", scene.background, _changed(case, with_scene, "background"), "rgb")
    if scene.camera.perspective:
        found += _vector("camera.eye", scene.camera.eye[:3], lambda eye: with_eye(case, eye))
    return found


def _changed(case: Case, change: Callable[..., Case], name: str) -> Callable[[Any], Case]:
    return lambda value: change(case, **{name: value})


def _of(name: str, value: float, moved: Callable[[float], Case]) -> Parameter:
    return Parameter(name=name, value=float(value), step=STEP * max(1.0, abs(float(value))), moved=moved)


def _vector(name: str, vector: Any, moved: Callable[[Any], Case], letters: str = "xyz") -> list[Parameter]:
    return [_of(f"{name}.{letter}", value, move) for letter, value, move in components(vector, moved, letters)]
