"""What a system shows, in numbers: right texels, distances, drift, silhouettes, smear, fetches."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.displacement.inputs import Params, Scene
from ibr_ref.displacement.render import render
from ibr_ref.io import Frame
from ibr_ref.scene import BasePolygon
from ibr_ref.searches import SEARCHES

Mask = NDArray[np.bool_]

RAISED = 0.05
"""Height, of the volume's, from which a texel counts as raised."""
TEXELS = 2.0
"""A pixel shows the right texel if it is so near, in texels of the height map."""
SMEARED = 0.25
"""Texels from a wall's pixel to the one below it, under which they count as the same."""

EXACT = Params(method="exact", linear_steps=800)
"""The first intersection; its walls are those that are steep within a short step."""


@dataclass(frozen=True)
class Truths:
    """The first intersections with a scene's solid: rising from its polygon, and sunk below it."""

    risen: Frame
    sunken: Frame

    @classmethod
    def of(cls, scene: Scene) -> Truths:
        """Both."""
        return cls(truth(scene, sinks=False), truth(scene, sinks=True))

    def of_method(self, params: Params) -> Frame:
        """What a system would show if its search were perfect."""
        return self.sunken if SEARCHES[params.method].sinks else self.risen


def truth(scene: Scene, sinks: bool) -> Frame:
    """By `exact`, or, below the polygon, by the maximum mipmap, whose hits the tests hold against rational numbers."""
    return render(scene, Params(method="maximum_mipmap") if sinks else EXACT)


def number(value: float) -> float | None:
    """A measure; None for NaN, where there was nothing to measure."""
    return None if math.isnan(value) else value


def polygon_of(scene: Scene) -> BasePolygon:
    """The scene's only polygon."""
    (polygon,) = scene.polygons
    return polygon


def texel_steps(scene: Scene, change: Floats) -> Floats:
    """Length of a change of (u, v), in texels of the height map."""
    rows, columns = np.asarray(polygon_of(scene).height_map).shape
    away: Floats = np.hypot(change[..., 0] * columns, change[..., 1] * rows)
    return away


def heights_at(scene: Scene, frame: Frame, radius: int = 0) -> Floats:
    """The height map's texel under each pixel's hit, or the largest so many texels around; NaN where nothing is kept."""
    heights = np.asarray(polygon_of(scene).height_map, np.float64)
    around = [np.roll(heights, (i, j), (0, 1)) for i in range(-radius, radius + 1) for j in range(-radius, radius + 1)]
    return _texels(np.maximum.reduce(around), frame)


def _texels(image: Floats, frame: Frame) -> Floats:
    hit = frame.stages["march.hit"]
    rows, columns = image.shape
    kept = np.isfinite(hit[..., 0])
    uv = np.where(kept[..., None], hit[..., :2], 0.0)
    row = np.clip(np.floor(uv[..., 1] * rows), 0, rows - 1).astype(int)
    column = np.clip(np.floor(uv[..., 0] * columns), 0, columns - 1).astype(int)
    found: Floats = np.where(kept, image[row, column], np.nan)
    return found


def raised(scene: Scene, frame: Frame) -> Mask:
    """Pixels that show something raised."""
    mask: Mask = heights_at(scene, frame) > RAISED
    return mask


def world(scene: Scene, patch: Floats) -> Floats:
    """Points (..., 3) of patch space in the world."""
    polygon = polygon_of(scene)
    corner, edge_u, edge_v = polygon.arrays
    normal = np.cross(edge_u, edge_v)
    up = polygon.height_scale * normal / np.linalg.norm(normal)
    points: Floats = corner + patch[..., :1] * edge_u + patch[..., 1:2] * edge_v + patch[..., 2:] * up
    return points


def window(scene: Scene, points: Floats) -> Floats:
    """Window positions (..., 2) of world points."""
    camera = scene.camera
    clip = np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1) @ camera.clip_from_world.T
    ndc = clip[..., :2] / clip[..., 3:]
    return np.stack([(ndc[..., 0] + 1) / 2 * camera.width, (1 - ndc[..., 1]) / 2 * camera.height], axis=-1)


def right_texels(scene: Scene, truth: Frame, frame: Frame, among: Mask) -> float:
    """Share of the pixels `among` that show the texel that the truth shows there."""
    away = texel_steps(scene, frame.stages["march.hit"][..., :2] - truth.stages["march.hit"][..., :2])
    return float((away[among] <= TEXELS).mean())


def distances(scene: Scene, truth: Frame, frame: Frame) -> tuple[float, float]:
    """Median and 95 % quantile of the distance from the truth's hit, world units; of what both keep."""
    points = [world(scene, one.stages["march.hit"]) for one in (truth, frame)]
    away = np.linalg.norm(points[0] - points[1], axis=-1)
    median, most = np.nanquantile(away, (0.5, 0.95))
    return float(median), float(most)


def drift(scene: Scene, frame: Frame) -> tuple[float, float]:
    """How far pixels that show the ground are from where that ground is: mean and largest, pixels; NaN without any."""
    ground = heights_at(scene, frame, radius=2) == 0.0
    hit = frame.stages["march.hit"]
    true = window(scene, world(scene, np.concatenate([hit[..., :2], np.zeros((*ground.shape, 1))], axis=-1)))
    row, column = np.indices(ground.shape)
    away = np.hypot(true[..., 0] - (column + 0.5), true[..., 1] - (row + 0.5))[ground]
    return (float(away.mean()), float(away.max())) if len(away) else (math.nan, math.nan)


def overlap(a: Mask, b: Mask) -> float:
    """Intersection over union."""
    return float((a & b).sum() / max(1, (a | b).sum()))


def overflow(scene: Scene, truth: Frame, frame: Frame) -> float | None:
    """Of the pixels beside the polygon's outline that the truth shows: the share that is shown; None without any."""
    outline = render(replace(scene), Params(method="texture")).stages["raster.face"] >= 0
    beside = (truth.stages["march.hit_index"] >= 0) & ~outline
    return float((frame.stages["march.hit_index"] >= 0)[beside].mean()) if beside.any() else None


def walls(scene: Scene, truth: Frame) -> Mask:
    """Pixels that show a wall: where heights around differ by more than a fifth, between a wall's foot and its top."""
    heights = np.asarray(polygon_of(scene).height_map, np.float64)
    shifts = [np.roll(heights, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    steep = _texels(np.maximum.reduce(shifts) - np.minimum.reduce(shifts), truth) > 0.2
    level = truth.stages["march.hit"][..., 2] % 1.0  # below the polygon or above it
    wall: Mask = steep & (level > 0.02) & (level < heights_at(scene, truth, radius=1) - 0.02)
    return wall


def texture_coordinates(scene: Scene, frame: Frame) -> Floats:
    """Where each pixel's colour comes from, in texels: of the height map's grid, or of the facade on steep hits."""
    polygon = polygon_of(scene)
    rows, columns = np.asarray(polygon.height_map).shape
    hit = frame.stages["march.hit"]
    place: Floats = hit[..., :2] * (columns, rows)
    if polygon.facade_map is None:
        return place
    texels = np.asarray(polygon.facade_map).shape[0]
    down = hit[..., 2:] * polygon.height_scale / polygon.facade_tile[1] * texels
    facade = np.concatenate([place[..., :1], down], axis=-1)
    return np.where(frame.stages["march.steep"][..., None], facade, place)


def wall_texture(scene: Scene, frame: Frame, wall: Mask) -> tuple[float, float]:
    """Down the walls' pixels: texels passed from one to the next, median, and the share that passes next to none; or NaN."""
    place = texture_coordinates(scene, frame)
    passed = np.hypot(*np.moveaxis(place[1:] - place[:-1], -1, 0))[wall[1:] & wall[:-1]]
    passed = passed[np.isfinite(passed)]
    return (float(np.median(passed)), float((passed < SMEARED).mean())) if len(passed) else (math.nan, math.nan)


def fetches(params: Params, frame: Frame) -> float:
    """Texture fetches of the search, a fragment that is shown or discarded alone; the shader's, that skips nothing.

    NaN where no face is drawn.
    """
    stages: dict[str, Any] = frame.stages
    covered = stages["raster.face"] >= 0
    if not covered.any():
        return math.nan
    if "march.fetches" in stages:
        return float(stages["march.fetches"][covered].mean())
    if params.method == "texture":
        return 0.0
    steps, halvings = params.linear_steps, params.binary_steps
    stop = stages["march.linear_index"][covered]
    return float(np.where(stop < 0, steps + 1, stop + 1 + halvings * (stop > 0)).mean())
