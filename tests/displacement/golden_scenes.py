"""The golden scenes of displacement mapping. `tests/golden.py` renders them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from ibr_ref import models
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.scene import BasePolygon, Camera, Light

__all__ = ["SCENES", "TINY", "render"]

TINY = ("box", "relief", "tiles", "exact")
"""Those with small maps: without compiled kernels a picture of the others takes minutes."""

city = cache(models.city)


def looking(width: int, height: int, **view: Any) -> Camera:
    """A perspective camera for a picture of that size."""
    return Camera.look_at(width=width, height=height, near=0.05, far=20.0, **view)


def box(width: int, height: int) -> tuple[Scene, Params]:
    """The paper's figure 6, with the defaults: 10 linear steps, 6 binary ones."""
    camera = looking(width, height, eye=(1.0, -1.2, 0.9), target=(0.0, 0.0, 0.0), vertical_fov=32.0)
    return Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1.0))), Params()


def relief(width: int, height: int) -> tuple[Scene, Params]:
    """The box by relief mapping, in the light of a lamp, with self-shadow."""
    camera = looking(width, height, eye=(1.0, -1.2, 0.9), target=(0.0, 0.0, 0.0), vertical_fov=32.0)
    scene = Scene(polygons=[models.box()], camera=camera, light=Light(position=(0.7, -0.4, 0.3), specular=0.4))
    return scene, Params(method="relief", shadow_steps=9)


def exact(width: int, height: int) -> tuple[Scene, Params]:
    """The box by its first intersections, seen from low down."""
    camera = looking(width, height, eye=(0.5, -0.9, 0.3), target=(0.0, 0.0, 0.1), vertical_fov=50.0)
    return Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1.0))), Params(
        method="exact"
    )


def oblique(width: int, height: int) -> tuple[Scene, Params]:
    """The city with its facades, self-shadow and a highlight."""
    camera = looking(width, height, eye=(1.6, -2.6, 1.4), target=(0.0, 0.0, 0.0))
    light = Light(direction=(-0.6, -0.5, 0.7), specular=0.3, exponent=37)
    return Scene(polygons=[city()], camera=camera, light=light), Params(linear_steps=40, shadow_steps=16)


def blocks(width: int, height: int) -> tuple[Scene, Params]:
    """Sixteen polygons that hide one another, without perspective, with extended base polygons."""
    camera = Camera.orthographic(
        eye=(2.0, -3.0, 2.0), target=(0.0, 0.0, 0.0), view_height=3.5, near=0.1, far=10.0, width=width, height=height
    )
    scene = Scene(polygons=models.city_blocks(0, 4), camera=camera, light=Light(position=(0.0, 0.0, 2.0)))
    return scene, Params(linear_steps=25, binary_steps=4, faces="extended")


def street(width: int, height: int) -> tuple[Scene, Params]:
    """The city from within the volume, above a street."""
    camera = looking(width, height, eye=(0.0, -1.9, 0.12), target=(0.1, 0.0, 0.2), vertical_fov=70.0)
    scene = Scene(polygons=[city()], camera=camera, light=Light(direction=(1.0, -0.5, 1.0)), background=(0.5, 0.7, 0.9))
    return scene, Params(linear_steps=50, interval="volume", shadow_steps=4)


def tiles(width: int, height: int) -> tuple[Scene, Params]:
    """Repeated maps on a sheared polygon, with a normal map, and the depth of the polygon."""
    random = np.random.RandomState(0)
    polygon = BasePolygon(
        corner=(-0.7, -0.6, 0.1),
        edge_u=(1.3, 0.1, 0.2),
        edge_v=(0.4, 1.1, -0.1),
        height_map=random.random_sample((19, 23)),
        color_map=random.random_sample((7, 9, 3)),
        normal_map=0.5 + 0.5 * random.random_sample((11, 5, 3)),
        height_scale=0.2,
        domain="repeat",
    )
    camera = looking(width, height, eye=(0.5, -0.9, 1.1), target=(0.1, 0.0, 0.1), vertical_fov=50.0)
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.2, 0.3, 1.0), specular=0.5))
    return scene, Params(linear_steps=15, faces="base", depth="polygon", shadow_steps=3)


SCENES: dict[str, Callable[[int, int], tuple[Scene, Params]]] = {
    scene.__name__: scene for scene in (box, relief, exact, oblique, blocks, street, tiles)
}
