"""Triangle meshes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import checks


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """Indexed triangles with a colour. Degenerate triangles are kept: they cover nothing.

    Raises ValueError for vertices that are not finite, no triangles, indices out of range, or colours outside [0, 1].
    """

    vertices: ArrayLike
    """(V, 3) in world (or model) space."""
    triangles: ArrayLike
    """(T, 3) indices into `vertices`."""
    color: ArrayLike = (0.8, 0.8, 0.8)
    """(3,) for the whole mesh, or (V, 3); linear, in [0, 1]."""

    def __post_init__(self) -> None:
        vertices = checks.numbers("vertices", self.vertices, "an array (V, 3) of finite numbers")
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not len(vertices):
            raise checks.reject("vertices.shape", vertices.shape, "(V, 3), V >= 1")
        checks.finite_rows("vertices", vertices)
        object.__setattr__(self, "vertices", checks.frozen(vertices))
        object.__setattr__(self, "triangles", self._checked_triangles(len(vertices)))
        color = checks.numbers("color", self.color, f"(3,) or {vertices.shape} numbers in [0, 1]")
        if color.shape not in ((3,), vertices.shape):
            raise checks.reject("color.shape", color.shape, f"(3,) or {vertices.shape}")
        bad = ~((color >= 0.0) & (color <= 1.0))
        if bad.any():
            raise checks.reject("color", float(color[bad][0]), "numbers in [0, 1]")
        object.__setattr__(self, "color", checks.frozen(color))

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) the lowest and the highest coordinates of the corners of all triangles."""
        corners = self.corners
        return checks.frozen(np.stack([corners.min(axis=0), corners.max(axis=0)]))

    @cached_property
    def corners(self) -> NDArray[np.float64]:
        """(U, 3) the vertices that triangles have, in their order: what a mesh extends to. Files have others as well."""
        return checks.frozen(np.asarray(self.vertices)[np.unique(self.triangles)])

    def compact(self) -> Mesh:
        """The same triangles without the vertices of none."""
        used, places = np.unique(self.triangles, return_inverse=True)
        color = np.asarray(self.color)
        return Mesh(
            vertices=self.corners,
            triangles=places.reshape(-1, 3),
            color=color[used] if color.ndim == 2 else color,
        )

    def _checked_triangles(self, count: int) -> NDArray[np.int32]:
        checks.numbers("triangles", self.triangles, "an array (T, 3) of whole numbers")
        triangles = np.array(self.triangles)
        if triangles.ndim != 2 or triangles.shape[1] != 3 or not len(triangles):
            raise checks.reject("triangles.shape", triangles.shape, "(T, 3), T >= 1")
        if not np.issubdtype(triangles.dtype, np.integer):
            raise checks.reject("triangles.dtype", str(triangles.dtype), "whole numbers")
        if triangles.min() < 0 or triangles.max() >= count:
            bad = int(triangles.min()) if triangles.min() < 0 else int(triangles.max())
            raise checks.reject("triangles", bad, f"indices from 0 to {count - 1}")
        result = np.ascontiguousarray(triangles, np.int32)
        result.setflags(write=False)
        return result
