"""From a pixel of a reference image to its point in space: T_R→W after the pinhole turned round."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.programs.splatting.case import Case, Floats, Image, Ints, Vector


class Unprojection(Case):
    """Used twice: where the normals are prepared, and in the vertex stage."""

    def center(self, index: Ints) -> Floats:
        """Where the centre of a column or row of pixels is."""
        return self.do.add(index, 0.5)

    def intrinsics(self, camera: Any) -> Any:
        """(3, 3) of a reference camera, [[f_x, s, c_x], [0, f_y, c_y], [0, 0, 1]]."""
        return camera.intrinsics

    def image_plane(self, camera: Any, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """x_n, y_n of window positions; y_n grows downwards."""
        (f_x, s, c_x), (_, f_y, c_y), _ = self.do.matrix(self.intrinsics(camera))
        up = self.do.subtract(v, c_y)
        y = self.over(up, f_y, camera, 1)
        x = self.over(self.do.sum([u, -c_x, -self.do.multiply(s, y)]), f_x, camera, 0)
        if not (self.do.bounded and self.right("intrinsics")):
            return x, y
        return tuple(self.do.either([x, y], lambda: list(self.by_inverse(camera, u, v))))

    def over(self, way: Floats, focal: Floats, camera: Any, axis: int) -> Floats:
        """A way over a focal length; or times its reciprocal, made on the host."""
        quotient = self.do.divide(way, focal)
        if not self.right("intrinsics"):
            return quotient
        reciprocal = 1.0 / float(camera.intrinsics[axis, axis])
        return self.do.either(quotient, lambda: self.do.multiply(way, self.do.number(reciprocal)))

    def by_inverse(self, camera: Any, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """The same by the inverse matrix of the intrinsics."""
        x, y, _ = self.do.matrix(np.linalg.inv(camera.intrinsics))
        return self.do.dot(list(x), [u, v, 1.0]), self.do.dot(list(y), [u, v, 1.0])

    def stretch(self, camera: Any, x: Floats, y: Floats, depth: Floats) -> tuple[Floats, Floats]:
        """x and y of view space at a depth: lines of sight spread from an eye, or are parallel."""
        if camera.perspective:
            return self.do.multiply(x, depth), self.do.multiply(y, depth)
        return x, y

    def view_point(self, camera: Any, columns: Ints, rows: Ints, depth: Floats) -> Vector:
        """The points in the reference camera's view space, of pixels and their depths along its axis."""
        x, y = self.image_plane(camera, self.center(columns), self.center(rows))
        x, y = self.stretch(camera, x, y, depth)
        return [x, -y, -depth]

    def world_from_view(self, camera: Any) -> Any:
        """(4, 4) T_R→W: the inverse, as a measured rotation's transpose is not it."""
        return camera.world_from_view

    def world_point(self, image: Image, columns: Ints, rows: Ints, depth: Floats) -> Vector:
        """The points of pixels in world space."""
        return self.from_view(image.camera, self.view_point(image.camera, columns, rows, depth))

    def from_view(self, camera: Any, view: Vector) -> Vector:
        """T_R→W."""
        return self.transform(self.world_from_view(camera), view)[:3]
