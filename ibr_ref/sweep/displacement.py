"""Displacement mapping in a sweep: against the first intersection with the solid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ibr_ref.displacement import Params, Scene, bounding_points, render
from ibr_ref.displacement import measures as of
from ibr_ref.metrics import wrong
from ibr_ref.scene import checks
from ibr_ref.searches import SEARCHES
from ibr_ref.sweep import views
from ibr_ref.sweep.measures import Measure, with_time

MEASURES = with_time(
    {
        "wrong": Measure("share of the picture's pixels whose colour is off by more than 1/255"),
        "silhouette": Measure("intersection over union of the pixels that show the shape", more=True),
        "smear": Measure("share of the steps down the walls' pixels that pass less than 1/4 texel; one polygon"),
        "drift": Measure("pixels from where ground is drawn to where it lies, mean; one polygon"),
        "fetches": Measure("of the search, a fragment"),
    }
)
ERROR, COST = "wrong", "fetches"
AGAINST = ("exact",)
ALIASES = {"steps": "linear_steps", "delta": "steep_threshold"}
"""Fields of `Params` as `ibr-ref render` calls them."""
Swept = Params


def viewed(scene: Scene, count: int, against: Any) -> tuple[list[Scene], str]:
    """The scene from around."""
    if against not in (None, *AGAINST):
        raise checks.reject("against", against, " | ".join(AGAINST))
    points = bounding_points(scene.polygons, scene.camera)
    return [replace(scene, camera=camera) for camera in views.around(scene.camera, points, count)], AGAINST[0]


def measured(scene: Scene, params: Params, kept: dict[Any, Any]) -> dict[str, float | None]:
    """A row's measures. kept: what was made for the same scene before."""
    sinks = SEARCHES[params.method].sinks
    if sinks not in kept:
        kept[sinks] = of.truth(scene, sinks)
    truth, frame = kept[sinks], render(scene, params)
    alone = len(scene.polygons) == 1
    return {
        "wrong": float(wrong(frame, truth).mean()),
        "silhouette": of.overlap(frame.depth < 1.0, truth.depth < 1.0),
        "smear": of.number(of.wall_texture(scene, frame, of.walls(scene, truth))[1]) if alone else None,
        "drift": of.number(of.drift(scene, frame)[0]) if alone else None,
        "fetches": of.number(of.fetches(params, frame)),
    }


def drawing(scene: Scene, params: Params) -> Callable[[], object]:
    """What is timed."""
    return lambda: render(scene, params, stages=False)
