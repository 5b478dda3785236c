"""The vertex stage: patch spaces, and the faces of the displaced volumes in clip space (section 3.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Case, Floats, Patch, Vector

BASE, U0, U1, V0, V1, TOP = range(6)

QUADS = np.array(
    [
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
        [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)],
        [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)],
        [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
        [(0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)],
        [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    ],
    np.float64,
)
"""(6, 4, 3) corners a, b, c, d of the faces in patch space."""


@dataclass(frozen=True)
class Quad:
    """A face to be drawn as the triangles abc and acd."""

    face: int
    patch: Floats
    """(4, 3)."""
    clip: Floats
    """(4, 4)."""


class Vertex(Case):
    """From base polygons to quads."""

    def patches(self) -> list[Patch]:
        """All polygons on the device, in order."""
        return [self.patch(number, polygon) for number, polygon in enumerate(self.scene.polygons)]

    def patch(self, number: int, polygon: Any) -> Patch:
        """One polygon with its patch space and its textures."""
        corner, edge_u, edge_v = (self.upload(x) for x in polygon.arrays)
        scale = self.do.number(polygon.height_scale)
        normal = self.normal(edge_u, edge_v)
        up = self.up(normal, scale)
        rows = self.patch_rows(edge_u, edge_v, up)
        eye, light = self.to_patch(rows, corner, self.eye), self.to_patch(rows, corner, self.light)
        return Patch(
            number=number,
            corner=corner,
            edge_u=edge_u,
            edge_v=edge_v,
            normal=normal,
            up=up,
            rows=rows,
            eye=[*self.named("eye", eye[:3]), eye[3]],
            light=[*self.named("light", light[:3]), light[3]],
            scale=scale,
            repeat=polygon.domain == "repeat",
            heights=self.uploaded_heights(polygon.height_map),
            colors=self.do.number(polygon.color_map),
            normals=None if polygon.normal_map is None else self.do.number(polygon.normal_map),
            facade=None if polygon.facade_map is None else self.do.number(polygon.facade_map),
            facade_tile=self.upload(polygon.facade_tile),
        )

    def uploaded_heights(self, heights: Any) -> Floats:
        """The height map as a float texture."""
        return self.do.number(heights)

    def normal(self, edge_u: Vector, edge_v: Vector) -> Vector:
        """n = normalize(U x V)."""
        return self.do.unit(self.cross(edge_u, edge_v))

    def up(self, normal: Vector, scale: Floats) -> Vector:
        """The way from the polygon to the top of its volume, s n."""
        return self.scaled(normal, scale)

    def patch_rows(self, edge_u: Vector, edge_v: Vector, up: Vector) -> list[Vector]:
        """The reciprocal basis of (U, V, s n)."""
        rows = [self.cross(edge_v, up), self.cross(up, edge_u), self.cross(edge_u, edge_v)]
        determinant = self.do.dot(edge_u, rows[0])
        return [[self.do.divide(x, determinant) for x in row] for row in rows]

    def to_patch(self, rows: list[Vector], corner: Vector, point: Vector) -> Vector:
        """A homogeneous point of the world, (x, y, z, 1) or (x, y, z, 0), in patch space."""
        way = [self.do.subtract(x, c) for x, c in zip(point, corner, strict=False)] if point[3] else point[:3]
        return [*(self.do.dot(row, way) for row in rows), point[3]]

    def to_world(self, patch: Patch, point: Vector) -> Vector:
        """P0 + u U + v V + h s n."""
        return self.combined([patch.corner, patch.edge_u, patch.edge_v, patch.up], [1.0, *point])

    def named(self, name: str, vector: Vector) -> Vector:
        """A vector whose error enters what follows more than once."""
        return [self.do.named(f"{name} {k}", x) for k, x in enumerate(vector)]

    def to_clip(self, world: Vector) -> Vector:
        """Clip coordinates (4) of points in world space: one matrix after the other."""
        view = [self.do.dot(row, [*world, 1.0]) for row in self.view_from_world]
        return [self.do.dot(row, view) for row in self.clip_from_view]

    def projected(self, patch: Patch, point: Vector, again: bool = True) -> Vector:
        """Clip coordinates (4) of points in patch space: matrix by matrix, or by matrices that were multiplied before.

        again: z and w are divided by one another, and what both owe to the point in the world is one error.
        """
        at = self.to_world(patch, point)
        if again:
            at = self.named("world", at)
        clip = self.to_clip(at)
        if not (self.do.bounded and self.right("to_clip", "to_world")):
            return clip
        from_world, from_patch = self._multiplied(patch)
        ways = ((from_world, at), (from_patch, point))
        return self.do.either(clip, *(lambda m=m, p=p: [self.do.dot(row, [*p, 1.0]) for row in m] for m, p in ways))

    def _multiplied(self, patch: Patch) -> tuple[list[Vector], list[Vector]]:
        """The matrices from the world and from a patch to clip space; the same for every call."""
        if id(patch) not in self.multiplied:
            from_world = self._product(self.clip_from_view, self.view_from_world)
            axes = [patch.edge_u, patch.edge_v, patch.up, patch.corner]
            from_patch = self._product(from_world, [*([a[i] for a in axes] for i in range(3)), [0.0, 0.0, 0.0, 1.0]])
            self.multiplied[id(patch)] = patch, from_world, from_patch
        return self.multiplied[id(patch)][1:]

    def _product(self, a: Any, b: Any) -> list[Vector]:
        return [[self.do.dot(row, [r[j] for r in b]) for j in range(4)] for row in map(list, a)]

    def quads(self, patch: Patch) -> list[Quad]:
        """The faces of a volume that are drawn, in order."""
        return [self.quad(patch, face) for face in range(6) if self.draws(face, patch.eye)]

    def draws(self, face: int, eye: Vector) -> bool:
        """Whether the parameters ask for the face and it is turned away from the eye."""
        if face != BASE and self.params.drawn_faces != "auxiliary":
            return False
        if face == TOP and self.params.interval != "volume":
            return False
        return self.faces_away(face, eye)

    def faces_away(self, face: int, eye: Vector) -> bool:
        """Whether the eye is on the inner side of the face's plane."""
        u, v, h, w = eye
        return bool((h > 0.0, u > 0.0, u < w, v > 0.0, v < w, h < w)[face])

    def quad(self, patch: Patch, face: int) -> Quad:
        """One face in patch space and in clip space."""
        corners = self.extended_corners(patch.eye) if self.params.drawn_faces == "extended" else QUADS[face]
        clip = self.projected(patch, list(corners.T), again=False)
        return Quad(face, corners, np.stack(np.broadcast_arrays(*clip), axis=-1))

    def written_corners(self, patch: Patch, quad: Quad) -> Floats:
        """(4, 3) corners in patch space as they are handed in."""
        return quad.patch

    def extended_corners(self, eye: Vector) -> Floats:
        """(4, 3) the base enlarged to where the whole volume is seen before its plane (section 3.2.1)."""
        shadows = [self.top_corner_on_ground(eye, corner) for corner in QUADS[TOP]]
        points = [*(list(corner[:2]) for corner in QUADS[BASE]), *shadows]
        (u0, v0), (u1, v1) = self.rectangle(points)
        sides = [np.stack([u0, u1, u1, u0], axis=-1), np.stack([v0, v0, v1, v1], axis=-1)]
        return np.stack([*sides, np.zeros(4)], axis=-1)

    def top_corner_on_ground(self, eye: Vector, corner: Floats) -> Vector:
        """(u, v) where the line of sight through a corner of the top meets h = 0."""
        way = self.towards(eye, list(corner))
        share = self.do.divide(1.0, way[2])
        return [self.do.subtract(corner[k], self.do.multiply(way[k], share)) for k in (0, 1)]

    def rectangle(self, points: Sequence[Vector]) -> tuple[Vector, Vector]:
        """The bounding rectangle of points (u, v): its lowest and its highest corner."""
        low, high = ([reduce(f, [p[k] for p in points]) for k in (0, 1)] for f in (self.do.least, self.do.greatest))
        return low, high
