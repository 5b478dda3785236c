"""Splatting in a sweep: holes and overdraw of a view, and how far its colours are from the mesh, or from photographs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ibr_ref import models
from ibr_ref.metrics import psnr
from ibr_ref.scene import DepthImage, Mesh, checks
from ibr_ref.splatting import Params, Scene, bounds, coverage, render
from ibr_ref.sweep import views
from ibr_ref.sweep.measures import Measure, with_time

MEASURES = with_time(
    {
        "holes": Measure("share of the surface's pixels that no splat covers"),
        "coverage": Measure("share of the picture's pixels that show a splat", more=True),
        "overdraw": Measure("splats a covered pixel"),
        "decibels": Measure("of the colours where the picture and the truth show something", more=True),
    }
)
ERROR, COST = "holes", "overdraw"
AGAINST = ("nothing", "mesh", "pictures")
ALIASES: dict[str, str] = {}
Swept = Params


class View(NamedTuple):
    """A scene, and what is really there."""

    scene: Scene
    truth: Mesh | DepthImage | None


def viewed(scene: Scene, count: int, against: object) -> tuple[list[View], str]:
    """The scene from around, or from where pictures were taken.

    against: the `Mesh` that the references are of, pictures (`DepthImage`, one for each view, with its camera), or None.
    Raises ValueError for another, for another number of pictures than of views, and for either with a light: what it is
    measured against is not lit.
    """
    if against is not None and scene.light is not None:
        raise checks.reject(
            "against", type(against).__name__, "None with a light: what it is measured against is not lit"
        )
    if isinstance(against, Sequence) and all(isinstance(each, DepthImage) for each in against):
        if len(against) != count:
            raise checks.reject("views", count, f"{len(against)}, one for each picture")
        return [View(replace(scene, camera=truth.camera), truth) for truth in against], "pictures"
    if against is not None and not isinstance(against, Mesh):
        raise checks.reject("against", type(against).__name__, "None, a Mesh, or a sequence of DepthImage")
    cameras = views.around(scene.camera, bounds(scene.images), count)
    return [
        View(replace(scene, camera=camera), against) for camera in cameras
    ], "nothing" if against is None else "mesh"


def measured(view: View, params: Params, kept: dict[Any, Any]) -> dict[str, float | None]:
    """A row's measures. kept: what was made for the same view before."""
    scene, truth = view
    frame = render(scene, params)
    if "surface" not in kept:
        kept["truth"] = models.depth_image(truth, scene.camera) if isinstance(truth, Mesh) else truth
        kept["surface"] = coverage(scene, frame)
    stages = frame.stages
    found = kept["surface"]._replace(covered=stages["raster.splat"] >= 0, overdraw=stages["raster.overdraw"])
    return {
        "holes": found.hole_share,
        "coverage": found.coverage,
        "overdraw": found.mean_overdraw,
        "decibels": _decibels(frame.color, kept["truth"], found.covered),
    }


def _decibels(color: Any, truth: DepthImage | None, covered: Any) -> float | None:
    if truth is None:
        return None
    colors, _, mask = truth.arrays
    where = covered & mask
    return psnr(color, np.asarray(colors), where) if where.any() else None


def drawing(view: View, params: Params) -> Callable[[], object]:
    """What is timed."""
    return lambda: render(view.scene, params, stages=False)
