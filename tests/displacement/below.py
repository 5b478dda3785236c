"""The compared systems, for comparison in plain Python: the view ray below a polygon, in world vectors, and its samples."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref import BasePolygon, Camera
from ibr_ref.io import Frame
from tests.displacement.scenes import Array, camera, frame, noise, parallel_camera, square
from tests.pipeline.texels import bilinear

VIEWS = {
    "perspective": camera(eye=(1.1, -0.6, 0.9), target=(0.5, 0.45, -0.05), vertical_fov=40.0),
    "orthographic": parallel_camera(eye=(-0.6, 1.4, 0.9), target=(0.5, 0.5, 0.0)),
    "grazing": camera(eye=(1.5, -0.8, 0.45), target=(0.5, 0.45, -0.05), vertical_fov=36.0),
}

TILTED: dict[str, Any] = {
    "corner": (0.05, -0.1, 0.02),
    "edge_u": (0.9, 0.1, 0.1),
    "edge_v": (0.2, 1.0, -0.1),
    "height_scale": 0.12,
}
"""A parallelogram whose edges are not at right angles."""


def polygons() -> dict[str, BasePolygon]:
    """A map that ends at its border, one that repeats, and one on a sheared polygon."""
    heights = noise(13, 9)
    return {
        "clip": square(heights),
        "repeat": square(heights, domain="repeat"),
        "sheared": square(heights, **TILTED),
    }


class Below(NamedTuple):
    """One pixel's view ray below the polygon."""

    c: Array
    """(2,) its point on the polygon."""
    slope: Array
    """(2,) what (u, v) loses for each unit of depth."""
    to_eye: Array
    """(3,) unit vector to the eye, world."""
    normal: Array
    """(3,)."""

    def at(self, d: float) -> Array:
        return self.c - self.slope * d

    @property
    def cosine(self) -> float:
        return float(self.to_eye @ self.normal)


def world_axes(polygon: BasePolygon) -> tuple[Array, Array, Array, Array]:
    """Corner, U, V and the unit normal."""
    corner, edge_u, edge_v = polygon.arrays
    normal = np.cross(edge_u, edge_v)
    return corner, edge_u, edge_v, normal / np.linalg.norm(normal)


def view_rays(polygon: BasePolygon, view: Camera, result: Frame) -> dict[tuple[int, int], Below]:
    """By pixel, where the polygon covers it; all in world vectors."""
    corner, edge_u, edge_v, normal = world_axes(polygon)
    edges = np.array([edge_u, edge_v, normal]).T
    rays = {}
    for row, column in np.argwhere(result.stages["raster.face"] == 0).tolist():
        c = result.stages["raster.patch"][row, column]
        assert c[2] == 0.0
        to_eye = view.eye[:3] - view.eye[3] * (corner + c[0] * edge_u + c[1] * edge_v)
        to_eye = to_eye / np.linalg.norm(to_eye)
        along = np.linalg.solve(edges, to_eye)  # u, v and world height
        rays[row, column] = Below(c[:2], along[:2] / along[2] * polygon.height_scale, to_eye, normal)
    return rays


class Map:
    """A height map that ends at its border, or repeats."""

    def __init__(self, polygon: BasePolygon) -> None:
        self.heights: NDArray[np.float64] = np.asarray(polygon.height_map)
        self.repeat = polygon.domain == "repeat"

    def height(self, p: Array) -> float:
        return bilinear(self.heights, float(p[0]), float(p[1]), self.repeat)

    def there(self, p: Array) -> bool:
        return self.repeat or bool(((p >= 0) & (p <= 1)).all())


Expected = tuple[Array, float] | None
"""(u, v) and depth of a hit; None: discarded."""


def check(result: Frame, expected: dict[tuple[int, int], Expected], *, least: int, atol: float = 1e-9) -> None:
    """The hits of all pixels, without those whose decisions a rounding error can turn; at least so many are kept."""
    stages, kept = result.stages, 0
    for pixel, hit in expected.items():
        if min(stages["march.margin"][pixel], stages["march.domain_margin"][pixel]) < 1e-9:
            continue
        found = stages["march.hit"][pixel]
        if hit is None:
            assert stages["march.hit_index"][pixel] == -1, f"pixel {pixel}: found {found}, expected none"
        else:
            kept += 1
            wanted = np.array([*hit[0], -hit[1]])
            assert np.abs(found - wanted).max() <= atol, f"pixel {pixel}: found {found}, expected {wanted}"
    assert kept >= least


def compared(
    polygon: BasePolygon, view: Camera, method: str, **params: Any
) -> tuple[Frame, dict[tuple[int, int], Below]]:
    """A frame by one of the systems, and its view rays."""
    result = frame(polygon, view, method=method, **params)
    return result, view_rays(polygon, view, result)
