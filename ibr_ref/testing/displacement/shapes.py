"""Where polygons lie, and what is special in the patch space (u, v, h) of one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from ibr_ref.array_types import Floats
from ibr_ref.scene import BasePolygon
from ibr_ref.testing.displacement.maps import SIZES, aligned_height_maps, colors, height_maps, normal_maps
from ibr_ref.testing.numbers import often, real


@dataclass(frozen=True)
class Shape:
    """Where a polygon lies: corner, edges and the height of its volume, in world units."""

    corner: Floats
    edge_u: Floats
    edge_v: Floats
    height_scale: float

    @property
    def up(self) -> Floats:
        """The edge of the volume along h."""
        normal = np.cross(self.edge_u, self.edge_v)
        return self.height_scale * normal / float(np.linalg.norm(normal))

    @property
    def extent(self) -> float:
        """Half of what a picture must show of the volume, in world units."""
        return 0.5 * float(np.linalg.norm(self.edge_u) + np.linalg.norm(self.edge_v))

    def vector(self, patch: Floats) -> Floats:
        """A direction of patch space in world space."""
        found: Floats = patch[0] * self.edge_u + patch[1] * self.edge_v + patch[2] * self.up
        return found

    def point(self, patch: Floats) -> Floats:
        """A point of patch space in world space; exact where the polygon is a unit square at the origin."""
        return self.corner + self.vector(patch)


@st.composite
def points(draw: DrawFn, u: SearchStrategy[float], v: SearchStrategy[float], h: SearchStrategy[float]) -> Floats:
    """A point or direction in patch space."""
    return np.array([draw(u), draw(v), draw(h)])


@st.composite
def unit_shapes(draw: DrawFn) -> Shape:
    """A unit square at the origin: patch space is exact there."""
    height_scale = draw(st.sampled_from([1.0, 0.5, 0.25]))
    return Shape(np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), height_scale)


@st.composite
def shapes(draw: DrawFn) -> Shape:
    """Unit squares, sheared rectangles, and any parallelogram at any scale."""
    if (kind := draw(st.sampled_from(["unit", "sheared", "free", "free"]))) == "unit":
        return draw(unit_shapes())
    side = real(0.3, 2.0)
    if kind == "sheared":
        edge_v = np.array([draw(real(-1.5, 1.5)), draw(side), 0.0])
        edge_u = np.array([draw(side), 0.0, 0.0])
        return Shape(np.array([-0.5, -0.5, 0.0]), edge_u, edge_v, draw(real(0.1, 1.0)))
    world = draw(often(1.0, 0.01, 0.3, 100.0))
    edge_u = np.array(draw(st.tuples(side, real(-1.0, 1.0), real(-1.0, 1.0))))
    across = np.cross(edge_u, np.array([draw(real(-0.3, 0.3)), draw(real(-1.0, 1.0)), 1.0]))
    edge_v = draw(side) * across + draw(real(-0.7, 0.7)) * edge_u
    corner = np.array(draw(st.tuples(*[real(-3.0, 3.0)] * 3)))
    return Shape(world * corner, world * edge_u, world * edge_v, world * draw(real(0.05, 1.5)))


@st.composite
def neighbours(draw: DrawFn, first: Shape) -> Shape:
    """A polygon that may hide the first one: the next tile, one over it, one through it, or the very same again."""
    kind = draw(st.sampled_from(["beside", "over", "through", "same"]))
    if kind == "beside":
        return Shape(first.corner + first.edge_u, first.edge_u, first.edge_v, first.height_scale)
    if kind == "over":
        lift = np.array([draw(real(-0.5, 0.5)), draw(real(-0.5, 0.5)), draw(real(0.1, 1.5, 1.0))])
        return Shape(first.point(lift), first.edge_u, first.edge_v, draw(real(0.3, 1.0)) * first.height_scale)
    if kind == "through":
        corner = first.point(np.array([0.2, 0.1, draw(real(-0.5, 1.0))]))
        length = float(np.linalg.norm(first.edge_v))
        return Shape(corner, first.edge_u, first.up * (length / first.height_scale), draw(real(0.1, 0.5)) * length)
    return first


@st.composite
def polygons(
    draw: DrawFn, shape: Shape, domain: str, aligned: bool, sizes: SearchStrategy[tuple[int, int]] = SIZES
) -> BasePolygon:
    """The polygon of a shape, with its maps; sizes: of height maps that are not aligned."""
    width = float(np.linalg.norm(shape.edge_u))
    return BasePolygon(
        corner=shape.corner,
        edge_u=shape.edge_u,
        edge_v=shape.edge_v,
        height_map=draw(aligned_height_maps() if aligned else height_maps(sizes)),
        color_map=draw(colors()),
        height_scale=shape.height_scale,
        normal_map=draw(st.one_of(st.none(), normal_maps())),
        facade_map=draw(colors(4) if aligned else st.one_of(st.none(), colors(4))),
        facade_tile=(width * draw(real(0.05, 2.0)), shape.height_scale * draw(real(0.05, 2.0, 1.0))),
        domain=domain,
    )
