"""What the cases of displacement mapping are made of: cameras, parameters, maps and polygons."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from ibr_ref import models
from ibr_ref.array_types import Floats
from ibr_ref.displacement import Params, Scene
from ibr_ref.oracle.cases.case import Case
from ibr_ref.scene import BasePolygon, Camera

WIDTH, HEIGHT = 112, 84
"""Pixels of a picture that shows enough."""


def case_of(name: str, kind: str, about: str, scene: Scene, params: Params, profile: str = "ieee32") -> Case:
    """A case, by its name without the method's."""
    return Case(
        name=f"displacement-{name}",
        method="displacement",
        kind=kind,
        about=about,
        profile=profile,
        scene=scene,
        params=params,
    )


def looking(**view: Any) -> Camera:
    """With perspective, of WIDTH x HEIGHT pixels, from `eye` to `target`."""
    return Camera.look_at(**{"width": WIDTH, "height": HEIGHT, "near": 0.05, "far": 20.0, "vertical_fov": 40.0, **view})


def params_with(**values: Any) -> Params:
    """A threshold that no lattice of these cases meets: where it does, as 0.1 does, whole rows of hits tie."""
    return Params(**{"steep_threshold": 0.123, **values})


def noise(*shape: int, seed: int) -> Floats:
    """Of this shape, in [0, 1)."""
    return np.random.RandomState(seed).random_sample(shape)


def hills(rows: int, columns: int) -> Floats:
    """Smooth heights in 0.05 ... 0.95, with a wall, a block and a needle in them."""
    v, u = (np.arange(rows)[:, np.newaxis] + 0.5) / rows, (np.arange(columns) + 0.5) / columns
    heights = 0.1 + 3.2 * u * (1.0 - u) * v * (1.0 - v)
    heights[rows // 2 :, : columns // 3] += 0.4
    heights[rows // 5 : rows // 3, columns // 2 : 3 * columns // 4] = 0.937
    heights[3 * rows // 4, 3 * columns // 4] = 0.9
    return heights


def rolling() -> Floats:
    """Smooth hills in 0.15 ... 0.95, without an edge."""
    return smooth((40, 56), 0.15, 0.95, 0.1)


def sheared(**more: Any) -> BasePolygon:
    """A tilted parallelogram, longer than wide, away from the origin, with a map that is no square, and a facade."""
    values = {
        "corner": (0.3, -0.8, 0.1),
        "edge_u": (1.5, 0.2, 0.1),
        "edge_v": (0.5, 0.8, -0.1),
        "height_map": hills(40, 56),
        "color_map": noise(9, 13, 3, seed=1),
        "height_scale": 0.3,
        "facade_map": noise(8, 6, 3, seed=2),
        "facade_tile": (0.4, 0.25),
    }
    return BasePolygon(**{**values, **more})


def smooth(shape: tuple[int, int], low: float, high: float, phase: float) -> Floats:
    """A gentle wave over a map, by a parabola's arcs."""
    v, u = (np.arange(shape[0])[:, np.newaxis] + 0.5) / shape[0], (np.arange(shape[1]) + 0.5) / shape[1]
    x = np.abs((u + 0.7 * v + phase) % 1.0 - 0.5)
    return low + (high - low) * (16.0 * x * x * (0.5 - x) ** 2 * 16.0)


def gentle(**more: Any) -> BasePolygon:
    """Low waves in pale colours: filters of eight bits move nothing by a step."""
    heights = smooth((12, 16), 0.45, 0.6, 0.1)
    colors = np.stack([smooth((4, 5), 0.4, 0.6, phase) for phase in (0.0, 0.3, 0.6)], axis=-1)
    values = {"height_map": heights, "color_map": colors, "facade_map": None}
    return sheared(**{**values, **more})


@cache
def quarter() -> tuple[BasePolygon, ...]:
    """Two by two neighbouring blocks of the city, 256 x 256 texels each."""
    blocks = models.city_blocks(0, 4)
    return blocks[5], blocks[6], blocks[9], blocks[10]
