"""Bugs of shading: normals and albedo."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.rounding import half
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.port import Port

SHADE = Bugs("shade")

# --- Normals ---------------------------------------------------------------------------------------------------------


@SHADE.add("gradient without 1/2")
class _DoubleGradient(Port):
    """A difference over two texels is multiplied by the size instead of half of it."""

    def slope(self, difference: Floats, size: int) -> Floats:
        return super().slope(difference, 2 * size)


@SHADE.add("gradient threshold 1/256", small=True)
class _CoarseThreshold(Port):
    """Differences below 1/256 count as none, as if heights were bytes."""

    def slope(self, difference: Floats, size: int) -> Floats:
        none = np.asarray(np.abs(difference) < 2.0**-8)
        up = np.asarray((difference >= 2.0**-8) & ~none)
        return self.do.multiply(np.where(none, 0.0, self.do.beyond(difference, 2.0**-8, up)), size / 2.0)


@SHADE.add("forward differences")
class _ForwardDifferences(Port):
    """H(u + 1/W, v) - H(u, v), times W."""

    def gradient(self, patch: Patch, hit: Vector) -> tuple[Floats, Floats]:
        u, v, _ = hit
        rows, columns = patch.heights.shape
        here = self.height_at(patch, u, v)
        across = self.do.subtract(self.height_at(patch, self.do.add(u, 1.0 / columns), v), here)
        along = self.do.subtract(self.height_at(patch, u, self.do.add(v, 1.0 / rows)), here)
        return self.slope(across, 2 * columns), self.slope(along, 2 * rows)


@SHADE.add("gradient along the edges")
class _EdgesForReciprocals(Port):
    """U/|U|^2 and V/|V|^2 stand for U* and V*: the same only for rectangles."""

    def uphill(self, patch: Patch, gradient: tuple[Floats, Floats]) -> Vector:
        edges = (patch.edge_u, patch.edge_v)
        vectors = [self.scaled(edge, self.do.divide(1.0, self.do.dot(edge, edge))) for edge in edges]
        return self.combined(vectors, gradient)


@SHADE.add("normal without the height scale")
class _UnscaledNormal(Port):
    """n - (g_u U* + g_v V*)."""

    def height_normal(self, patch: Patch, gradient: tuple[Floats, Floats]) -> Vector:
        return self.do.unit([n - x for n, x in zip(patch.normal, self.uphill(patch, gradient), strict=True)])


@SHADE.add("normal uphill")
class _NormalUphill(Port):
    """n + s (g_u U* + g_v V*)."""

    def height_normal(self, patch: Patch, gradient: tuple[Floats, Floats]) -> Vector:
        return super().height_normal(patch, (-gradient[0], -gradient[1]))


@SHADE.add("mapped normal not normalized")
class _LongMapped(Port):
    """The filtered normal is used as it is."""

    def normalized(self, vector: Vector) -> Vector:
        return vector


@SHADE.add("mapped normal in [0, 1]")
class _Undecoded(Port):
    """c instead of 2 c - 1."""

    def decoded(self, code: Floats) -> Floats:
        return code


@SHADE.add("mapped normal decoded from 127", small=True)
class _Decoded127(Port):
    """(255 c - 128)/127, as signed bytes are."""

    def decoded(self, code: Floats) -> Floats:
        return self.do.divide(self.multiply_add(code, 255.0, -128.0), 127.0)


@SHADE.add("tangent frame left-handed")
class _LeftHanded(Port):
    """y = x x n: green points the other way."""

    def bitangent(self, normal: Vector, tangent: Vector) -> Vector:
        return self.cross(tangent, normal)


@SHADE.add("normals in 8 bits", small=True)
class _ByteNormals(Port):
    """Normals go through an 8-bit buffer."""

    def surface_normal(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Vector:
        return [np.rint(127.0 * x) / 127.0 for x in super().surface_normal(patch, hit, gradient)]


# --- Walls -----------------------------------------------------------------------------------------------------------


@SHADE.add("facade upside down")
class _FacadeDown(Port):
    """The facade's top row stands on the ground."""

    def facade_row(self, tiles_up: Floats) -> Floats:
        return tiles_up


@SHADE.add("facade tile's sides swapped")
class _SwappedTile(Port):
    """Width for height of the tile."""

    def facade_at(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Vector:
        turned = type(patch)(**{**vars(patch), "facade_tile": patch.facade_tile[::-1]})
        return super().facade_at(turned, hit, gradient)


@SHADE.add("facade along the other edge")
class _OtherEdge(Port):
    """The facade runs along u on walls that face u."""

    def faces_u(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Bools:
        return ~super().faces_u(patch, hit, gradient)


@SHADE.add("facing without the edges' lengths", small=True)
class _FacingByGradient(Port):
    """|g_u| >= |g_v| in patch units: other walls where |U| and |V| differ."""

    def faces_u(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Bools:
        steeper = np.abs(gradient[0]) >= np.abs(gradient[1])
        return np.where(np.asarray(self.flat(gradient)), super().faces_u(patch, hit, gradient), steeper)


@SHADE.add("facade clamped")
class _ClampedFacade(Port):
    """The facade is not repeated."""

    def facade_fetch(self, facade: Floats, across: Floats, down: Floats) -> Floats:
        return self.fetch(facade, across, down, False)


@SHADE.add("facade in BGR")
class _FacadeBgr(Port):
    """Red and blue of the facade are swapped."""

    def facade_fetch(self, facade: Floats, across: Floats, down: Floats) -> Floats:
        return super().facade_fetch(facade[..., ::-1], across, down)


@SHADE.add("walls with the surface's normal")
class _WallAsSurface(Port):
    """Steep hits keep the normal of the height field, its share of n included."""

    def wall_normal(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Vector:
        return self.height_normal(patch, gradient)


@SHADE.add("flat walls face up", small=True)
class _FlatFacesUp(Port):
    """Where the gradient vanishes on a wall, its normal is n instead of towards the eye."""

    def wall_normal(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Vector:
        return self.chosen(np.asarray(self.flat(gradient)), patch.normal, super().wall_normal(patch, hit, gradient))


# --- Colour map ------------------------------------------------------------------------------------------------------


@SHADE.add("colours in BGR")
class _Bgr(Port):
    """Red and blue of the colour map are swapped."""

    def color_at(self, patch: Patch, u: Floats, v: Floats) -> Vector:
        return super().color_at(patch, u, v)[::-1]


@SHADE.add("nearest colours")
class _NearestColors(Port):
    """The colour map is not filtered."""

    def color_at(self, patch: Patch, u: Floats, v: Floats) -> Vector:
        rows, columns = patch.colors.shape[:2]
        row = self.wrapped(self.do.whole(v * rows), rows, patch.repeat)
        texels = patch.colors[row, self.wrapped(self.do.whole(u * columns), columns, patch.repeat)]
        return [self.do.number(channel) for channel in texels.T]


@SHADE.add("colours half a texel off")
class _ColorsHalfTexel(Port):
    """The colour map is fetched at u + 1/(2W), v + 1/(2H)."""

    def color_at(self, patch: Patch, u: Floats, v: Floats) -> Vector:
        rows, columns = patch.colors.shape[:2]
        return super().color_at(patch, self.do.add(u, 0.5 / columns), self.do.add(v, 0.5 / rows))


@SHADE.add("colours wrap at the border")
class _WrappedColors(Port):
    """The colour map is repeated although it ends at its border."""

    def color_at(self, patch: Patch, u: Floats, v: Floats) -> Vector:
        return list(self.fetch(patch.colors, u, v, True).T)


@SHADE.add("colours in half precision", small=True, hidden="below the steps of an 8-bit picture")
class _HalfColors(Port):
    """The colour map holds 16-bit floats."""

    def color_at(self, patch: Patch, u: Floats, v: Floats) -> Vector:
        return [half(x) for x in super().color_at(patch, u, v)]


@SHADE.add("colours from sRGB")
class _Linearized(Port):
    """The colour map is fetched as sRGB, about the square of it."""

    def color_at(self, patch: Patch, u: Floats, v: Floats) -> Vector:
        return [x**2.2 for x in super().color_at(patch, u, v)]
