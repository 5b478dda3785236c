"""Figure 14: the threshold of steep walls, too small and right."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ibr_ref import models
from ibr_ref.displacement import Params, Scene, render
from ibr_ref.displacement.measures import heights_at
from ibr_ref.io import Frame
from ibr_ref.reproduce.displacement.scenes import SKY, looking_at
from ibr_ref.reproduce.displacement.sheets import write_sheet
from ibr_ref.reproduce.findings import Cell, Claim, Found, Table, Within
from ibr_ref.scene import BasePolygon

NOISE = 0.01
"""Largest error of the heights, of the volume's."""
THRESHOLDS = (0.0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
SMALL, RIGHT = 0.005, 0.1


def _scenes(size: tuple[int, int]) -> dict[str, Scene]:
    """Two views of the city with small errors in its heights, as a measured city has them."""
    city = models.city()
    heights = np.asarray(city.height_map)
    errors = np.random.RandomState(0).uniform(-NOISE, NOISE, heights.shape)
    rough = replace(city, height_map=np.where(heights > 0.05, np.clip(heights + errors, 0.0, 1.0), heights))
    return {
        "towers": looking_at(rough, (1.15, -1.75, 0.85), target=(0.55, -0.85, 0.1), size=size, background=SKY),
        "from above": looking_at(rough, (0.75, -0.85, 1.3), target=(0.65, -0.6, 0.0), size=size, background=SKY),
    }


def _wrong(scene: Scene, frame: Frame) -> tuple[float, float]:
    """Of the roofs' pixels (flat within 0.05 all around, and hit there) the share called steep; of the walls', flat."""
    top, hit = heights_at(scene, frame, radius=2), frame.stages["march.hit"][..., 2]
    flat = -heights_at(replace(scene, polygons=[_negated(scene)]), frame, radius=2) + 1.0
    roof = (top > 0.1) & (top - flat < 0.05)
    wall = (top - flat > 0.4) & (hit < top - 0.15) & (hit > flat + 0.15)
    steep = frame.stages["march.steep"]
    return float(steep[roof].mean()), float((~steep)[wall].mean())


def _negated(scene: Scene) -> BasePolygon:
    (polygon,) = scene.polygons
    return replace(polygon, height_map=1.0 - np.asarray(polygon.height_map))


def run(folder: Path, within: Within, size: tuple[int, int] = (640, 480)) -> Found:
    """Pictures with both thresholds, and how many pixels each gets wrong."""
    pictures, rows, shares = [], [], {}
    scenes = _scenes(size)
    for i, (name, scene) in enumerate(scenes.items()):
        for j, threshold in enumerate(THRESHOLDS):
            within(f"{name}: threshold {threshold}", i * len(THRESHOLDS) + j, len(scenes) * len(THRESHOLDS))
            frame = render(scene, Params(linear_steps=50, steep_threshold=threshold))
            shares[name, threshold] = _wrong(scene, frame)
            row: tuple[Cell, ...] = (name, threshold, *shares[name, threshold])
            rows.append(row)
            if threshold in (SMALL, RIGHT):
                pictures.append((f"{name}: threshold {threshold}", frame.color))
    figure = write_sheet(
        folder, "figure_14", pictures, columns=2, title="Figure 14: walls detected on roofs",
        caption=f"The city with errors of up to {NOISE} in its heights, 50 + 6 steps.",
        published="too small a threshold mixes the facade's pixels into the roofs (a, c), a larger one does not (b, d).",
    )  # fmt: skip
    table = Table(
        title="Figure 14 in numbers", columns=("view", "threshold", "roofs called steep", "walls called flat"),
        rows=tuple(rows), how="Of the pixels that show roofs (walls), away from edges: the share with the facade (without).",
    )  # fmt: skip
    small, right = shares["towers", SMALL], shares["towers", RIGHT]
    claim = Claim(
        claim="Too small a threshold puts facades on roofs, the more the rougher the heights; a larger one cures it.",
        published="figure 14",
        measured=f"roofs called steep {small[0]:.1%} at {SMALL}, {right[0]:.2%} at {RIGHT}; walls called flat "
        f"{small[1]:.1%} and {right[1]:.1%}",
        holds=small[0] > 0.05 and right[0] < 0.2 * small[0],
        why="What is left are strips along the roofs' near edges: there the sample before lay beside the building.",
    )
    return Found(figures=(figure,), tables=(table,), claims=(claim,))
