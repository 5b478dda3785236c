"""Splatting of depth images as pages show it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ibr_ref.array_types import Floats
from ibr_ref.scene.boxes import box_corners
from ibr_ref.splatting import Params, Scene, bounds
from ibr_ref.splatting.inputs import LIMITS, READ_BY
from ibr_ref.viewer import lights
from ibr_ref.viewer.knobs import Knob
from ibr_ref.viewer.room import Viewable


def _points(scene: Scene, params: Params) -> Floats:
    return box_corners(bounds(scene.images))


def _knobs(scene: Scene) -> dict[str, Knob]:
    return {} if scene.light is None else lights.knobs(scene.light)


def _changed(scene: Scene, values: Mapping[str, Any]) -> Scene:
    return scene if scene.light is None else replace(scene, light=lights.changed(scene.light, values))


VIEWABLE = Viewable(limits=LIMITS, read_by=READ_BY, points=_points, knobs=_knobs, changed=_changed)
