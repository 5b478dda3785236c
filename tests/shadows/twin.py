"""The naive twin beside the package: on golden scenes, and with given controls, which are an input to it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref import shadows
from ibr_ref.io import Frame
from ibr_ref.shadows import Ensemble, Params, Scene
from tests.agreement import arrays_of, check_without_stages, differences, flat
from tests.naive import shadow_ensemble as naive_ensemble
from tests.naive import shadows as naive
from tests.shadows.golden_scenes import prepared, prepared_for_all


def render(scene: Scene | Ensemble, params: Params) -> Any:
    """(stages, color, depth), with the controls that the package places."""
    if isinstance(scene, Ensemble):
        all_maps = prepared_for_all(scene, params)
        return naive_ensemble.render(scene, params, all_maps and [[m.controls for m in row] for row in all_maps])
    maps = prepared(scene, params)
    return naive.render(scene, params, None if maps is None else maps.controls)


def check_agreement(scene: Scene, params: Params, controls: NDArray[np.float64]) -> Frame:
    """Render with the package and with the twin, and compare everything; gives the package's frame."""
    maps = shadows.prepare(scene, params, controls=controls) if params.method == "warp" else None
    frame = shadows.render(scene, params, maps=maps)
    stages, color, depth = naive.render(scene, params, controls)
    theirs = {**flat(stages), "color": color, "depth": depth}
    assert not (report := differences(arrays_of(frame), theirs)), report
    check_without_stages(shadows, scene, params, frame, maps=maps)
    return frame
