"""Protruded displacement mapping as pages show it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ibr_ref.array_types import Floats
from ibr_ref.displacement import Params, Scene, bounding_points
from ibr_ref.displacement.inputs import LIMITS, READ_BY
from ibr_ref.scene.limits import Real
from ibr_ref.viewer import lights
from ibr_ref.viewer.knobs import Knob
from ibr_ref.viewer.room import Viewable

_HEIGHT = "height"


def _points(scene: Scene, params: Params) -> Floats:
    return bounding_points(scene.polygons, scene.camera, params)


def _knobs(scene: Scene) -> dict[str, Knob]:
    height = Knob(Real(above=0.0, high=4.0), 1.0, "Times the height scale of every polygon.")
    return {_HEIGHT: height, **lights.knobs(scene.light)}


def _changed(scene: Scene, values: Mapping[str, Any]) -> Scene:
    times, polygons = values.get(_HEIGHT, 1.0), list(scene.polygons)
    if times != 1.0:
        polygons = [replace(polygon, height_scale=times * polygon.height_scale) for polygon in polygons]
    return replace(scene, polygons=polygons, light=lights.changed(scene.light, values))


VIEWABLE = Viewable(
    limits=LIMITS,
    read_by={name: readers for name, readers in READ_BY.items() if name in LIMITS},
    points=_points,
    knobs=_knobs,
    changed=_changed,
    truth={"method": "exact"},
)
