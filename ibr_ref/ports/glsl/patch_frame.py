"""What the displacement port computes once a polygon, in float64: its patch space, which faces are drawn, the uniforms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

FACES = np.array(
    [
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
        [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)],
        [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)],
        [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
        [(0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)],
        [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    ],
    dtype=np.float32,
)
"""Corners a, b, c, d of the base, the four side faces and the top in patch space; the index is the face number."""


@dataclass
class PatchFrame:
    """A polygon with the camera and the light in its patch space, float64."""

    polygon: Any
    scene: Any
    normal: np.ndarray
    rows: np.ndarray
    eye: np.ndarray
    light: np.ndarray
    light_world: np.ndarray

    @classmethod
    def of(cls, polygon: Any, scene: Any) -> PatchFrame:
        """Transform the homogeneous eye and light by the reciprocal basis of (U, V, s n)."""
        u, v = np.asarray(polygon.edge_u, float), np.asarray(polygon.edge_v, float)
        normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        rise = polygon.height_scale * normal
        det = u @ np.cross(v, rise)
        rows = np.stack([np.cross(v, rise), np.cross(rise, u), np.cross(u, v)]) / det
        if scene.light.position is not None:
            light_world = np.append(np.asarray(scene.light.position, float), 1.0)
        else:
            direction = np.asarray(scene.light.direction, float)
            light_world = np.append(direction / np.linalg.norm(direction), 0.0)

        def into_patch(point: np.ndarray) -> np.ndarray:
            return np.append(rows @ (point[:3] - point[3] * np.asarray(polygon.corner, float)), point[3])

        eye = into_patch(np.asarray(scene.camera.eye, float))
        return cls(polygon, scene, normal, rows, eye, into_patch(light_world), light_world)

    def faces(self, drawn: str, interval: str) -> np.ndarray:
        """(F, 4) patch positions and numbers of the corners of the faces that turn away from the eye."""
        u, v, h, w = self.eye
        turned = [h > 0, u > 0, u < w, v > 0, v < w, interval == "volume" and h < w]
        numbers = [number for number, away in enumerate(turned) if away]
        if drawn != "auxiliary":
            numbers = [0] if drawn == "extended" or turned[0] else []
        faces = np.zeros((len(numbers), 4), dtype=[("patch", np.float32, 3), ("face", np.int32)])
        faces["patch"] = self._extended() if drawn == "extended" else FACES[numbers]
        faces["face"] = np.asarray(numbers, np.int32)[:, None]
        return faces

    def _extended(self) -> np.ndarray:
        """(1, 4, 3) corners of the rectangle of the base's plane that covers all of the volume, as the eye sees it."""
        corners = FACES[5].astype(float)
        towards = self.eye[:3] - self.eye[3] * corners
        shadows = corners[:, :2] - towards[:, :2] / towards[:, 2:]
        (u0, v0), (u1, v1) = np.minimum(shadows.min(axis=0), 0.0), np.maximum(shadows.max(axis=0), 1.0)
        return np.array([[(u0, v0, 0.0), (u1, v0, 0.0), (u1, v1, 0.0), (u0, v1, 0.0)]])

    def uniforms(self, number: int) -> bytes:
        """The std140 block `Polygon` of both shaders."""
        polygon, camera, light = self.polygon, self.scene.camera, self.scene.light
        u, v = np.asarray(polygon.edge_u, float), np.asarray(polygon.edge_v, float)
        rise = polygon.height_scale * self.normal
        world_from_patch = np.eye(4)
        world_from_patch[:3] = np.stack([u, v, rise, np.asarray(polygon.corner, float)], axis=1)
        clip_from_patch = camera.clip_from_view @ camera.view_from_world @ world_from_patch
        matrices = [camera.clip_from_view, camera.view_from_world, clip_from_patch]
        vectors = [polygon.corner, u, v, rise, self.rows[0], self.rows[1], self.normal, self.eye, self.light]
        vectors += [camera.eye, self.light_world, (light.ambient, light.diffuse, light.specular)]
        vectors += [self.scene.background, (np.linalg.norm(u), np.linalg.norm(v), *polygon.facade_tile)]
        vectors += [(polygon.height_scale,)]
        columns = [np.asarray(matrix, np.float32).T.ravel() for matrix in matrices]
        padded = [np.pad(np.asarray(vector, np.float32), (0, 4 - len(vector))) for vector in vectors]
        return np.concatenate(columns + padded).tobytes() + np.array([number, 0, 0, 0], np.int32).tobytes()
