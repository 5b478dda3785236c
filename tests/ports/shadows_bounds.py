"""What the shadow port may differ by: bounds per texel and per pixel, carried from the maps to the colour.

A driver may cover with snapped positions and interpolate with unsnapped ones, or snap a float32 position to the other side.
Either way what it interpolates at a pixel is what the exact triangle has within `shift` of that pixel's centre: a convex
combination of the corners' moves. SNAPPED is the most that is; where all corners lie on the raster of 1/256, only float32 is
left. Interpolation itself has no accuracy in OpenGL's specification: planes a0 + a_x x + a_y y in float32 are assumed.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np

from tests.ports.rounding import LOOSE, UNIT, Rounded, dot
from tests.ports.shadow_maps import mesh_indices, place_in_cell

SNAPPED = 1.0 / 256.0
PLANE_ROUNDINGS = 16
"""Of every term of a plane: differences, products, 1 / area (LOOSE), a0, and its evaluation."""
NOT_ON_AN_EDGE = 1.0 / 64.0
"""Pixel: farther from every edge, coverage is certain."""
DEPTH_GAP = 1e-4
"""Between two surfaces of which the nearer one is certain."""

Array = np.ndarray


@dataclass(frozen=True)
class Corners:
    """Triangles' corners on a picture: (T, 3) x and y in pixels."""

    x: Array
    y: Array

    @classmethod
    def snapped(cls, x: Array, y: Array) -> Corners:
        """On the raster of 1/256 pixel, as the reference has them."""
        return cls(np.rint(256.0 * x) / 256.0, np.rint(256.0 * y) / 256.0)

    @property
    def area(self) -> Array:
        """(T,) twice the signed area."""
        x, y = self.x, self.y
        return (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])

    def barycentrics(self, triangle: int | Array, px: Array, py: Array) -> Array:
        """(3, ...) at the points, for one triangle or one a point; their sum is 1."""
        x, y = self.x[triangle].T, self.y[triangle].T
        if np.ndim(triangle) == 0:
            x, y = (each.reshape(3, *(1,) * np.ndim(px)) for each in (x, y))
        edges = [
            (x[(i + 2) % 3] - x[(i + 1) % 3]) * (py - y[(i + 1) % 3])
            - (y[(i + 2) % 3] - y[(i + 1) % 3]) * (px - x[(i + 1) % 3])
            for i in range(3)
        ]
        return np.stack(edges) / self.area[triangle]

    def plane_error(self, values: Array, extent: float) -> Array:
        """(T,) rounding of the interpolated `values` (T, 3) anywhere on a picture of that extent."""
        d1, d2 = (np.abs(values[:, k] - values[:, 0]) for k in (1, 2))
        terms = 0.0
        for axis in (self.x, self.y):
            p1, p2 = (np.abs(axis[:, k] - axis[:, 0]) for k in (1, 2))
            terms = terms + (d1 * p2 + d2 * p1) / np.abs(self.area)
        return PLANE_ROUNDINGS * UNIT * (2.0 * extent * terms + np.abs(values).max(axis=1))

    def slope(self, values: Array) -> Array:
        """(T,) the largest change of the interpolated `values` (T, 3) when x and y move by up to 1."""
        d1, d2 = (values[:, k] - values[:, 0] for k in (1, 2))
        total = 0.0
        for axis in (self.x, self.y):
            p1, p2 = (axis[:, k] - axis[:, 0] for k in (1, 2))
            total = total + np.abs(d1 * p2 - d2 * p1) / np.abs(self.area)
        return total


def centres(width: int, height: int) -> tuple[Array, Array]:
    """(H, W) x and y of the pixels' centres."""
    y, x = np.indices((height, width)) + 0.5
    return x, y


# --- Fetches and warps -----------------------------------------------------------------------------------------------


def fetched_error(image: Array, error: Array, x: Array, y: Array, off: tuple[Array, Array]) -> Array:
    """Of a bilinear fetch at (x, y) = (u S - 0.5, v S - 0.5), off by less than a texel: by the steepest cells around."""
    size = image.shape[0]
    padded, padded_error = (np.pad(each, 3, mode="edge") for each in (image, error))
    j, i = (np.clip(np.floor(each), -1, size - 1).astype(int) + 3 for each in (x, y))
    around = [padded[i + a, j + b] for a, b in product(range(-1, 3), repeat=2)]
    square = np.stack(around).reshape(4, 4, *x.shape)
    steps = [np.abs(np.diff(square, axis=k)).max(axis=(0, 1)) for k in (1, 0)]
    worst = np.stack([padded_error[i + a, j + b] for a, b in product(range(-1, 3), repeat=2)]).max(axis=0)
    return steps[0] * off[0] + steps[1] * off[1] + worst + 8.0 * UNIT


def warp_error(image: Array, error: Array, grid: Array, target: Array, shift: float) -> Array:
    """(S, S) of one warp of an image with an error (S, S), from grid to target (R, C, 2) in [0, 1]^2."""
    size = image.shape[0]
    indices = mesh_indices(*grid.shape[:2]).reshape(-1, 3)
    corners = Corners.snapped(*(size * target.reshape(-1, 2)[indices, k] for k in range(2)))
    shift = shift + 16.0 * UNIT * size  # of the positions themselves
    px, py = centres(size, size)
    attributes = [size * grid.reshape(-1, 2)[indices, k] for k in range(2)]
    slopes = [corners.slope(a) for a in attributes]
    rounding = [corners.plane_error(a, size) + 4.0 * UNIT * size for a in attributes]
    result = np.zeros_like(image)
    for triangle in range(len(indices)):
        weights = corners.barycentrics(triangle, px, py)
        edges, band = weights * np.abs(corners.area[triangle]), 4.0 * shift * size
        near = (edges > -band).all(axis=0)
        moves = np.where((edges[:, near] > band).all(axis=0), shift, 2.0 * shift)  # a plane may be used beyond its edge
        x, y = (np.tensordot(a[triangle], weights[:, near], axes=1) - 0.5 for a in attributes)
        off = tuple(moves * slopes[k][triangle] + rounding[k][triangle] for k in range(2))
        result[near] = np.maximum(result[near], fetched_error(image, error, x, y, off))
    return result


def warped_errors(maps: Any, stages: dict[str, Array], sample: Any, policy: str, shift: float) -> tuple[Array, Array]:
    """(2, S, S) of the rows and (S, S) of the map for one light sample, whose stages these are."""
    (i, j), (s, t) = place_in_cell(np.asarray(maps.positions), sample.offset)
    images, controls = np.asarray(maps.image), np.asarray(maps.controls)
    rows = []
    for k in (j, j + 1):
        between = controls[k, i] * (1.0 - s) + controls[k, i + 1] * s
        found = [
            warp_error(images[k, n], np.full(images[k, n].shape, UNIT), controls[k, n], between, shift)
            for n in (i, i + 1)
        ]
        rows.append(_mixed(found, s, policy))
    row_grids = [controls[k, i] * (1.0 - s) + controls[k, i + 1] * s for k in (j, j + 1)]
    grid = row_grids[0] * (1.0 - t) + row_grids[1] * t
    found = [warp_error(stages["warp.rows"][k], rows[k], row_grids[k], grid, shift) for k in range(2)]
    return np.stack(rows), _mixed(found, t, policy)


def _mixed(errors: list[Array], share: float, policy: str) -> Array:
    if policy == "nearest":
        return errors[int(share >= 0.5)]
    return (1.0 - share) * errors[0] + share * errors[1] + 8.0 * UNIT


# --- What the camera sees --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Seen:
    """The decided pixels of a scene, n of them, and what is interpolated there with its float32 error and shift."""

    decided: Array
    """(H, W) bool: one surface, farther than NOT_ON_AN_EDGE from every edge."""
    certain: Array
    """(H, W) bool: the same where nothing is, too."""
    kind: Array
    """(n,) 1 receiver, 2 caster."""
    normal: Array
    """(n, 3) unit, flat."""
    world: list[list[Rounded]]
    """x, y, z (n,) at the centre, and at four points around it `shift` away."""
    color: list[list[Rounded]]
    depth: list[list[Rounded]]
    """The window depth alone, in a list for the shape's sake."""


def seen(scene: Any, shift: float) -> Seen:
    """Rasterize a scene, none of whose triangles a clip plane cuts, in plain float64."""
    camera = scene.camera
    points, colors, normals, kinds = _triangles(scene)
    clip = np.concatenate([points, np.ones((*points.shape[:2], 1))], axis=2) @ np.asarray(camera.clip_from_world).T
    w = clip[..., 3]
    assert (w > 0).all(), "a triangle is cut by a clip plane: no bound for that"
    assert ((clip[..., 2] >= 0) & (clip[..., 2] <= w)).all(), "a triangle is cut by a clip plane: no bound for that"
    width, height = camera.width, camera.height
    corners = Corners.snapped((clip[..., 0] / w + 1) * width / 2, (1 - clip[..., 1] / w) * height / 2)
    kept = np.abs(corners.area) > 1e-9  # not seen edge-on
    corners = Corners(corners.x[kept], corners.y[kept])
    points, colors, normals, kinds, clip, w = (each[kept] for each in (points, colors, normals, kinds, clip, w))
    px, py = centres(width, height)
    nearest = np.full((2, height, width), np.inf)
    winner, certain = np.full((height, width), -1), np.ones((height, width), bool)
    for triangle in range(len(w)):
        weights = corners.barycentrics(triangle, px, py)
        lengths = [np.hypot(*(b - a)) for a, b in pairwise(_loop(corners, triangle))]
        distance = weights * abs(corners.area[triangle]) / np.array(lengths)[:, None, None]
        on_an_edge = (np.abs(distance) <= NOT_ON_AN_EDGE).any(axis=0) & (distance > -NOT_ON_AN_EDGE).all(axis=0)
        certain &= ~on_an_edge
        z = np.tensordot(clip[triangle, :, 2] / w[triangle], weights, axes=1)
        z = np.where((weights > 0).all(axis=0), z, np.inf)
        winner = np.where(z < nearest[0], triangle, winner)
        nearest = np.sort(np.concatenate([nearest, z[None]]), axis=0)[:2]
    with np.errstate(invalid="ignore"):
        certain &= ~(nearest[1] - nearest[0] < DEPTH_GAP)
    decided = certain & (winner >= 0)
    triangle, px, py = winner[decided], px[decided], py[decided]
    shift = shift + 8.0 * UNIT * max(width, height)
    around = [(0.0, 0.0), *product((-shift, shift), repeat=2)]
    extent = max(width, height)

    def spread(values: Array, inverse: Array) -> list[list[Rounded]]:
        return [_interpolated(corners, inverse, values, triangle, px + dx, py + dy, extent) for dx, dy in around]

    fields = spread(points, 1.0 / w), spread(colors, 1.0 / w), spread(clip[..., 2:3] / w[..., None], np.ones_like(w))
    return Seen(decided, certain, kinds[triangle], normals[triangle], *fields)


def _triangles(scene: Any) -> tuple[Array, Array, Array, Array]:
    """(T, 3, 3) world positions and colours, (T, 3) normals, (T,) kinds."""
    move = np.asarray(scene.offset, float) @ np.asarray(scene.offset_axes, float)
    points, colors, kinds = [], [], []
    for mesh, kind in [*((receiver, 1) for receiver in scene.receivers), (scene.caster, 2)]:
        triangles, color = np.asarray(mesh.triangles), np.asarray(mesh.color, float)
        points.append((np.asarray(mesh.vertices, float) + (move if kind == 2 else 0.0))[triangles])
        colors.append(color[triangles] if color.ndim == 2 else np.broadcast_to(color, points[-1].shape))
        kinds.append(np.full(len(triangles), kind))
    corners = np.concatenate(points)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners, np.concatenate(colors), normal / np.linalg.norm(normal, axis=1)[:, None], np.concatenate(kinds)


def _loop(corners: Corners, triangle: int) -> list[Array]:
    """Corners 1, 2, 0, 1: edge i is opposite to corner i."""
    return [np.array([corners.x[triangle, k], corners.y[triangle, k]]) for k in (1, 2, 0, 1)]


def _interpolated(
    corners: Corners, inverse_w: Array, values: Array, triangle: Array, px: Array, py: Array, extent: float
) -> list[Rounded]:
    """Perspective-correct, the components of `values` (T, 3 corners, components) at one triangle a point."""
    weights = corners.barycentrics(triangle, px, py)

    def plane(numbers: Array) -> Rounded:
        error = corners.plane_error(numbers, extent) + LOOSE * np.abs(numbers).max(axis=1)
        return Rounded((weights.T * numbers[triangle]).sum(axis=1), error[triangle])

    inverse = plane(inverse_w)
    return [plane(values[..., k] * inverse_w) / inverse for k in range(values.shape[2])]


# --- Projection and light --------------------------------------------------------------------------------------------


def around_pixel(values: list[Rounded]) -> Rounded:
    """The value at the centre; the largest difference of those around it, and rounding, are its error."""
    differences = [np.abs(other.value - values[0].value) + other.error for other in values[1:]]
    return Rounded(values[0].value, np.maximum(np.max(differences, axis=0), values[0].error))


def projected(light: Any, size: int, position: Array, world: list[list[Rounded]]) -> list[Rounded]:
    """s, t, r (n,), before r is clamped, of the points and those around them."""
    camera = light.camera(size, position)
    per_point = []
    for point in world:
        view = _transformed(camera.view_from_world, point)
        x, y, z, w = _transformed(camera.clip_from_view, view[:3])
        half = Rounded.of(0.5)
        per_point.append([(half * x + half * w) / w, (half * w - half * y) / w, z / w])
    return [around_pixel([point[k] for point in per_point]) for k in range(3)]


def _transformed(matrix: Array, point: list[Rounded]) -> list[Rounded]:
    one = Rounded.of(1.0)
    return [dot([Rounded.of(value) for value in row], [*point, one]) for row in np.asarray(matrix, float)]


def lit(scene: Any, found: Seen) -> Rounded:
    """max(0, n . l) (n,), n turned to the eye."""
    eye, light = np.asarray(scene.camera.eye, float), np.asarray(scene.light.position, float)
    centre = np.stack([axis.value for axis in found.world[0]], axis=1)
    side = np.where(((eye[:3] - eye[3] * centre) * found.normal).sum(axis=1) < 0.0, -1.0, 1.0)
    normal = [Rounded.of(side * found.normal[:, k]) for k in range(3)]
    values = []
    for point in found.world:
        to_light = [Rounded.of(light[k]) - point[k] for k in range(3)]
        values.append((dot(normal, to_light) / dot(to_light, to_light).root()).positive())
    return around_pixel(values)
