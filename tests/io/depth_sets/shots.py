"""Pictures with depth by formula: a plane and a ball, seen by pinholes. OpenCV's axes; pixels' centres at half-integers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

WIDTH, HEIGHT = 20, 14
BALL, RADIUS = np.array([0.2, -0.1, 4.0]), 0.9
NORMAL, OFFSET = np.array([0.1, -0.2, 1.0]), 5.0
K = np.array([[22.0, 0.0, 9.3], [0.0, 23.0, 7.4], [0.0, 0.0, 1.0]])


@dataclass
class Shot:
    """What one camera sees."""

    rotation: np.ndarray
    """World from camera: its columns are right, down and forward."""
    center: np.ndarray
    k: np.ndarray
    color: np.ndarray
    """(H, W, 3) bytes."""
    depth: np.ndarray
    """(H, W) along the axis; 0 where nothing is."""
    points: np.ndarray
    """(H, W, 3) in the world."""

    @property
    def valid(self):
        return self.depth > 0

    @property
    def pose(self):
        """(4, 4) world from camera."""
        result = np.eye(4)
        result[:3, :3], result[:3, 3] = self.rotation, self.center
        return result


def turn(axis, angle):
    """Rodrigues' formula."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def shot(rotation, center, k=K, width=WIDTH, height=HEIGHT, hole=True):
    """Rays through the centres of the pixels meet the ball or the plane; every 7th pixel of the plane is a hole."""
    v, u = np.mgrid[:height, :width] + 0.5
    rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(k).T @ rotation.T
    from_ball = center - BALL
    a, b, c = (rays**2).sum(-1), 2 * rays @ from_ball, from_ball @ from_ball - RADIUS**2
    inside = b * b - 4 * a * c
    near = np.where(inside >= 0, (-b - np.sqrt(np.maximum(inside, 0))) / (2 * a), np.inf)
    plane = (OFFSET - NORMAL @ center) / (rays @ NORMAL)
    plane = np.where(plane > 0, plane, np.inf)
    if hole:
        plane[np.arange(width * height).reshape(height, width) % 7 == 3] = np.inf
    depth = np.minimum(near, plane)
    depth[~np.isfinite(depth)] = 0
    points = center + rays * depth[..., None]
    return Shot(rotation, center, k, colors(points), depth, points)


def colors(points):
    """Bytes by place in the world, so that each point is known by its colour."""
    waves = 0.5 + 0.4 * np.sin(points * (1.1, 1.3, 0.7) + (0.0, 1.0, 2.0))
    return np.floor(waves * 255 + 0.5).astype(np.uint8)


CENTERS = ((0.0, 0.0, 0.0), (0.7, -0.2, 0.3), (-0.6, 0.3, -0.4))


def shots(count=3, **options):
    """The first one is the world's own camera; the others are turned and moved."""
    turns = [np.eye(3), turn((1, 2, 0.5), -0.2), turn((-1, 1, 2), 0.3)]
    return [shot(turns[i], np.array(CENTERS[i]), **options) for i in range(count)]


def on_surface(points):
    """Distance of each point from the nearer of ball and plane."""
    ball = np.abs(np.linalg.norm(points - BALL, axis=-1) - RADIUS)
    return np.minimum(ball, np.abs(points @ NORMAL - OFFSET) / np.linalg.norm(NORMAL))
