"""Cases of where things end: planes that clip, an eye inside the volume, ties in depth, edges, borders and slivers."""

from __future__ import annotations

from ibr_ref import models
from ibr_ref.displacement import Scene
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.cases.displacement.made import (
    HEIGHT,
    WIDTH,
    case_of,
    gentle,
    hills,
    looking,
    noise,
    params_with,
    quarter,
    sheared,
    smooth,
)
from ibr_ref.scene import BasePolygon, Camera, Light


def street() -> Case:
    """The volume's own interval from inside."""
    camera = looking(eye=(-0.5, -0.9, 0.2), target=(-0.52, -0.3, 0.16), vertical_fov=75.0, near=0.08, far=4.0)
    scene = Scene(polygons=[quarter()[0]], camera=camera, light=Light(direction=(1.0, -0.5, 1.0)))
    about = "The eye inside the volume above a street: faces behind it and through the near plane, rays that look up."
    params = params_with(linear_steps=12, binary_steps=1, interval="volume")
    return case_of("street", "adversarial", about, scene, params)


def planes() -> Case:
    """Clipping."""
    camera = looking(eye=(2.2, -1.5, 0.9), target=(1.2, -0.3, 0.2), near=1.3, far=2.0)
    scene = Scene(polygons=[sheared()], camera=camera, light=Light(direction=(0.3, -0.5, 1.0)))
    about = "The near and the far plane cut faces, and the near plane what stands on them."
    return case_of("planes", "adversarial", about, scene, params_with(linear_steps=16, binary_steps=0))


def low() -> Case:
    """The paper's interval from an eye inside the volume."""
    camera = looking(eye=(-0.05, -0.49, 0.13), target=(0.0, 0.3, 0.02), vertical_fov=80.0, near=0.15)
    scene = Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1.0)))
    about = "The eye below the top of the volume: rays that look up are discarded, hits behind the eye are cut away."
    return case_of("low", "adversarial", about, scene, params_with(linear_steps=10, binary_steps=1))


def crossing() -> Case:
    """The depth test."""
    upright = sheared(
        corner=(0.8, -0.9, -0.1), edge_u=(0.3, 1.2, 0.1), edge_v=(0.1, -0.05, 0.7), height_scale=0.15,
        color_map=noise(9, 13, 3, seed=7),
    )  # fmt: skip
    camera = looking(eye=(2.6, -1.4, 1.2), target=(1.2, -0.2, 0.2))
    light = Light(direction=(0.3, -0.5, 1.0))
    scene = Scene(polygons=[sheared(), upright], camera=camera, light=light, background=(0.2, 0.31, 0.11))
    about = "One volume through another: which is in front changes from pixel to pixel."
    return case_of("crossing", "adversarial", about, scene, params_with(linear_steps=16, binary_steps=4))


def borders() -> Case:
    """Pixel centres on edges."""
    camera = Camera.orthographic(
        eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), up=(0.0, 1.0, 0.0), view_height=5.25, near=0.5, far=4.0,
        width=WIDTH, height=HEIGHT,
    )  # fmt: skip
    polygon = BasePolygon(
        corner=(-0.96875, -0.46875, 0.0), edge_u=(1.0, 0.0, 0.0), edge_v=(0.0, 1.0, 0.0), height_scale=0.25,
        height_map=hills(16, 16), color_map=noise(4, 4, 3, seed=5),
    )  # fmt: skip
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.3, 0.5, 1.0)))
    about = "Straight from above, without perspective: edges and a diagonal run through pixel centres."
    return case_of("borders", "adversarial", about, scene, params_with())


def _rim() -> BasePolygon:
    """Low ground with a ridge along its far border and a bank along a side: what is high is at the very edge of the map."""
    heights = smooth((40, 48), 0.08, 0.31, 0.2)
    heights[:, -3:] = 0.83
    heights[-4:, :] = 0.57
    return sheared(height_map=heights)


def rim() -> Case:
    """Lines of sight that all but lie in the polygon's plane, and a shadow from the border."""
    camera = looking(eye=(-0.1, -0.95, 0.25), target=(1.35, -0.3, 0.2), vertical_fov=28.0)
    light = Light(direction=(1.0, 0.25, 0.4), ambient=0.23, diffuse=0.7)
    scene = Scene(polygons=[_rim()], camera=camera, light=light, background=(0.31, 0.11, 0.2))
    about = (
        "A ridge along the border of the map, seen at a grazing angle and against the sun: its shadow is of the border."
    )
    return case_of("rim", "adversarial", about, scene, params_with(linear_steps=40, binary_steps=2, shadow_steps=2))


def sliver() -> Case:
    """Clipping at the picture's border."""
    camera = looking(eye=(0.48, -2.03, 1.19), target=(1.0534, -0.42, 0.02), vertical_fov=32.0)
    scene = Scene(polygons=[gentle(height_scale=0.2)], camera=camera, light=Light(position=(1.8, 1.4, 1.5)))
    about = (
        "A corner a thirtieth of a pixel beside the picture: faces that are cut there leave a sliver, with poor planes."
    )
    params = params_with(linear_steps=16, binary_steps=4, shadow_steps=2, shadow_bias=0.02)
    return case_of("sliver", "adversarial", about, scene, params, "gl")
