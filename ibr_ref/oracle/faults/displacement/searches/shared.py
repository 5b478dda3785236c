"""Bugs that all searches below the polygon can have: the view ray, the map's height and its border."""

from __future__ import annotations

from abc import ABC, abstractmethod

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Sunken

SHARED = Bugs("march")

BY_HEIGHTS = ("relief", "mcguire", "tatarchuk", "cone", "relaxed_cone", "maximum_mipmap")
"""Those that sink, and look at the height map."""
DEEP = (*BY_HEIGHTS, "donnelly")
"""Those that sink."""
ALL = (*DEEP, "welsh")


class _OtherWay(Sunken, ABC):
    """The view ray goes elsewhere."""

    def rays(self, patch: Patch, point: Vector) -> Rays:
        rays = super().rays(patch, point)
        return Rays(rays.start, [*self.changed(patch, point, rays.way[:2]), rays.way[2]])

    @abstractmethod
    def changed(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        """-v_uv / v_h, as the bug has it."""


@SHARED.add("offset towards the eye", only=ALL)
class _TowardsEye(_OtherWay):
    """The view ray goes up from the polygon instead of down: the offset has the wrong sign."""

    def changed(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        return [-x for x in way]


@SHARED.add("v of the offset flipped", only=ALL)
class _FlippedV(_OtherWay):
    """The offset along v has the wrong sign: the map's rows are taken to run the other way."""

    def changed(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        return [way[0], -way[1]]


@SHARED.add("u and v of the offset swapped", only=ALL)
class _Swapped(_OtherWay):
    """Tangent and bitangent are swapped."""

    def changed(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        return [way[1], way[0]]


@SHARED.add("offset scaled by the height again", only=ALL)
class _ScaledTwice(_OtherWay):
    """The offset is multiplied by height_scale, though the patch space is scaled by it."""

    def changed(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        return self.scaled(way, patch.scale)


@SHARED.add("way to the eye not divided by its height", only=DEEP)
class _Undivided(_OtherWay):
    """v_uv of the unit way in patch space, without the division by v_h: offset limiting."""

    def changed(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        length = self.do.root(self.do.dot([*way, 1.0], [*way, 1.0]))
        return [self.do.divide(x, length) for x in way]


@SHARED.add("tangent frame taken for orthogonal", only=ALL)
class _Orthogonal(_OtherWay):
    """u and v of the view ray by dot products with U/|U|^2 and V/|V|^2 instead of the reciprocal basis."""

    def changed(self, patch: Patch, point: Vector, way: Vector) -> Vector:
        world = self.combined([patch.edge_u, patch.edge_v], way)
        edges = (patch.edge_u, patch.edge_v)
        return [self.do.divide(self.do.dot(world, edge), self.do.dot(edge, edge)) for edge in edges]


@SHARED.add("heights taken for depths", only=(*BY_HEIGHTS, "welsh"))
class _Depths(Sunken):
    """The map is read as depths: 1 - H in place of H."""

    def height_at(self, patch: Patch, u: Floats, v: Floats) -> Floats:
        return self.do.subtract(1.0, super().height_at(patch, u, v))
