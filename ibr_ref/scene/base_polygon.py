"""The base polygon of protruded displacement mapping: a parallelogram with its maps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import checks


@dataclass(frozen=True, kw_only=True, eq=False)
class BasePolygon:
    """The bottom of a displaced volume: points corner + u edge_u + v edge_v, with u and v in [0, 1].

    Patch space is (u, v, h): h = 0 on the polygon, h = 1 `height_scale` world units along normalize(edge_u x edge_v).
    Maps may differ in size; texel row 0 lies at v = 0. Raises ValueError for anything outside the stated ranges.

    Edges that are mirrored, such as those of a mesh whose texture coordinates are, would push the surface out on the other
    side: `up` says which side is meant. Where edge_u x edge_v points away from it, the polygon is described from its other
    end, as the same surface in a right-handed frame, which is all that renderers, ports and cases ever see: corner + edge_u,
    -edge_u, and maps with their columns reversed, normals negated in x.
    """

    corner: ArrayLike
    """(3,) world position of (u, v) = (0, 0)."""
    edge_u: ArrayLike
    """(3,) world vector along u."""
    edge_v: ArrayLike
    """(3,) world vector along v, not parallel to edge_u."""
    height_map: ArrayLike
    """(H, W) in [0, 1]: 0 is the polygon, 1 the top of the volume."""
    color_map: ArrayLike
    """(h, w, 3), linear, in [0, 1]."""
    height_scale: float
    """World units of height 1, > 0."""
    normal_map: ArrayLike | None = None
    """(h, w, 3) in [0, 1], normal = 2 c - 1 in the frame x = edge_u/|edge_u|, y = n x x, z = n. None: from the heights."""
    facade_map: ArrayLike | None = None
    """(h, w, 3), the tile that covers steep walls; its bottom row stands on the ground. None: walls take the colour map."""
    facade_tile: tuple[float, float] = (1.0, 1.0)
    """Width and height of one facade tile in world units, > 0."""
    domain: str = "clip"
    """`"clip"`: the map ends at its border; "repeat": it tiles the plane (fetches wrap)."""
    up: ArrayLike | None = None
    """(3,) a direction on the side of the surface, not in the polygon's plane. None: edge_u x edge_v. A facade's tiles run
    along the edges of the right-handed frame, never mirrored."""

    def __post_init__(self) -> None:
        set_field = object.__setattr__
        for name in ("corner", "edge_u", "edge_v"):
            set_field(self, name, checks.vector(name, getattr(self, name)))
        set_field(self, "height_map", checks.texture("height_map", self.height_map, 1))
        set_field(self, "color_map", checks.texture("color_map", self.color_map, 3))
        for name in ("normal_map", "facade_map"):
            if getattr(self, name) is not None:
                set_field(self, name, checks.texture(name, getattr(self, name), 3))
        set_field(self, "height_scale", checks.number("height_scale", self.height_scale, above=0.0))
        tile = checks.vector("facade_tile", self.facade_tile, 2)
        if not (tile > 0.0).all():
            raise checks.reject("facade_tile", tile.tolist(), "a width and a height > 0")
        set_field(self, "facade_tile", (float(tile[0]), float(tile[1])))
        checks.choice("domain", self.domain, ("clip", "repeat"))
        self._check_edges()
        if self.up is not None:
            set_field(self, "up", checks.vector("up", self.up))
            if self._is_mirrored():
                self._mirror()

    def _is_mirrored(self) -> bool:
        """Whether edge_u x edge_v points away from `up`."""
        normal, up = np.cross(np.asarray(self.edge_u), np.asarray(self.edge_v)), np.asarray(self.up)
        along = float(normal @ up)
        if not abs(along) > 1e-12 * float(np.linalg.norm(normal) * np.linalg.norm(up)):
            raise checks.reject(
                "up", up.tolist(), f"a vector not in the polygon's plane, whose normal is {normal.tolist()}"
            )
        return along < 0.0

    def _mirror(self) -> None:
        """The same surface with u counted from the other end."""
        set_field = object.__setattr__
        corner, edge_u, _ = self.arrays
        set_field(self, "corner", checks.frozen(corner + edge_u))
        set_field(self, "edge_u", checks.frozen(-edge_u))
        for name in ("height_map", "color_map", "normal_map"):
            texels = getattr(self, name)
            if texels is not None:
                mirrored = np.ascontiguousarray(np.asarray(texels)[:, ::-1])
                if name == "normal_map":
                    mirrored[..., 0] = 1.0 - mirrored[..., 0]
                set_field(self, name, checks.frozen(mirrored))

    def _check_edges(self) -> None:
        """U and V must span an area, and the patch space they make must be invertible in float64."""
        edge_u, edge_v = np.asarray(self.edge_u), np.asarray(self.edge_v)
        lengths = float(np.linalg.norm(edge_u)), float(np.linalg.norm(edge_v))
        area = float(np.linalg.norm(np.cross(edge_u, edge_v)))
        if not area > 1e-12 * lengths[0] * lengths[1]:
            raise checks.reject("edge_v", edge_v.tolist(), f"a vector not parallel to edge_u = {edge_u.tolist()}")
        if not 1e-100 < area * self.height_scale < 1e100:
            raise checks.reject(
                "height_scale", self.height_scale, "a volume between 1e-100 and 1e100 cubic world units"
            )

    @property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """corner, edge_u and edge_v as arrays."""
        return np.asarray(self.corner), np.asarray(self.edge_u), np.asarray(self.edge_v)
