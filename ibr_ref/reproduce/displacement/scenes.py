"""What the systems are tried on: the paper's box, a block of the city, and a field of thin spikes; 256 x 256 texels each."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from ibr_ref import models
from ibr_ref.displacement import Scene
from ibr_ref.models.box import BLUE, YELLOW
from ibr_ref.scene import BasePolygon, Camera, Light

WHITE = (1.0, 1.0, 1.0)
SKY = (0.72, 0.82, 0.93)
LIGHT = Light(direction=(0.5, -0.8, 1.0))


def spikes() -> BasePolygon:
    """196 columns of 2 x 2 texels, half to nearly all of the volume high, in the box's colours: narrow and tall."""
    random = np.random.RandomState(0)
    heights = np.zeros((256, 256))
    for row in range(20, 240, 16):
        for column in range(20, 240, 16):
            y, x = row + random.randint(-4, 5), column + random.randint(-4, 5)
            heights[y : y + 2, x : x + 2] = random.uniform(0.5, 0.95)
    raised = heights > 0
    raised |= np.roll(raised, 1, 0) | np.roll(raised, 1, 1)
    colors = np.where(raised[..., None], BLUE / 255.0, YELLOW / 255.0)
    return replace(models.box(), height_map=heights, color_map=colors, facade_map=None)


def block() -> BasePolygon:
    """The middle of the city, 256 x 256 texels on 1 x 1 world units, with the heights of its volume."""
    part = models.city_blocks()[5]
    return replace(part, corner=(-0.5, -0.5, 0.0))


def looking_at(
    polygon: BasePolygon, eye: tuple[float, float, float], *, target: tuple[float, float, float] = (0.0, 0.0, 0.03),
    size: tuple[int, int] = (480, 360), fov: float = 45.0, background: tuple[float, float, float] = WHITE,
) -> Scene:  # fmt: skip
    """A scene of one polygon."""
    up = (0, 0, 1) if eye[:2] != target[:2] else (0, 1, 0)
    camera = Camera.look_at(
        eye=eye, target=target, up=up, vertical_fov=fov, near=0.05, far=20.0, width=size[0], height=size[1]
    )
    return Scene(polygons=[polygon], camera=camera, light=LIGHT, background=background)


@cache
def trials(size: tuple[int, int] = (480, 360)) -> dict[str, Scene]:
    """The three, seen obliquely from above; made once, as what the systems prepare is kept for each polygon."""
    return {
        "box": looking_at(models.box(), (0.65, -1.2, 0.75), size=size),
        "city": looking_at(block(), (0.65, -1.2, 1.15), size=size),
        "spikes": looking_at(spikes(), (0.65, -1.2, 0.75), size=size),
    }
