"""What the case hands over, and where the samples of the light are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Self

import numpy as np

from ibr_ref.oracle.programs.program import Floats, Program, Vector
from ibr_ref.oracle.programs.shadows.raster import Raster
from ibr_ref.oracle.programs.shadows.sampler import Sampler

Matrix = Any
"""Four rows of four numbers."""


class Lights(Program):
    """The foundation of the port: the light's samples, and the passes' rasterizers and samplers."""

    map_raster: ClassVar[type[Raster]] = Raster
    """Draws the nine maps."""
    direct_raster: ClassVar[type[Raster]] = Raster
    """Draws the maps of method "direct"."""
    warp_raster: ClassVar[type[Raster]] = Raster
    """Draws the meshes of control points."""
    surface_raster: ClassVar[type[Raster]] = Raster
    """Draws the picture."""
    warp_sampler: ClassVar[type[Sampler]] = Sampler
    """Fetches from the images that are warped."""
    shadow_sampler: ClassVar[type[Sampler]] = Sampler
    """Fetches from the map that is projected."""

    def on(self, do: Any) -> Self:
        """On another arithmetic: a device's, or bounds of what devices make of it."""
        super().on(do)
        scene = self.scene
        camera = scene.light.camera(self.params.map_size)
        self.light_projection = np.asarray(camera.clip_from_view)
        self.centre = self.light_centre()
        self.half_edges, self.axes = do.matrix(scene.light.half_edges), do.matrix(scene.offset_axes)
        self.offset = do.number(scene.offset)
        self.light_rotation = do.matrix(camera.view_from_world[:3, :3])
        self.places = self.sample_places()
        return self

    def light_centre(self) -> Floats:
        """(3,) in the world."""
        return np.stack([self.do.named("light", x) for x in self.do.number(self.scene.light.position)])

    def steps(self) -> list[tuple[float, float]]:
        """(g_i, g_j) of the samples of 5 or 9: j outer, i inner, the centre first."""
        g = {5: (-2.0 / 3.0, 2.0 / 3.0), 9: (-2.0 / 3.0, 0.0, 2.0 / 3.0)}[self.params.light_samples]
        return [(0.0, 0.0), *((x, y) for y in g for x in g if (x, y) != (0.0, 0.0))]

    def sample_places(self) -> list[Floats]:
        """(3,) world positions of the samples in use."""
        if isinstance(self.params.light_samples, np.ndarray):
            return list(self.do.matrix(self.params.light_samples))
        if self.params.light_samples == 1:
            return [self.centre]
        a, b = self.half_edges
        steps = [self.do.number(step) for step in self.steps()]
        return [self.do.add(self.centre, self.do.dot([a, b], list(step))) for step in steps]

    def displacement(self, place: Floats) -> Floats:
        """(2,) on the two axes: of a sample from the light's centre."""
        return self.on_axes(self.do.subtract(place, self.centre))

    def place_of_object(self, place: Floats) -> Floats:
        """(2,) where the object stands relative to a sample of the light: moved the opposite way."""
        return self.do.subtract(self.offset, self.displacement(place))

    def on_axes(self, vector: Floats) -> Floats:
        """(2,) the x and y of the point x a + y b next to a vector (3,), by the axes' Gram matrix."""
        do, (a, b) = self.do, [list(axis) for axis in self.axes]
        aa, ab, bb = do.dot(a, a), do.dot(a, b), do.dot(b, b)
        va, vb = do.dot(list(vector), a), do.dot(list(vector), b)
        determinant = self._difference(aa, bb, ab, ab)
        x, y = self._difference(bb, va, ab, vb), self._difference(aa, vb, ab, va)
        return np.stack([do.divide(x, determinant), do.divide(y, determinant)])

    def _difference(self, a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
        return self.do.subtract(self.do.multiply(a, b), self.do.multiply(c, d))

    def light_view(self, place: Floats) -> Matrix:
        """view_from_world of the light at a place: it looks where it looks from its centre."""
        rows = [[*axis, -self.do.dot(list(axis), list(place))] for axis in self.light_rotation]
        return [*rows, [0.0, 0.0, 0.0, 1.0]]

    def clip_coordinates(self, projection: Any, view: Matrix, point: Vector) -> Vector:
        """Of points, by both matrices in turn; or by their product, and z from a clip space that starts at -w."""
        seen = self.applied(view, [*point, 1.0])
        clip = self.applied(self.do.matrix(projection), seen)
        if not self.do.bounded:
            return clip
        clip = self.do.either(clip, lambda: self.by_product(self.do.matrix(projection), view, point))
        if self.do.minus_one:
            row = self.do.matrix((2.0 * projection[2] - projection[3])[None])
            ends = (self.applied(row, seen)[0], self.by_product(row, view, point)[0])
            clip[2] = self.do.either(clip[2], *(lambda end=end: self.do.halfway(end, clip[3]) for end in ends))
        return clip

    def by_product(self, first: Matrix, second: Matrix, point: Vector) -> Vector:
        """Points by the product of two matrices, made once, in floats."""
        return self.applied(self.product(first, second), [*point, 1.0])

    def product(self, a: Matrix, b: Matrix) -> Matrix:
        """Of two matrices."""
        columns = list(zip(*(list(row) for row in b), strict=True))
        return [[self.do.dot(list(row), list(column)) for column in columns] for row in a]

    def applied(self, matrix: Matrix, point: Sequence[Floats]) -> Vector:
        """A matrix times (x, y, z, w), row by row, each summed from left to right."""
        return [self.do.dot(list(row), point) for row in matrix]
