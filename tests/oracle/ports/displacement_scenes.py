"""Scenes that show what can go wrong in a port of displacement mapping: each has features that some bugs need."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref import models
from ibr_ref.displacement import Params, Scene
from ibr_ref.oracle.cases.displacement import CASES, made
from ibr_ref.oracle.cases.displacement.made import noise
from ibr_ref.oracle.faults.displacement import MUTANTS
from ibr_ref.scene import BasePolygon, Camera, Light

WIDTH, HEIGHT = 96, 72


def hills(rows: int, columns: int) -> NDArray[np.float64]:
    """Smooth heights in 0.05 … 0.95, with one wall and one block in them."""
    v, u = (np.arange(rows)[:, np.newaxis] + 0.5) / rows, (np.arange(columns) + 0.5) / columns
    heights = 0.1 + 3.2 * u * (1.0 - u) * v * (1.0 - v)
    heights[rows // 2 :, : columns // 3] += 0.4
    heights[rows // 5 : rows // 3, columns // 2 : 3 * columns // 4] = 0.937
    return heights


def looking(**view: Any) -> Camera:
    """A perspective camera."""
    return made.looking(**{"width": WIDTH, "height": HEIGHT, **view})


def sheared(**more: Any) -> BasePolygon:
    """That of the cases, with these hills."""
    return made.sheared(**{"height_map": hills(40, 56), **more})


@cache
def quarter() -> tuple[BasePolygon, ...]:
    """Two by two neighbouring blocks of the city, 256 x 256 texels each."""
    blocks = models.city_blocks(0, 4)
    return blocks[5], blocks[6], blocks[9], blocks[10]


def box() -> tuple[Scene, Params]:
    """The paper's figure 6, with the defaults."""
    camera = looking(eye=(1.0, -1.2, 0.9), target=(0.0, 0.0, 0.0), vertical_fov=32.0)
    return Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1.0))), Params()


def city() -> tuple[Scene, Params]:
    """A block of the city: facades, self-shadow from a low sun, a highlight."""
    camera = looking(eye=(-0.1, -2.1, 1.2), target=(-0.5, -0.5, 0.1), vertical_fov=45.0)
    light = Light(direction=(-0.7, -0.6, 0.6), specular=0.3, exponent=31)
    scene = Scene(polygons=[quarter()[0]], camera=camera, light=light, background=(0.4, 0.5, 0.6))
    return scene, Params(linear_steps=40, shadow_steps=16)


def blocks() -> tuple[Scene, Params]:
    """Four polygons that hide one another, without perspective, their bases extended, a point light."""
    camera = Camera.orthographic(
        eye=(2.0, -3.0, 1.8), target=(0.0, 0.0, 0.2), view_height=2.2, near=0.1, far=10.0, width=WIDTH, height=HEIGHT
    )
    light = Light(position=(0.0, 0.0, 1.2), specular=0.4, exponent=8)
    return Scene(polygons=quarter(), camera=camera, light=light), Params(
        linear_steps=25, binary_steps=4, faces="extended"
    )


def slope() -> tuple[Scene, Params]:
    """The sheared polygon in the light of a lamp, brighter than white, with self-shadow."""
    camera = looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.2), vertical_fov=30.0)
    light = Light(position=(1.0, -1.4, 1.5), diffuse=1.3, specular=0.8, exponent=12)
    return Scene(polygons=[sheared()], camera=camera, light=light), Params(shadow_steps=7, steep_threshold=0.15)


def coarse() -> tuple[Scene, Params]:
    """Linear steps longer than the threshold of steepness, on noise."""
    camera = looking(eye=(2.0, -1.9, 1.3), target=(1.3, -0.35, 0.2), vertical_fov=30.0)
    polygon = sheared(height_map=noise(15, 18, seed=4))
    return Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.4, -0.5, 1.0))), Params(
        linear_steps=4, steep_threshold=0.03
    )


def mapped() -> tuple[Scene, Params]:
    """A normal map on the sheared polygon; coarse steps, no binary search."""
    camera = looking(eye=(0.2, -1.9, 1.2), target=(1.3, -0.3, 0.2), vertical_fov=32.0)
    polygon = sheared(normal_map=0.5 + 0.5 * noise(7, 5, 3, seed=3), facade_map=None)
    light = Light(direction=(0.4, -0.5, 1.0), specular=0.3)
    return Scene(polygons=[polygon], camera=camera, light=light), Params(linear_steps=12, binary_steps=0)


def tiles() -> tuple[Scene, Params]:
    """Repeated maps, the base alone, and the depth of the polygon."""
    camera = looking(eye=(0.6, -1.7, 1.3), target=(1.3, -0.3, 0.1), vertical_fov=34.0)
    polygon = sheared(height_map=noise(11, 14, seed=0), normal_map=0.4 + 0.5 * noise(7, 5, 3, seed=3), domain="repeat")
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(-0.8, 0.6, 0.5), specular=0.5))
    return scene, Params(linear_steps=15, faces="base", depth="polygon", shadow_steps=5)


def street() -> tuple[Scene, Params]:
    """The city from within its volume, above a street."""
    camera = looking(eye=(-0.5, -0.98, 0.1), target=(-0.52, -0.3, 0.16), vertical_fov=75.0, near=0.01)
    scene = Scene(polygons=[quarter()[0]], camera=camera, light=Light(direction=(1.0, -0.5, 1.0)))
    return scene, Params(linear_steps=50, interval="volume", shadow_steps=4)


def beside() -> tuple[Scene, Params]:
    """The volume from outside and below its top: the interval that is cut out by the walls."""
    camera = looking(eye=(1.6, -1.9, 0.25), target=(1.3, -0.3, 0.2), vertical_fov=36.0)
    light = Light(direction=(-0.3, -0.9, 0.8))
    return Scene(polygons=[sheared()], camera=camera, light=light), Params(linear_steps=20, interval="volume")


def facing() -> tuple[Scene, Params]:
    """The paper's interval from an eye below the top of the box that it faces: sides reach above the eye."""
    camera = looking(eye=(-0.05, -0.49, 0.13), target=(0.0, 0.3, 0.12), vertical_fov=80.0)
    return Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1.0))), Params()


def planes() -> tuple[Scene, Params]:
    """The near and the far plane cut the volume."""
    camera = looking(eye=(2.2, -1.5, 0.9), target=(1.2, -0.3, 0.2), near=1.3, far=2.0)
    return Scene(polygons=[sheared()], camera=camera, light=Light(direction=(0.3, -0.5, 1.0))), Params(linear_steps=16)


def crossing() -> tuple[Scene, Params]:
    """One polygon through another."""
    upright = sheared(corner=(0.8, -0.9, -0.1), edge_u=(0.3, 1.2, 0.1), edge_v=(0.1, -0.05, 0.7), height_scale=0.15)
    camera = looking(eye=(2.6, -1.4, 1.2), target=(1.2, -0.2, 0.2))
    polygons = [sheared(), upright]
    scene = Scene(polygons=polygons, camera=camera, light=Light(direction=(0.3, -0.5, 1.0)), background=(0.2, 0.3, 0.1))
    return scene, Params(linear_steps=16)


def coincident() -> tuple[Scene, Params]:
    """Two polygons in the same place, with the same heights, in different colours: the first is seen."""
    camera = looking(eye=(2.6, -1.4, 1.2), target=(1.2, -0.2, 0.2))
    polygons = [sheared(), sheared(color_map=noise(9, 13, 3, seed=7))]
    return Scene(polygons=polygons, camera=camera, light=Light(direction=(0.3, -0.5, 1.0))), Params(linear_steps=16)


def from_above() -> tuple[Scene, Params]:
    """Without perspective, from straight above: edges and diagonals run through pixel centres."""
    camera = Camera.orthographic(
        eye=(0.0, 0.0, 2.0),
        target=(0.0, 0.0, 0.0),
        up=(0.0, 1.0, 0.0),
        view_height=2.25,
        near=0.5,
        far=4.0,
        width=WIDTH,
        height=HEIGHT,
    )
    values = {"edge_u": (1.0, 0.0, 0.0), "edge_v": (0.0, 1.0, 0.0), "height_scale": 0.25}
    polygons = [
        BasePolygon(corner=(x, -0.484375, 0.0), height_map=hills(16, 16), color_map=noise(4, 4, 3, seed=0), **values)
        for x in (-0.984375, 0.015625)
    ]
    return Scene(polygons=polygons, camera=camera, light=Light(direction=(0.3, 0.5, 1.0))), Params()


def lamp() -> tuple[Scene, Params]:
    """A lamp inside the volume, beside the box: what is behind it throws no shadow."""
    camera = looking(eye=(0.8, -1.3, 1.0), target=(0.0, 0.0, 0.0), vertical_fov=36.0)
    light = Light(position=(-0.3, -0.1, 0.12), specular=0.5, exponent=9)
    return Scene(polygons=[models.box()], camera=camera, light=light), Params(linear_steps=20, shadow_steps=12)


def rim() -> tuple[Scene, Params]:
    """A ridge along the border of the map, seen at a grazing angle against a low sun; ambient between two bytes."""
    heights = 0.25 * hills(40, 48)
    heights[:, -3:] = 0.83
    heights[-4:, :] = 0.57
    camera = looking(eye=(-0.1, -0.95, 0.25), target=(1.35, -0.3, 0.2), vertical_fov=28.0)
    light = Light(direction=(1.0, 0.25, 0.6), ambient=0.23, diffuse=0.7)
    scene = Scene(polygons=[sheared(height_map=heights)], camera=camera, light=light)
    return scene, Params(linear_steps=40, binary_steps=2, shadow_steps=2)


def dusk() -> tuple[Scene, Params]:
    """A sun below the horizon of the polygon."""
    camera = looking(eye=(1.0, -1.2, 0.9), target=(0.0, 0.0, 0.0), vertical_fov=32.0)
    light = Light(direction=(0.5, -0.8, -0.2))
    return Scene(polygons=[models.box()], camera=camera, light=light), Params(shadow_steps=8)


SCENES: dict[str, Callable[[], tuple[Scene, Params]]] = {
    scene.__name__: scene
    for scene in (
        box,
        city,
        blocks,
        slope,
        coarse,
        mapped,
        tiles,
        street,
        beside,
        facing,
        planes,
        crossing,
        coincident,
        from_above,
        lamp,
        rim,
        dusk,
    )
}


def _of(name: str) -> Callable[[], tuple[Scene, Params]]:
    return cache(lambda: (CASES[name]().scene, CASES[name]().params))


SCENES |= {
    "relief": _of("displacement-relief"),
    "welsh": _of("displacement-parallax"),
    "mcguire": _of("displacement-steep"),
    "tatarchuk": _of("displacement-occlusion"),
    "cone": _of("displacement-cone"),
    "relaxed_cone": _of("displacement-relaxed"),
    "donnelly": _of("displacement-distance"),
    "maximum_mipmap": _of("displacement-quadtree"),
}

USUAL = "slope"
"""Where most bugs show: steep walls with a facade, self-shadow, a lamp, a highlight, sheared edges of unequal lengths."""

SHOWN_IN: dict[str, tuple[str, ...]] = {
    # Above the usual: extended faces, no perspective, several polygons.
    "blocks": (
        "clip z from -w",
        "extended base without the polygon",
        "extended base from the middle of the volume",
        "parallel lines of sight towards a point",
        "normals in 8 bits",
        "specular off by 2 %",
        "eye of parallel lines as a point",
        "reflection the wrong way",
        "GREATER",
        "no depth test",
        "depth of the face",
    ),
    # A repeated map, a normal map with a facade, depth="polygon", first steps that stop at once.
    "tiles": (
        "varyings in half precision",
        "lattice of K - 1 steps",
        "first sample left out",
        "repeated heights clamped",
        "one halving left out",
        "hit half a lattice step early",
        "height before in 8 bits",
        "mapped normal decoded from 127",
        "highlights on the far side",
        "shadow ray to the border of a repeated map",
        "depth of the hit",
    ),
    # A normal map, no binary search.
    "mapped": (
        "1/16 subpixels",
        "stops a little above the surface",
        "heights in 8 bits",
        "height of the hit from the map",
        "mapped normal not normalized",
        "mapped normal in [0, 1]",
        "tangent frame left-handed",
    ),
    # Many steps, ground between buildings, a low sun, a background.
    "city": (
        "last linear step left out",
        "stops a little below the surface",
        "no ground",
        "hits at h = 0 are hits",
        "gradient threshold 1/256",
        "diffuse off by 1 %",
        "highlights in the shadow",
        "shadow ray to the top only",
        "black background",
    ),
    # The near and the far plane cut the volume.
    "planes": (
        "near plane of z in [-w, w]",
        "far plane not clipped",
        "hits in front of the near plane",
        "border's height before the map",
    ),
    # Pixel centres on edges.
    "from_above": ("all borders covered", "no borders covered"),
    # Smooth colours, no highlight.
    "box": ("colours in half precision", "colours truncated to bytes", "colours in 256 steps"),
    # Polygons that cross.
    "crossing": ("ambient off by 2 %", "first fragment wins", "depth offset"),
    # A lamp inside the volume, colours above 1.
    "lamp": ("no clamp", "shadows from behind the lamp"),
    # Grazing lines of sight, a shadow from the border, ambient that no byte holds.
    "rim": ("grazing rays discarded", "ambient as a byte", "one shadow sample more"),
    "facing": ("rays that go down are kept",),
    "street": ("search from behind the eye",),
    "beside": ("entry through the top only",),
    "coarse": ("delta on the size of the difference",),
    "dusk": ("no horizon",),
    "coincident": ("LEQUAL",),
    # Below the polygon.
    **{
        search: tuple(m.name for m in MUTANTS if m.only[:1] == (search,))
        for search in ("relief", "welsh", "mcguire", "tatarchuk", "cone", "relaxed_cone", "donnelly", "maximum_mipmap")
    },
}
"""Scenes of the mutants that `USUAL` does not show, or does not show as small as they are meant to be."""


def scene_of(mutant: str) -> str:
    """The name of the scene that shows a mutant."""
    return next((scene for scene, names in SHOWN_IN.items() if mutant in names), USUAL)
