"""Naive twin of the splatting of depth images (splatting/method.md): plain loops over plain floats."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .depth_image import Code, Codes, Points, atlas, decode, normal_codes, world_points
from .splat_raster import rasterize
from .splat_vertex import Placed, lit_color, place
from .vectors import Vec3, vec3


class Vertex(NamedTuple):
    """One point of stage 3."""

    placed: Placed
    color: Vec3
    source: tuple[int, int, int]


def make_vertex(scene: Any, params: Any, index: int, source: tuple[int, int, int], p: Vec3, code: Code) -> Vertex:
    """One vertex from its world position and its 8-bit normal (stage vertex)."""
    image, row, column = source
    albedo = vec3(scene.images[image].color[row, column])
    color = lit_color(albedo, decode(code), p, scene.light, scene.camera)
    return Vertex(place(scene.camera, params, p, index), color, source)


def all_vertices(scene: Any, params: Any, points: list[Points], codes: list[Codes]) -> list[Vertex]:
    """The valid pixels in order of (image, row, column) (stage vertex)."""
    vertices: list[Vertex] = []
    for image, image_points in enumerate(points):
        for row, line in enumerate(image_points):
            for column, p in enumerate(line):
                if p is None:
                    continue
                code = codes[image][row][column]
                vertices.append(make_vertex(scene, params, len(vertices), (image, row, column), p, code))
    return vertices


def vertex_stages(vertices: list[Vertex]) -> dict[str, Any]:
    """The stages "vertex.*" (stage vertex)."""
    count = len(vertices)
    window = np.zeros((count, 2), dtype=np.float64)
    depth = np.zeros(count, dtype=np.float64)
    width = np.zeros(count, dtype=np.float64)
    color = np.zeros((count, 3), dtype=np.float64)
    source = np.zeros((count, 3), dtype=np.int32)
    for i, vertex in enumerate(vertices):
        window[i, 0] = vertex.placed.x
        window[i, 1] = vertex.placed.y
        depth[i] = vertex.placed.depth
        width[i] = vertex.placed.width
        for k in range(3):
            color[i, k] = vertex.color[k]
            source[i, k] = vertex.source[k]
    return {
        "vertex.window": window,
        "vertex.depth": depth,
        "vertex.width": width,
        "vertex.color": color,
        "vertex.source": source,
    }


def resolve(vertices: list[Vertex], winner: Any, background: Vec3) -> Any:
    """Colour of the winner, background elsewhere (stage resolve)."""
    height, width = winner.shape
    color = np.zeros((height, width, 3), dtype=np.float64)
    for row in range(height):
        for column in range(width):
            splat = int(winner[row, column])
            value = background if splat < 0 else vertices[splat].color
            for channel in range(3):
                color[row, column, channel] = value[channel]
    return color


def render(scene: Any, params: Any) -> tuple[dict[str, Any], Any, Any]:
    """All stages, colour (H, W, 3) and depth (H, W) of a splatted scene (splatting/method.md)."""
    points = [world_points(image) for image in scene.images]
    codes = [normal_codes(image, image_points) for image, image_points in zip(scene.images, points, strict=True)]
    stages = atlas(scene.images, codes, int(params.max_atlas_size))
    vertices = all_vertices(scene, params, points, codes)
    stages.update(vertex_stages(vertices))
    placed = [vertex.placed for vertex in vertices]
    stages.update(rasterize(placed, str(params.shape), int(scene.camera.height), int(scene.camera.width)))
    color = resolve(vertices, stages["raster.splat"], vec3(scene.background))
    return stages, color, stages["raster.depth"].copy()
