"""From a pixel of a reference image to its point in space: T_R→W after the pinhole turned round."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from ibr_ref.array_types import Floats
from ibr_ref.oracle.ports.splatting.stage import Stage


class Unprojection(Stage):
    """Used twice: where the normals are prepared, and in the vertex stage."""

    def center(self, index: ArrayLike) -> Floats:
        """Where the centre of a column or row of pixels is."""
        return self.alu.add(index, 0.5)

    def intrinsics(self, camera: Any) -> Floats:
        """(3, 3) of a reference camera, [[f_x, s, c_x], [0, f_y, c_y], [0, 0, 1]]."""
        return self.alu.number(camera.intrinsics)

    def image_plane(self, camera: Any, u: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        """x_n, y_n of window positions; y_n grows downwards."""
        (f_x, s, c_x), (_, f_y, c_y), _ = self.intrinsics(camera)
        y = self.alu.divide(self.alu.subtract(v, c_y), f_y)
        x = self.alu.divide(self.alu.sum([u, -c_x, -self.alu.multiply(s, y)]), f_x)
        return x, y

    def stretch(self, camera: Any, x: Floats, y: Floats, depth: Floats) -> tuple[Floats, Floats]:
        """x and y of view space at a depth: lines of sight spread from an eye, or are parallel."""
        if camera.perspective:
            return self.alu.multiply(x, depth), self.alu.multiply(y, depth)
        return x, y

    def view_point(self, camera: Any, columns: ArrayLike, rows: ArrayLike, depth: Floats) -> list[Floats]:
        """The points in the reference camera's view space, of pixels and their depths along its axis."""
        x, y = self.image_plane(camera, self.center(columns), self.center(rows))
        x, y = self.stretch(camera, x, y, depth)
        return [x, -y, -depth]

    def world_from_view(self, camera: Any) -> ArrayLike:
        """(4, 4) T_R→W: the inverse, as a measured rotation's transpose is not it."""
        matrix: ArrayLike = camera.world_from_view
        return matrix

    def world_point(self, camera: Any, view: list[Floats]) -> list[Floats]:
        """The points in world space."""
        return self.transform(self.world_from_view(camera), view)[:3]
