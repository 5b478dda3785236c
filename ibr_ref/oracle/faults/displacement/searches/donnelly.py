"""Bugs of sphere tracing in a distance map."""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.donnelly import distance_texture
from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.donnelly import Donnelly

DONNELLY = Bugs("march")
ONLY = ("donnelly",)


@DONNELLY.add("ray not normalized", only=ONLY)
class _NotUnit(Donnelly):
    """Each step goes as far down as the distance says: the ray is not of unit length."""

    def length(self, patch: Patch, rays: Rays) -> Floats:
        return self.do.in_lanes(1.0, rays.start[0])


@DONNELLY.add("ray normalized in the world", only=ONLY)
class _WorldUnit(Donnelly):
    """The ray's length is that in the world, over the volume's height, not that in (u, v, d)."""

    def length(self, patch: Patch, rays: Rays) -> Floats:
        way = self.combined([patch.edge_u, patch.edge_v, patch.up], [-rays.way[0], -rays.way[1], 1.0])
        return self.do.divide(self.do.root(self.do.dot(way, way)), patch.scale)


@DONNELLY.add("one step of the distance map more", only=ONLY)
class _StepMore(Donnelly):
    """N + 1 steps."""

    def steps(self) -> range:
        return range(self.params.linear_steps + 1)


@DONNELLY.add("one step of the distance map less", only=ONLY)
class _StepLess(Donnelly):
    """N - 1 steps."""

    def steps(self) -> range:
        return range(self.params.linear_steps - 1)


@DONNELLY.add("layers not mixed", only=ONLY)
class _Nearest(Donnelly):
    """The nearest layer is fetched, as from an array of textures, not a mix of two."""

    def layer_and_weight(self, depth: Floats, count: int) -> tuple[Ints, Floats]:
        return np.asarray(self.do.whole(self.do.multiply(depth, float(count))), np.int64), self.do.in_lanes(0.0, depth)


@DONNELLY.add("layers taken for corners", only=ONLY)
class _Corners(Donnelly):
    """The layer is d (L - 1), as if the first and the last layer lay at the top and the bottom."""

    def layer_and_weight(self, depth: Floats, count: int) -> tuple[Ints, Floats]:
        position = self.do.multiply(depth, float(count - 1))
        layer = np.asarray(self.do.whole(position), np.int64)
        return layer, self.do.weight(self.do.subtract(position, layer.astype(np.float64)))


@DONNELLY.add("layers wrapped", only=ONLY)
class _Wrapped(Donnelly):
    """The texture repeats along the depth too, as is OpenGL's default: the bottom layer is above the top one."""

    def layer(self, number: int, count: int) -> int:
        return int(number) % count


@DONNELLY.add("layers from the bottom up", only=ONLY)
class _UpsideDown(Donnelly):
    """The layers are taken to begin at the bottom."""

    def layer(self, number: int, count: int) -> int:
        return count - 1 - super().layer(number, count)


@DONNELLY.add("distances in 8 bits", only=ONLY)
class _Bytes(Donnelly):
    """The distance map is an 8-bit texture, whose fetches are bytes."""

    def read(self, distance: Floats) -> Floats:
        return self.do.divide(self.do.whole(self.do.add(self.do.multiply(distance, 255.0), 0.5)), 255.0)


@DONNELLY.add("squared distances", only=ONLY)
class _Squared(Donnelly):
    """The distance transform's squares are stored, without their roots."""

    def distances(self, patch: Patch) -> Floats:
        return super().distances(patch) ** 2


@DONNELLY.add("half a distance each time", only=ONLY)
class _Halves(Donnelly):
    """Each step goes half as far as is empty."""

    def read(self, distance: Floats) -> Floats:
        return self.do.multiply(distance, 0.5)


@DONNELLY.add("distance map of the depths", only=ONLY)
class _OfDepths(Donnelly):
    """The distance map is made of the heights taken for depths."""

    def distances(self, patch: Patch) -> Floats:
        polygon = self.scene.polygons[patch.number]
        depths = 1.0 - np.asarray(polygon.height_map, np.float64)
        return self.do.number(distance_texture(depths, self.params.distance_layers, patch.repeat))
