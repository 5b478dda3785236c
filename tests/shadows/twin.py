"""The naive twin as golden scenes call it: with the controls that the package places, which are an input to it."""

from __future__ import annotations

from typing import Any

from ibr_ref.shadows import Params, Scene
from tests.naive import shadows as naive
from tests.shadows.golden_scenes import prepared


def render(scene: Scene, params: Params) -> Any:
    """(stages, color, depth)."""
    maps = prepared(scene, params)
    return naive.render(scene, params, None if maps is None else maps.controls)
