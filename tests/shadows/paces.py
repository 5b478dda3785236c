"""The even pace and the projective one: `python -m tests.shadows.quality --paces`.

The cow under lights that are near and aside, maps of 256 x 256, 16 random offsets: intersection over union at >= 0.5 of the
map with the rendered one, mean / worst. Points are registered for the even pace and drawn with both, and registered for
the projective pace.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ibr_ref import metrics, models
from ibr_ref.scene import AreaLight
from ibr_ref.shadows import Maps, Params, Scene, prepare, shadow_maps
from tests.shadows.casters import cow

OFFSETS = 16
SETTINGS = (
    ((-1.0, -1.2, 5.0), 50.0, 1.0),
    ((-1.5, -1.5, 3.5), 60.0, 0.6),
    ((-1.5, -1.5, 3.5), 60.0, 1.0),
    ((-3.0, -2.0, 3.0), 60.0, 1.0),
    ((0.3, 0.2, 5.0), 50.0, 1.0),
)
"""The light's position, its field of view in degrees, the range; it looks at the origin."""

_STILL = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def stages(position: tuple[float, float, float], field_of_view: float, reach: float) -> list[Scene]:
    """The cow at random offsets."""
    light = AreaLight(
        position=position, target=(0.0, 0.0, 0.0), vertical_fov=field_of_view, near=0.5, far=12.0, half_edges=_STILL
    )
    stage = models.shadow_stage(cow(), width=16, height=12)
    stage = replace(stage, light=light, offset_range=((-reach, reach), (-reach, reach)))
    return [replace(stage, offset=o) for o in np.random.RandomState(3).uniform(-reach, reach, (OFFSETS, 2))]


def quality(scenes: list[Scene], params: Params, maps: Maps) -> str:
    """Mean / worst."""
    direct = replace(params, method="direct")
    found = [metrics.iou(shadow_maps(s, params, maps=maps)[0], shadow_maps(s, direct)[0]) for s in scenes]
    return f"{np.mean(found):.3f} / {min(found):.3f}"


def run() -> None:
    """Print the table."""
    print("| light | range | controls | even points, even | even points, projective | projective points, projective |")
    print("|---|---|---|---|---|---|")
    for position, field_of_view, reach in SETTINGS:
        scenes = stages(position, field_of_view, reach)
        even = Params(map_size=256)
        own = replace(even, interpolation="projective")
        for controls in ("fast", "best"):
            maps, paced = (prepare(scenes[0], params, controls=controls) for params in (even, own))
            cells = (quality(scenes, even, maps), quality(scenes, own, maps), quality(scenes, own, paced))
            print(f"| {position} | {reach:g} | `{controls}` | {' | '.join(cells)} |", flush=True)
