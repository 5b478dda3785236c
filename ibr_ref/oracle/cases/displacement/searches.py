"""Cases of the searches that the method is compared with, one of each."""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement import Scene
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.cases.displacement.made import case_of, looking, noise, params_with, rolling, sheared, smooth
from ibr_ref.scene import Light


def relief() -> Case:
    """Policarpo et al. 2005."""
    camera = looking(eye=(2.4, -1.6, 1.3), target=(1.25, -0.3, -0.05), vertical_fov=36.0)
    light = Light(position=(1.0, -1.4, 1.5), diffuse=1.2, specular=0.6, exponent=11)
    scene = Scene(polygons=[sheared(height_map=rolling())], camera=camera, light=light, background=(0.11, 0.31, 0.2))
    about = "Relief mapping: steep hills sunk below a tilted parallelogram, a binary search, self-shadow under a lamp."
    return case_of(
        "relief", "typical", about, scene, params_with(method="relief", linear_steps=24, binary_steps=4, shadow_steps=5)
    )


def parallax() -> Case:
    """Welsh 2004."""
    camera = looking(eye=(0.2, -1.9, 1.2), target=(1.2, -0.35, 0.1), vertical_fov=42.0)
    polygon = sheared(height_map=noise(9, 12, seed=4), normal_map=0.4 + 0.5 * noise(7, 5, 3, seed=3), domain="repeat")
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.4, -0.5, 1.0), specular=0.4, exponent=6))
    about = "Parallax mapping with offset limiting: a normal map and repeated heights, one step along the polygon."
    return case_of("parallax", "easy", about, scene, params_with(method="welsh"))


def steep() -> Case:
    """McGuire & McGuire 2005."""
    camera = looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.0), vertical_fov=30.0)
    scene = Scene(polygons=[sheared()], camera=camera, light=Light(direction=(0.3, -0.5, 1.0)))
    about = "Steep parallax mapping: a wall, a block and a needle in equal steps, more of them at a grazing angle."
    return case_of("steep", "typical", about, scene, params_with(method="mcguire", linear_steps=20, lod_bias=0.0))


def occlusion() -> Case:
    """Tatarchuk 2005."""
    camera = looking(eye=(0.6, -1.7, 1.3), target=(1.2, -0.35, 0.0), vertical_fov=48.0)
    scene = Scene(
        polygons=[sheared(height_map=rolling())], camera=camera, light=Light(direction=(0.9, 0.6, 0.8), specular=0.3)
    )
    about = "Parallax occlusion mapping: steps by the angle of view, a secant between the last two, self-shadow."
    params = params_with(method="tatarchuk", min_steps=8, max_steps=32, shadow_steps=4, shadow_bias=0.01)
    return case_of("occlusion", "typical", about, scene, params)


def cone() -> Case:
    """Dummer 2006."""
    camera = looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.1), vertical_fov=30.0)
    scene = Scene(
        polygons=[sheared(height_map=rolling())],
        camera=camera,
        light=Light(direction=(0.3, -0.5, 1.0), specular=0.2, exponent=4),
    )
    about = "Cone step mapping over smooth hills: each step as far as the cone over the texel is empty."
    return case_of("cone", "typical", about, scene, params_with(method="cone", linear_steps=12))


def relaxed() -> Case:
    """Policarpo & Oliveira 2007."""
    camera = looking(eye=(0.2, -1.9, 1.2), target=(1.2, -0.4, 0.1), vertical_fov=44.0)
    scene = Scene(polygons=[sheared(height_map=rolling())], camera=camera, light=Light(position=(1.8, 1.4, 1.5)))
    about = "Relaxed cones over smooth hills: steps that end below the surface, then halvings of the whole way."
    return case_of(
        "relaxed", "typical", about, scene, params_with(method="relaxed_cone", linear_steps=8, binary_steps=6)
    )


def distance() -> Case:
    """Donnelly 2005."""
    camera = looking(eye=(0.2, -1.9, 1.2), target=(1.2, -0.4, 0.1), vertical_fov=44.0)
    scene = Scene(
        polygons=[sheared(height_map=rolling())], camera=camera, light=Light(direction=(0.5, -0.4, 1.0), specular=0.3)
    )
    about = "Sphere tracing in a distance map of three dimensions, over smooth hills: steps as far as a ball is empty."
    return case_of(
        "distance", "typical", about, scene, params_with(method="donnelly", linear_steps=8, distance_layers=12)
    )


def quadtree() -> Case:
    """Drobot 2009."""
    camera = looking(eye=(2.3, -1.5, 1.8), target=(1.3, -0.35, 0.0), vertical_fov=30.0, width=64, height=48)
    heights = smooth((9, 13), 0.45, 0.6, 0.1) + 0.15 * (np.arange(13) + 0.5) / 13
    colors = np.stack([smooth((5, 7), 0.5, 0.7, phase) for phase in (0.1, 0.4, 0.7)], axis=-1)
    polygon = sheared(height_map=heights, color_map=colors)
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.3, -0.5, 1.0)))
    about = (
        "A quadtree of maxima over few texels, highest where its levels have odd sizes: the first intersection with the "
        "bilinear surface itself, on a slope so gentle that filters with weights of 8 bits are judged too."
    )
    return case_of("quadtree", "typical", about, scene, params_with(method="maximum_mipmap"))
