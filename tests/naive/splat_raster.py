"""splatting/method.md, "Stage raster": square and disc splats of constant depth through the depth test."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .splat_vertex import Placed


class Pixel(NamedTuple):
    """What stage 4 records of one pixel."""

    splat: int
    depth: float
    overdraw: int
    margin: float


def snap(value: float) -> float:
    """To the nearest 1/256 pixel, ties to even (conventions.md, "Points")."""
    scaled = 256.0 * value
    if math.isinf(scaled):
        return scaled
    return float(round(scaled)) / 256.0


def covered_span(center: float, width: float, size: int) -> list[int]:
    """Pixels of one axis whose centres lie in [c - w/2, c + w/2) (conventions.md, "Points")."""
    low = center - width / 2.0
    high = center + width / 2.0
    if not (low < size and high > 0.0):
        return []
    first = math.floor(max(low, 0.0))
    last = math.ceil(min(high, float(size)))
    return [i for i in range(first, min(last + 1, size)) if low <= i + 0.5 < high]


def in_disc(column: int, row: int, c_x: float, c_y: float, width: float) -> bool:
    """dx^2 + dy^2 <= w^2/4 (stage raster, "Discs")."""
    dx = (column + 0.5) - c_x
    dy = (row + 0.5) - c_y
    return dx * dx + dy * dy <= width * width / 4.0


def covered_pixels(splat: Placed, shape: str, height: int, width: int) -> list[tuple[int, int]]:
    """(row, column) of all pixels that a splat covers; none for a dropped point (stage raster)."""
    if math.isnan(splat.depth):
        return []
    c_x, c_y = snap(splat.x), snap(splat.y)
    columns = covered_span(c_x, splat.width, width)
    pixels: list[tuple[int, int]] = []
    for row in covered_span(c_y, splat.width, height):
        for column in columns:
            if shape == "square" or in_disc(column, row, c_x, c_y, splat.width):
                pixels.append((row, column))
    return pixels


def decide(candidates: list[tuple[int, float]]) -> Pixel:
    """Winner, depth, overdraw and margin from the (vertex, depth) of the covering splats, in order (stage raster)."""
    winner, nearest = -1, 1.0
    for vertex, depth in candidates:
        if depth < nearest:
            winner, nearest = vertex, depth
    margin = math.inf
    if len(candidates) >= 2:
        ordered = sorted(depth for _, depth in candidates)
        margin = ordered[1] - ordered[0]
    return Pixel(winner, nearest, len(candidates), margin)


def rasterize(splats: list[Placed], shape: str, height: int, width: int) -> dict[str, Any]:
    """The stages "raster.*" (stage raster)."""
    if shape not in ("square", "disc"):
        raise ValueError(f"params.shape: {shape!r} is neither 'square' nor 'disc'")
    covering: list[list[list[tuple[int, float]]]] = [[[] for _ in range(width)] for _ in range(height)]
    for vertex, splat in enumerate(splats):
        for row, column in covered_pixels(splat, shape, height, width):
            covering[row][column].append((vertex, splat.depth))
    winner = np.full((height, width), -1, dtype=np.int32)
    depth = np.ones((height, width), dtype=np.float64)
    overdraw = np.zeros((height, width), dtype=np.int32)
    margin = np.full((height, width), math.inf, dtype=np.float64)
    for row in range(height):
        for column in range(width):
            pixel = decide(covering[row][column])
            winner[row, column] = pixel.splat
            depth[row, column] = pixel.depth
            overdraw[row, column] = pixel.overdraw
            margin[row, column] = pixel.margin
    return {"raster.splat": winner, "raster.depth": depth, "raster.overdraw": overdraw, "raster.margin": margin}
