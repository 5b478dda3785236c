"""Cases of what the method has: intervals, faces, maps, lights, and filters and rasters that devices are free in."""

from __future__ import annotations

from ibr_ref import models
from ibr_ref.displacement import Scene
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.cases.displacement.made import (
    HEIGHT,
    WIDTH,
    case_of,
    gentle,
    looking,
    noise,
    params_with,
    quarter,
    sheared,
)
from ibr_ref.scene import Camera, Light


def box() -> Case:
    """The paper's figure 6."""
    camera = looking(eye=(1.0, -1.2, 0.9), target=(0.0, 0.0, 0.0), vertical_fov=32.0)
    scene = Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, 1.0)))
    return case_of("box", "easy", "One box on the ground, the defaults, a facade on its walls.", scene, params_with())


def mapped() -> Case:
    """A normal map."""
    camera = looking(eye=(0.2, -1.9, 1.2), target=(1.3, -0.3, 0.2), vertical_fov=32.0)
    polygon = sheared(normal_map=0.5 + 0.5 * noise(7, 5, 3, seed=3), facade_map=None)
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.4, -0.5, 1.0), specular=0.3))
    about = "A normal map on the parallelogram; steps without a binary search."
    return case_of("mapped", "easy", about, scene, params_with(linear_steps=12, binary_steps=0))


def dusk() -> Case:
    """A light below the horizon."""
    camera = looking(eye=(1.0, -1.2, 0.9), target=(0.0, 0.0, 0.0), vertical_fov=32.0)
    scene = Scene(polygons=[models.box()], camera=camera, light=Light(direction=(0.5, -0.8, -0.2)))
    about = "A sun below the polygon's horizon: nothing is lit, but walls face it."
    return case_of("dusk", "easy", about, scene, params_with(binary_steps=3, shadow_steps=8))


def slope() -> Case:
    """Everything at once on a parallelogram."""
    camera = looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.2), vertical_fov=30.0)
    light = Light(position=(1.0, -1.4, 1.5), diffuse=1.3, specular=0.8, exponent=12)
    about = "A tilted parallelogram with a facade under a lamp: self-shadow, a highlight, colours beyond white."
    scene = Scene(polygons=[sheared()], camera=camera, light=light, background=(0.11, 0.31, 0.2))
    return case_of("slope", "typical", about, scene, params_with(shadow_steps=7, steep_threshold=0.15))


def city() -> Case:
    """Facades and shadows."""
    camera = looking(eye=(-0.1, -2.1, 1.21), target=(-0.5, -0.5, 0.1), vertical_fov=45.0)
    light = Light(direction=(-0.7, -0.6, 0.6), specular=0.3, exponent=31)
    scene = Scene(polygons=[quarter()[0]], camera=camera, light=light, background=(0.4, 0.51, 0.6))
    about = "A block of a city: facades, self-shadow from a low sun, a faint highlight."
    return case_of("city", "typical", about, scene, params_with(linear_steps=40, binary_steps=3, shadow_steps=16))


def extended() -> Case:
    """Section 3.2.1."""
    camera = Camera.orthographic(
        eye=(2.0, -2.98, 1.8), target=(0.0, 0.0, 0.2), view_height=2.2, near=0.1, far=10.0, width=WIDTH, height=HEIGHT
    )
    light = Light(position=(0.0, 0.0, 1.2), specular=0.4, exponent=8)
    scene = Scene(polygons=quarter(), camera=camera, light=light)
    about = "Four polygons that hide one another, without perspective, on extended bases."
    return case_of("extended", "typical", about, scene, params_with(linear_steps=25, binary_steps=2, faces="extended"))


def tiles() -> Case:
    """A tiled plane."""
    camera = looking(eye=(0.6, -1.7, 1.3), target=(1.3, -0.3, 0.1), vertical_fov=34.0)
    polygon = sheared(height_map=noise(11, 14, seed=0), normal_map=0.4 + 0.5 * noise(7, 5, 3, seed=3), domain="repeat")
    scene = Scene(polygons=[polygon], camera=camera, light=Light(direction=(0.9, 0.6, 0.5), specular=0.5))
    about = "Repeated maps on the base alone, the polygon's own depth, a normal map besides the facade, self-shadow."
    params = params_with(
        linear_steps=15, binary_steps=3, steep_threshold=0.031, faces="base", depth="polygon", shadow_steps=3
    )
    return case_of("tiles", "typical", about, scene, params)


def beside() -> Case:
    """The volume's own interval from outside."""
    camera = looking(eye=(1.6, -1.9, 0.25), target=(1.3, -0.3, 0.2), vertical_fov=36.0)
    scene = Scene(polygons=[sheared()], camera=camera, light=Light(direction=(-0.3, -0.9, 0.8)))
    about = "The ray's own stretch inside the volume, from an eye beside it and below its top: walls at the border."
    return case_of("beside", "typical", about, scene, params_with(linear_steps=20, binary_steps=4, interval="volume"))


def lamp() -> Case:
    """A lamp inside the volume."""
    camera = looking(eye=(0.8, -1.3, 1.0), target=(0.0, 0.0, 0.0), vertical_fov=36.0)
    light = Light(position=(-0.3, -0.1, 0.12), specular=0.5, exponent=9)
    scene = Scene(polygons=[models.box()], camera=camera, light=light)
    about = "A lamp inside the volume, beside the box: what is behind it throws no shadow."
    return case_of("lamp", "typical", about, scene, params_with(linear_steps=20, binary_steps=4, shadow_steps=12))


def filtered() -> Case:
    """Eight-bit weights."""
    camera = looking(eye=(2.4, -1.6, 1.3), target=(1.3, -0.35, 0.2), vertical_fov=30.0)
    scene = Scene(polygons=[gentle()], camera=camera, light=Light(direction=(0.3, -0.5, 1.0), specular=0.2, exponent=4))
    about = "Gentle maps: a texture unit with eight bits of weight may draw them, and any rounding of positions."
    return case_of("filtered", "typical", about, scene, params_with(linear_steps=16, binary_steps=4), "vulkan")


def loose() -> Case:
    """The loosest device."""
    camera = looking(eye=(0.2, -1.9, 1.2), target=(1.3, -0.3, 0.2), vertical_fov=32.0)
    scene = Scene(polygons=[gentle(height_scale=0.2)], camera=camera, light=Light(position=(1.8, 1.4, 1.5)))
    about = "Gentle maps for OpenGL as it comes: varyings over unsnapped triangles, weights of eight bits."
    return case_of(
        "loose",
        "typical",
        about,
        scene,
        params_with(linear_steps=16, binary_steps=4, shadow_steps=2, shadow_bias=0.02),
        "gl",
    )


def metropolis() -> Case:
    """A picture of real size."""
    camera = looking(eye=(2.6, -3.14, 2.02), target=(0.0, 0.0, 0.0), vertical_fov=52.0, width=640, height=480)
    light = Light(direction=(-0.6, -0.5, 0.7), specular=0.3, exponent=37)
    scene = Scene(polygons=[models.city()], camera=camera, light=light, background=(0.51, 0.71, 0.91))
    about = "The whole city at 640 x 480: facades, self-shadow, a highlight."
    params = params_with(linear_steps=40, binary_steps=1, shadow_steps=8)
    return case_of("metropolis", "real-sized", about, scene, params)
