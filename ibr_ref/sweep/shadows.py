"""Shadows in a sweep: against maps that are rendered for every sample, with the caster at many places."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ibr_ref.io import Frame
from ibr_ref.metrics import iou, soft_difference
from ibr_ref.scene import checks
from ibr_ref.shadows import MapGrid, Maps, Params, Scene, prepare, prepare_grid, render
from ibr_ref.shadows.prepared import source_of
from ibr_ref.sweep import views
from ibr_ref.sweep.measures import Measure, with_time

MEASURES = with_time(
    {
        "map": Measure(
            "intersection over union of the maps that are projected, mean over the light's samples", more=True
        ),
        "shadow": Measure("intersection over union of the shadow in the picture", more=True),
        "soft": Measure("mean absolute difference of the shadow where there is any"),
        "bytes": Measure("of the maps and control points that are kept"),
    }
)
ERROR, COST = "soft", "bytes"
AGAINST = ("direct",)
ALIASES = {"samples": "light_samples"}
"""Fields of `Params` as `ibr-ref render` calls them."""

_MADE_WITH = {
    "warp": ("rows", "columns", "policy", "interpolation", "controls"),
    "grid": ("grid_size", "grid_storage", "grid_threshold"),
}
"""Fields that a method's maps depend on, beside those of all maps."""

_MOST_MAPS = 2
"""Of those that are kept for the next place or the next setting."""

_prepared: OrderedDict[tuple[Any, ...], Maps | MapGrid] = OrderedDict()


@dataclass(frozen=True, kw_only=True, eq=False)
class Swept(Params):
    """What is swept: all of `Params`, and how control points are placed."""

    controls: str = "fast"
    """As `prepare` takes it."""

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.choice("controls", self.controls, ("fast", "best", "bounds", "identity"))


def viewed(scene: Scene, count: int, against: Any) -> tuple[list[Scene], str]:
    """The scene with the caster at so many places of its range, the first one in the middle."""
    if against not in (None, *AGAINST):
        raise checks.reject("against", against, " | ".join(AGAINST))
    (x0, x1), (y0, y1) = np.asarray(scene.offset_range)
    places = views.places(np.array([x0, y0]), np.array([x1, y1]), count)
    return [replace(scene, offset=place) for place in places], AGAINST[0]


def measured(scene: Scene, params: Swept, kept: dict[Any, Any]) -> dict[str, float | None]:
    """A row's measures. kept: not used, as what is true depends on the parameters."""
    maps = _maps(scene, params)
    ours, theirs = render(scene, params, maps=maps), render(scene, replace(params, method="direct"))
    pairs = [] if params.method == "pcss" else zip(_images(ours), _images(theirs), strict=True)
    found = [iou(*pair) for pair in pairs]
    return {
        "map": float(np.mean(found)) if found else None,
        "shadow": iou(*(frame.stages["accumulate.shadow"] for frame in (ours, theirs))),
        "soft": soft_difference(*(frame.stages["accumulate.shadow"] for frame in (ours, theirs))),
        "bytes": float(maps.nbytes) if maps is not None else 0.0,
    }


def drawing(scene: Scene, params: Swept) -> Callable[[], object]:
    """What is timed: with maps made before, but for those that are rendered for every frame."""
    maps = _maps(scene, params)
    return lambda: render(scene, params, maps=maps, stages=False)


def _images(frame: Frame) -> Any:
    image = frame.stages["warp.image"]
    return image.reshape(-1, *image.shape[-2:])


def _maps(scene: Scene, params: Swept) -> Maps | MapGrid | None:
    """Those that serve all places of the caster."""
    if params.method in ("direct", "pcss"):
        return None
    made_with = ("map_size", "content", "map_samples", *_MADE_WITH[params.method])
    values = tuple(getattr(params, name) for name in made_with)
    samples, ends = (np.asarray(array).tobytes() for array in (params.light_samples, scene.offset_range))
    key = (source_of(scene), ends, samples, params.method, values)
    if key not in _prepared:
        if len(_prepared) >= _MOST_MAPS:
            _prepared.popitem(last=False)
        warped = params.method == "warp"
        _prepared[key] = prepare(scene, params, controls=params.controls) if warped else prepare_grid(scene, params)
    return _prepared[key]
