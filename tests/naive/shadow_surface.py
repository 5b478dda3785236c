"""shadows/method.md, "The surface": what the camera sees, the receivers and the caster through the depth test."""

from __future__ import annotations

from typing import Any, NamedTuple

from .patch import Camera
from .raster import Vertex, triangle_fragments
from .shadow_light import Pair
from .shadow_maps import placed_vertices
from .vectors import Vec3, Vec4, cross, dot, negate, normalize, sub, towards, vec3


class Fragment(NamedTuple):
    """The visible fragment of a pixel. `normal` is the triangle's, of either side; `caster`: one of the caster's own."""

    depth: float
    world: Vec3
    color: Vec3
    normal: Vec3
    caster: bool


Surface = list[list[Fragment | None]]
"""Rows of pixels, None where no surface is."""


def vertex_colors(mesh: Any) -> list[Vec3] | None:
    """(V, 3) colours; None where the mesh has one for all."""
    if len(mesh.color) == 3 and not hasattr(mesh.color[0], "__len__"):
        return None
    return [vec3(color) for color in mesh.color]


def draw_mesh(surface: Surface, mesh: Any, vertices: list[Vec3], camera: Camera, caster: bool) -> None:
    """Draw the triangles in order, depth test LESS against what is there, or 1."""
    colors = vertex_colors(mesh)
    corners: list[Vertex] = []
    for index, p in enumerate(vertices):
        color = vec3(mesh.color) if colors is None else colors[index]
        corners.append([*camera.clip_position(p), *p, *color])
    for triangle in mesh.triangles:
        i, j, k = (int(index) for index in triangle)
        normal = normalize(cross(sub(vertices[j], vertices[i]), sub(vertices[k], vertices[i])))
        fragments = triangle_fragments(corners[i], corners[j], corners[k], camera.width, camera.height)
        for column, row, depth, values in fragments:
            before = surface[row][column]
            if depth < (1.0 if before is None else before.depth):
                color = vec3(mesh.color) if colors is None else vec3(values[3:])
                surface[row][column] = Fragment(depth, vec3(values), color, normal, caster)


def visible_surface(scene: Any) -> Surface:
    """The receivers in order, then the caster at the scene's offset ("Inputs")."""
    camera = Camera(scene.camera)
    surface: Surface = [[None] * camera.width for _ in range(camera.height)]
    for mesh in scene.receivers:
        draw_mesh(surface, mesh, [vec3(v) for v in mesh.vertices], camera, caster=False)
    offset: Pair = float(scene.offset[0]), float(scene.offset[1])
    draw_mesh(surface, scene.caster, placed_vertices(scene, offset), camera, caster=True)
    return surface


def resolved_color(fragment: Fragment, shadow: float, scene: Any, eye: Vec4) -> Vec3:
    """surface (ambient + (1 - ambient) (1 - shadow) max(0, n.l)), n turned to the eye (stage resolve)."""
    normal = fragment.normal
    if dot(normal, towards(eye, fragment.world)) < 0.0:
        normal = negate(normal)
    to_light = normalize(sub(vec3(scene.light.position), fragment.world))
    ambient = float(scene.ambient)
    brightness = ambient + ((1.0 - ambient) * (1.0 - shadow)) * max(0.0, dot(normal, to_light))
    r, g, b = fragment.color
    return r * brightness, g * brightness, b * brightness
