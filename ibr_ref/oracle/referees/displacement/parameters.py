"""The continuous parameters of a case: what a port may have slightly wrong everywhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.judgement import Parameter
from ibr_ref.oracle.referees.moved import components, with_light, with_params, with_scene
from ibr_ref.scene import Camera
from ibr_ref.searches import SEARCHES

STEP = 2.0**-10
"""Of a parameter, relative to its size: the cube root of float64's precision is 2^-17, and a hit moves in lattice steps, so
that a difference over many pixels needs a step that moves some of them."""


def parameters(case: Case) -> list[Parameter]:
    """Light, search and volume, and the eye."""
    light, polygons = case.scene.light, case.scene.polygons
    found = [_parameter(f"light.{name}", getattr(light, name), _light(case, name)) for name in ("ambient", "diffuse")]
    if light.specular > 0.0:
        found.append(_parameter("light.specular", light.specular, _light(case, "specular")))
    where = "position" if light.direction is None else "direction"
    places = components(getattr(light, where), lambda vector: with_light(case, **{where: vector}))
    found += [_parameter(f"light.{where}.{axis}", value, moved) for axis, value, moved in places]
    found.append(_parameter("height_scale", 1.0, _scaled(case)))
    reads = SEARCHES[case.params.method].reads
    if "steep_threshold" in reads:
        found.append(_parameter("steep_threshold", case.params.steep_threshold, _param(case, "steep_threshold")))
    if case.params.shadow_steps:
        found.append(_parameter("shadow_bias", case.params.shadow_bias, _param(case, "shadow_bias")))
    if "facade_map" in reads and any(polygon.facade_map is not None for polygon in polygons):
        found.append(_parameter("facade_tile", 1.0, _tiled(case)))
    found += [_parameter(f"eye.{axis}", 0.0, _moved_eye(case, k), size=_extent(case)) for k, axis in enumerate("xyz")]
    return found


def _parameter(name: str, value: float, moved: Callable[[float], Case], size: float | None = None) -> Parameter:
    size = max(abs(value), 1e-2) if size is None else size  # a step for what is 0 by chance
    return Parameter(name=name, value=float(value), step=STEP * size, moved=moved)


def _light(case: Case, name: str) -> Callable[[float], Case]:
    return lambda value: with_light(case, **{name: value})


def _param(case: Case, name: str) -> Callable[[float], Case]:
    return lambda value: with_params(case, **{name: value})


def _scaled(case: Case) -> Callable[[float], Case]:
    """All volumes, by a factor."""

    def moved(factor: float) -> Case:
        polygons = [replace(p, height_scale=p.height_scale * factor) for p in case.scene.polygons]
        return with_scene(case, polygons=polygons)

    return moved


def _tiled(case: Case) -> Callable[[float], Case]:
    """All facade tiles, by a factor."""

    def moved(factor: float) -> Case:
        polygons = [
            replace(p, facade_tile=(p.facade_tile[0] * factor, p.facade_tile[1] * factor)) for p in case.scene.polygons
        ]
        return with_scene(case, polygons=polygons)

    return moved


def _moved_eye(case: Case, axis: int) -> Callable[[float], Case]:
    """The camera as a whole, along an axis of the world; for one without perspective that moves the picture alone."""

    def moved(offset: float) -> Case:
        camera = case.scene.camera
        view = np.array(camera.view_from_world)
        view[:3, 3] -= view[:3, axis] * offset
        eye = np.array(camera.eye)
        eye[axis] += offset * eye[3]
        shifted: Camera = replace(camera, view_from_world=view, eye=eye)
        return with_scene(case, camera=shifted)

    return moved


def _extent(case: Case) -> float:
    """The size of the polygons in the world."""
    return float(max(np.linalg.norm(np.asarray(p.edge_u)) for p in case.scene.polygons))
