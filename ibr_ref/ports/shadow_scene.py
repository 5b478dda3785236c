"""What the shadow ports compute once a frame, in float64: where a sample's map lies among the nine, meshes, vertices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


def place_in_cell(positions: np.ndarray, offset: np.ndarray) -> tuple[list[int], list[float]]:
    """The cell (2,) of the 3 x 3 maps that holds an offset, and its fractions in it, x first."""
    lines = positions[0, :, 0], positions[:, 0, 1]
    cell = [int(value >= line[1]) for line, value in zip(lines, offset, strict=True)]
    ends = [line[i : i + 2] for line, i in zip(lines, cell, strict=True)]
    return cell, [float((o - low) / (high - low)) for o, (low, high) in zip(offset, ends, strict=True)]


def shares_in_cell(depths: np.ndarray | None, cell: Sequence[int], fraction: Sequence[float]) -> tuple[float, ...]:
    """The shares of the next map in the upper row and in the lower one, and of the lower row.

    depths (3, 3): the caster's in the nine maps, for the projective pace; None: s, s, t.
    """
    (i, j), (s, t) = cell, fraction
    if depths is None:
        return s, s, t

    def share(f: float, w0: float, w1: float) -> float:
        return float(f * w1 / ((1.0 - f) * w0 + f * w1))

    (w00, w10), (w01, w11) = depths[j : j + 2, i : i + 2].tolist()
    return share(s, w00, w10), share(s, w01, w11), share(t, (1 - s) * w00 + s * w10, (1 - s) * w01 + s * w11)


def place_in_grid(scene: Any, count: int, offset: np.ndarray) -> tuple[list[np.ndarray], tuple[float, ...]]:
    """Of n x n maps the four around an offset: the object's offsets in them (00, 10, 01, 11), and the fractions s and t."""
    widening = np.abs([sample.displacement for sample in scene.light_samples]).max(axis=0)
    ends = np.asarray(scene.offset_range, float)
    low, high = ends[:, 0] - widening, ends[:, 1] + widening
    place = (np.asarray(offset, float) - low) / (high - low) * (count - 1)
    cell = np.clip(np.floor(place), 0, count - 2)

    def position(steps: tuple[int, int]) -> np.ndarray:
        share = (cell + steps) / (count - 1)
        return np.asarray(low * (1.0 - share) + high * share)

    return [position(steps) for steps in ((0, 0), (1, 0), (0, 1), (1, 1))], tuple((place - cell).tolist())


def offset_in_world(scene: Any, offset: np.ndarray) -> tuple[float, ...]:
    """x a + y b."""
    return tuple((np.asarray(offset, float) @ np.asarray(scene.offset_axes, float)).tolist())


def vertices(scene: Any) -> np.ndarray:
    """(3 T, 10) float32: position, flat normal, colour, 1 on the caster; receivers in order, then the caster."""
    parts = []
    for mesh, caster in [*((receiver, 0.0) for receiver in scene.receivers), (scene.caster, 1.0)]:
        triangles, color = np.asarray(mesh.triangles), np.asarray(mesh.color, float)
        corners = np.asarray(mesh.vertices, float)[triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
        colors = color[triangles] if color.ndim == 2 else np.broadcast_to(color, corners.shape)
        normals = np.broadcast_to(normal[:, None], corners.shape)
        kind = np.full((*corners.shape[:2], 1), caster)
        parts.append(np.concatenate([corners, normals, colors, kind], axis=2).reshape(-1, 10))
    return np.concatenate(parts).astype(np.float32)


def mesh_indices(rows: int, columns: int) -> np.ndarray:
    """Cells row by row, each (r, c), (r, c+1), (r+1, c+1) and (r, c), (r+1, c+1), (r+1, c)."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1, 1)
    return np.asarray(corner + np.array([0, 1, columns + 1, 0, columns + 1, columns]), np.uint32)
