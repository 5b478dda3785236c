"""Bugs of the vertex stage."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.displacement.case import Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.port import Port
from ibr_ref.oracle.programs.displacement.vertex import V1, Quad

VERTEX = Bugs("vertex")


@VERTEX.add("volume below the polygon")
class _NormalDown(Port):
    """n = V x U: the volume hangs below the polygon."""

    def normal(self, edge_u: Vector, edge_v: Vector) -> Vector:
        return super().normal(edge_v, edge_u)


@VERTEX.add("normal of the polygon not normalized")
class _LongNormal(Port):
    """n = U x V, as long as the polygon is large."""

    def normal(self, edge_u: Vector, edge_v: Vector) -> Vector:
        return self.cross(edge_u, edge_v)


@VERTEX.add("height scale applied twice")
class _ScaledTwice(Port):
    """The volume is s^2 high."""

    def up(self, normal: Vector, scale: Floats) -> Vector:
        return self.scaled(super().up(normal, scale), scale)


@VERTEX.add("height scale in half precision", small=True)
class _HalfScale(Port):
    """s is a 16-bit float."""

    def up(self, normal: Vector, scale: Floats) -> Vector:
        return super().up(normal, half(scale))


@VERTEX.add("view rotation transposed")
class _TransposedView(Port):
    """The rotation of the view matrix is read in the other order of rows and columns."""

    def to_clip(self, world: Vector) -> Vector:
        rotation = self.view_from_world[:3, :3].T
        view = [
            self.do.dot([*row, t], [*world, 1.0]) for row, t in zip(rotation, self.view_from_world[:3, 3], strict=True)
        ]
        return [self.do.dot(row, [*view, np.ones(np.shape(view[0]))]) for row in self.clip_from_view]


@VERTEX.add("clip z from -w")
class _SymmetricDepth(Port):
    """The projection of GL, z in [-w, w], in a pipeline that has z in [0, w]."""

    def to_clip(self, world: Vector) -> Vector:
        x, y, z, w = super().to_clip(world)
        return [x, y, self.multiply_add(2.0, z, -w), w]


@VERTEX.add("no face v=1")
class _ThreeSides(Port):
    """The far side at v = 1 is never drawn."""

    def draws(self, face: int, eye: Vector) -> bool:
        return face != V1 and super().draws(face, eye)


@VERTEX.add("sides towards the eye")
class _FrontSides(Port):
    """Sides are drawn where they face the eye."""

    def faces_away(self, face: int, eye: Vector) -> bool:
        away = super().faces_away(face, eye)
        return not away if 1 <= face <= 4 else away


@VERTEX.add("extended base without the polygon")
class _ShadowsOnly(Port):
    """The bounding rectangle is that of the projected top alone."""

    def rectangle(self, points: Sequence[Vector]) -> tuple[Vector, Vector]:
        return super().rectangle(points[4:])


@VERTEX.add("extended base from the middle of the volume")
class _HalfExtended(Port):
    """The base is extended by the projections of corners at h = 1/2."""

    def top_corner_on_ground(self, eye: Vector, corner: Floats) -> Vector:
        way = self.towards(eye, [corner[0], corner[1], np.array(0.5)])
        share = self.do.divide(0.5, way[2])
        return [self.do.subtract(corner[k], self.do.multiply(way[k], share)) for k in (0, 1)]


@VERTEX.add("other order of corners", hidden="the triangles cover the same pixels with the same varyings")
class _RolledCorners(Port):
    """Quads begin at their third corner: the buffers hold the corners in another order."""

    def quad(self, patch: Patch, face: int) -> Quad:
        quad = super().quad(patch, face)
        return Quad(face, np.roll(quad.patch, 2, axis=0), np.roll(quad.clip, 2, axis=0))


@VERTEX.add("patch buffer in world units", hidden="what is drawn comes from another buffer")
class _UnusedBuffer(Port):
    """The patch buffer that is handed in has h in world units; the rasterizer gets the right ones."""

    def written_corners(self, patch: Patch, quad: Quad) -> Floats:
        return self.do.multiply(quad.patch, [1.0, 1.0, float(patch.scale)])
