"""Shadows by image warping as pages show them: the object moves, its maps are prepared once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.scene.limits import Real
from ibr_ref.shadows import Maps, Params, Scene, bounding_points, prepare
from ibr_ref.shadows.inputs import LIMITS, READ_BY, SAMPLE_COUNTS
from ibr_ref.shadows.render import check_maps
from ibr_ref.viewer.knobs import Knob, OneOf
from ibr_ref.viewer.room import Viewable

_X, _Y, _AMBIENT = "offset_x", "offset_y", "ambient"


def _points(scene: Scene, params: Params) -> Floats:
    return bounding_points(scene)


def _knobs(scene: Scene) -> dict[str, Knob]:
    ranges, (x, y) = np.asarray(scene.offset_range).tolist(), np.asarray(scene.offset).tolist()
    return {
        _X: Knob(Real(low=ranges[0][0], high=ranges[0][1]), x, "Where the object is, along the first axis."),
        _Y: Knob(Real(low=ranges[1][0], high=ranges[1][1]), y, "Where the object is, along the second axis."),
        _AMBIENT: Knob(Real(low=0.0, high=1.0), scene.ambient, "Share of the light that reaches shadows."),
    }


def _changed(scene: Scene, values: Mapping[str, Any]) -> Scene:
    x, y = np.asarray(scene.offset).tolist()
    return replace(
        scene, offset=(values.get(_X, x), values.get(_Y, y)), ambient=values.get(_AMBIENT, scene.ambient)
    )  # fmt: skip


def _prepared(scene: Scene, params: Params, given: Mapping[str, Any]) -> Mapping[str, Any]:
    """The nine maps that were given, if the parameters are those that they were made with."""
    if params.method != "warp":
        return {}
    maps = given.get("maps")
    if isinstance(maps, Maps):
        try:
            check_maps(scene, params, maps)
            return given
        except ValueError:
            pass
    return {"maps": prepare(scene, params)}


VIEWABLE = Viewable(
    limits={**LIMITS, "light_samples": OneOf(SAMPLE_COUNTS), "quantize": OneOf((None, 8))},
    read_by=READ_BY,
    points=_points,
    knobs=_knobs,
    changed=_changed,
    truth={"method": "direct"},
    prepared=_prepared,
)
