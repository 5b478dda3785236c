"""shadows/method.md, "Stage maps": the shadow maps of the caster alone, where they are made and how they are drawn."""

from __future__ import annotations

from typing import Any

import numpy as np

from .raster import Vertex, lerp, triangle_fragments
from .shadow_light import LightCamera, Pair, Sample, camera_at, on_axes, transform
from .vectors import Vec3, vec3

Line = tuple[float, float, float]


# --- Positions -------------------------------------------------------------------------------------------------------


def widened_range(scene: Any, samples: list[Sample], axis: int) -> Pair:
    """The offset range of one axis, widened at both ends by the largest displacement of the samples on it."""
    low, high = float(scene.offset_range[axis][0]), float(scene.offset_range[axis][1])
    widening = max(abs(sample.displacement[axis]) for sample in samples)
    return low - widening, high + widening


def line_of_positions(low: float, high: float, light: float) -> Line:
    """The ends and, between them, the light's own coordinate, or where that falls on an end, the middle."""
    between = min(max(light, low), high)
    if between in (low, high):
        between = (low + high) / 2.0
    return low, between, high


def lines_of_positions(scene: Any, samples: list[Sample]) -> tuple[Line, Line]:
    """The three x and the three y of the nine maps."""
    light = on_axes(vec3(scene.light.position), scene.offset_axes)
    x = line_of_positions(*widened_range(scene, samples, 0), light[0])
    y = line_of_positions(*widened_range(scene, samples, 1), light[1])
    return x, y


def map_positions(scene: Any, samples: list[Sample]) -> np.ndarray:
    """The stage "maps.positions" (3, 3, 2): [j, i] = (x_i, y_j)."""
    xs, ys = lines_of_positions(scene, samples)
    positions = np.empty((3, 3, 2))
    for j, y in enumerate(ys):
        for i, x in enumerate(xs):
            positions[j, i] = x, y
    return positions


# --- Caster ----------------------------------------------------------------------------------------------------------


def placed_vertices(scene: Any, offset: Pair) -> list[Vec3]:
    """The caster's vertices in world space: (v + x a) + y b, per component."""
    a, b = vec3(scene.offset_axes[0]), vec3(scene.offset_axes[1])
    x, y = offset
    placed = []
    for vertex in scene.caster.vertices:
        v = vec3(vertex)
        placed.append(
            (
                (v[0] + x * a[0]) + y * b[0],
                (v[1] + x * a[1]) + y * b[1],
                (v[2] + x * a[2]) + y * b[2],
            )
        )
    return placed


def clip_vertices(vertices: list[Vec3], camera: LightCamera) -> list[Vertex]:
    """World to view to clip, two transforms one after another (conventions.md, "Triangles")."""
    clips: list[Vertex] = []
    for x, y, z in vertices:
        view = transform(camera.view_from_world, (x, y, z, 1.0))
        clips.append(list(transform(camera.clip_from_view, view)))
    return clips


# --- Maps ------------------------------------------------------------------------------------------------------------


def depth_map(clips: list[Vertex], triangles: Any, size: int) -> np.ndarray:
    """Window depth (size, size) of the nearest fragment, 1 where empty: LESS against a buffer cleared to 1."""
    image = np.ones((size, size))
    for i, j, k in triangles:
        for column, row, depth, _ in triangle_fragments(clips[i], clips[j], clips[k], size, size):
            if depth < image[row, column]:
                image[row, column] = depth
    return image


def mask_map(clips: list[Vertex], triangles: Any, size: int, samples: int) -> np.ndarray:
    """The share of samples x samples centres a texel that any triangle covers, drawn at samples times the size."""
    fine = samples * size
    covered = np.zeros((fine, fine), dtype=np.bool_)
    for i, j, k in triangles:
        for column, row, _, _ in triangle_fragments(clips[i], clips[j], clips[k], fine, fine):
            covered[row, column] = True
    image = np.empty((size, size))
    for row in range(size):
        for column in range(size):
            block = covered[row * samples : (row + 1) * samples, column * samples : (column + 1) * samples]
            image[row, column] = float(np.count_nonzero(block)) / float(samples * samples)
    return image


def rendered_map(scene: Any, params: Any, offset: Pair, light_position: Vec3) -> np.ndarray:
    """One map (S, S): the caster at an offset, seen by the light from one position. Row 0 on top."""
    camera = camera_at(scene.light, light_position)
    clips = clip_vertices(placed_vertices(scene, offset), camera)
    triangles = [(int(t[0]), int(t[1]), int(t[2])) for t in scene.caster.triangles]
    if params.content == "depth":
        return depth_map(clips, triangles, int(params.map_size))
    if params.content != "mask":
        raise ValueError(f"content: {params.content!r} is neither 'mask' nor 'depth'")
    return mask_map(clips, triangles, int(params.map_size), int(params.map_samples))


def prepared_maps(scene: Any, params: Any, positions: np.ndarray) -> np.ndarray:
    """The stage "maps.image" (3, 3, S, S): all seen from the light's centre."""
    size = int(params.map_size)
    centre = vec3(scene.light.position)
    images = np.empty((3, 3, size, size))
    for j in range(3):
        for i in range(3):
            offset = float(positions[j, i, 0]), float(positions[j, i, 1])
            images[j, i] = rendered_map(scene, params, offset, centre)
    return images


# --- The grid of maps that the paper compares with ---------------------------------------------------------------------


def grid_cell(value: float, low: float, high: float, count: int) -> tuple[int, float]:
    """(index of the map below, fraction towards the next) on one axis of `count` evenly spaced maps."""
    place = (value - low) / (high - low) * (count - 1)
    index = min(max(int(place), 0), count - 2)
    return index, place - index


def grid_position(index: int, low: float, high: float, count: int) -> float:
    """The offset of a map of the grid on one axis."""
    return lerp(low, high, index / (count - 1))


def grid_map(scene: Any, params: Any, samples: list[Sample], offset: Pair, count: int, mix: bool) -> np.ndarray:
    """Lee & Ihm: the nearest of count x count maps, or the mix of the four around (section 2.3); made on demand."""
    low_x, high_x = widened_range(scene, samples, 0)
    low_y, high_y = widened_range(scene, samples, 1)
    i, s = grid_cell(offset[0], low_x, high_x, count)
    j, t = grid_cell(offset[1], low_y, high_y, count)
    centre = vec3(scene.light.position)

    def made(at_j: int, at_i: int) -> np.ndarray:
        place = grid_position(at_i, low_x, high_x, count), grid_position(at_j, low_y, high_y, count)
        return rendered_map(scene, params, place, centre)

    if not mix:
        return made(j if t < 0.5 else j + 1, i if s < 0.5 else i + 1)
    image = np.empty((int(params.map_size), int(params.map_size)))
    four = made(j, i), made(j, i + 1), made(j + 1, i), made(j + 1, i + 1)
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            m00, m10, m01, m11 = (float(m[row, column]) for m in four)
            image[row, column] = lerp(lerp(m00, m10, s), lerp(m01, m11, s), t)
    return image
