"""Bugs in where a point of the scene lies on the map, and at which depth."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from ibr_ref.array_types import Floats as Array
from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.faults.shadows.systems import ALL, MAPPED
from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.lights import Matrix
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import Fragments, Raster

PROJECT = Bugs("project", only=MAPPED)


@PROJECT.add("project-t-upwards", only=ALL)
class _Upwards(Port):
    """T grows upwards."""

    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[1, 1] = 0.5
        return matrix


@PROJECT.add("project-gl-depth")
class _GLDepth(Port):
    """The bias matrix halves z too, as for NDC from -1."""

    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[2] = 0.0, 0.0, 0.5, 0.5
        return matrix


@PROJECT.add("project-half-texel-in-matrix", only=ALL)
class _HalfInMatrix(Port):
    """The bias matrix adds half a texel."""

    def texture_matrix(self) -> Floats:
        matrix = super().texture_matrix().copy()
        matrix[:2, 3] += 0.5 / self.params.map_size
        return matrix


@PROJECT.add("project-r-not-divided")
class _DepthNotDivided(Port):
    """R is compared before the division by q_w."""

    def divided(self, q: Vector) -> Vector:
        return [*super().divided(q)[:2], q[2]]


@PROJECT.add("project-world-not-perspective", only=ALL)
class _NotPerspective(Port):
    """World positions are interpolated linearly in the window."""

    def world(self, raster: Raster, fragments: Fragments, w: Floats, corners: Vector) -> Vector:
        return [raster.linear(fragments, corner) for corner in corners]


@PROJECT.add("project-r-not-clamped")
class _NotClamped(Port):
    """R is not clamped to [0, 1]."""

    def clamped(self, r: Floats) -> Floats:
        return r


@PROJECT.add("project-r-half-floats", small=True)
class _HalfDepth(Port):
    """R is held in half floats."""

    def clamped(self, r: Floats) -> Floats:
        return half(super().clamped(r))


@PROJECT.add("project-behind-light", small=True)
class _BehindLight(Port):
    """The reverse projection behind the light casts shadows too."""

    def before_light(self, w: Floats) -> Bools:
        return np.isfinite(w)


@PROJECT.add("project-centre-matrix")
class _CentreMatrix(Port):
    """All samples' maps are projected from the light's centre."""

    def projecting_view(self, place: Floats) -> Matrix:
        return self.light_view(self.centre)


@PROJECT.add("project-target-left")
class _TargetLeft(Port):
    """The light's target stays in place when a sample moves."""

    def projecting_view(self, place: Floats) -> Matrix:
        back = self.do.unit(list(self.do.subtract(place, self.do.number(self.scene.light.target))))
        right = self.do.unit(self.cross(list(self.do.number(self.scene.light.up)), back))
        rows = [[*axis, -self.do.dot(axis, list(place))] for axis in (right, self.cross(back, right), back)]
        return [*rows, [0.0, 0.0, 0.0, 1.0]]


class _Changed(Port, ABC):
    """Another bias matrix."""

    def texture_matrix(self) -> Array:
        matrix = super().texture_matrix().copy()
        self.change(matrix)
        return matrix

    @abstractmethod
    def change(self, matrix: Array) -> None:
        """In place."""


@PROJECT.add("project-s-mirrored")
class _Mirrored(_Changed):
    """S grows to the left: the map is looked up mirrored."""

    def change(self, matrix: Array) -> None:
        matrix[0, 0] = -0.5


@PROJECT.add("project-no-half")
class _NoHalfOffset(_Changed):
    """The bias matrix scales by 0.5 and adds no 0.5."""

    def change(self, matrix: Array) -> None:
        matrix[:2, 3] = 0.0


@PROJECT.add("project-ndc-as-coordinates")
class _Unbiased(_Changed):
    """The light's NDC are taken for texture coordinates: there is no bias matrix but for t downwards."""

    def change(self, matrix: Array) -> None:
        matrix[:2, 3] = 0.0
        matrix[0, 0], matrix[1, 1] = 1.0, -1.0


@PROJECT.add("project-bias-matrix-on-the-wrong-side")
class _BiasFirst(_Changed):
    """The bias matrix is transposed: its offsets go into w."""

    def change(self, matrix: Array) -> None:
        matrix[:] = matrix.T.copy()


@PROJECT.add("project-not-divided")
class _NotDivided(Port):
    """S, t and r are not divided by q_w: texture() in the place of textureProj()."""

    def divided(self, q: Vector) -> Vector:
        return [1.0 * component for component in q[:3]]


@PROJECT.add("project-divided-by-z")
class _DividedByZ(Port):
    """S, t and r are divided by q_z."""

    def divided(self, q: Vector) -> Vector:
        return super().divided([*q[:3], q[2]])


@PROJECT.add("project-divided-twice")
class _DividedTwice(Port):
    """Coordinates that are divided already are given to textureProj()."""

    def divided(self, q: Vector) -> Vector:
        return super().divided([*super().divided(q), q[3]])


@PROJECT.add("project-view-transposed")
class _ViewTransposed(Port):
    """The light's rotation is uploaded column by column."""

    def projecting_view(self, place: Floats) -> Matrix:
        rows = [list(row) for row in super().projecting_view(place)]
        return [*([rows[j][i] for j in range(3)] + [rows[i][3]] for i in range(3)), rows[3]]


@PROJECT.add("project-eye-not-rotated")
class _EyeNotRotated(Port):
    """The light's view matrix has -position for its last column, not that in the light's axes."""

    def projecting_view(self, place: Floats) -> Matrix:
        rows = [list(row) for row in super().projecting_view(place)]
        return [*([*rows[i][:3], -list(place)[i]] for i in range(3)), rows[3]]


@PROJECT.add("project-aspect-of-the-picture")
class _AspectOfPicture(_Changed):
    """The light's projection has the picture's aspect ratio, the maps are square."""

    def change(self, matrix: Array) -> None:
        matrix[0, 0] *= self.scene.camera.height / self.scene.camera.width


@PROJECT.add("project-r-linear")
class _LinearDepth(Port):
    """R is the depth between near and far, the map's is that of the window."""

    def coordinates(self, world: Vector, place: Floats) -> Vector:
        s, t, _, w = super().coordinates(world, place)
        near, far = self.scene.light.near, self.scene.light.far
        return [s, t, self.clamped(self.do.divide(self.do.subtract(w, near), far - near)), w]


@PROJECT.add("project-r-reversed")
class _Reversed(Port):
    """R is 1 - z/w: the light's depth is taken for a reversed one."""

    def clamped(self, r: Floats) -> Floats:
        return super().clamped(self.do.subtract(1.0, r))


@PROJECT.add("project-r-16-bits", small=True)
class _Depth16(Port):
    """R is rounded to 16 bits."""

    def clamped(self, r: Floats) -> Floats:
        return np.rint(super().clamped(r) * 65535.0) / 65535.0
