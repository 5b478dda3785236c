"""Shading: normal, albedo and colour of a hit (section 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Hits
from ibr_ref.oracle.programs.displacement.self_shadow import SelfShadow

LEAST_DIFFERENCE = 2.0**-16
"""Differences of heights below it count as none."""


@dataclass(frozen=True)
class Shaded:
    """Of each fragment, (F,); vectors NaN where it is discarded."""

    albedo: Vector
    normal: Vector
    color: Vector
    lit: Bools


class Shade(SelfShadow):
    """From hits to colours."""

    def shade(self, patch: Patch, hits: Hits) -> Shaded:
        """All fragments of a patch."""
        kept = np.flatnonzero(hits.hit_index >= 0)
        hit = [x[kept] for x in hits.point]
        wall = hits.steep[kept] & (patch.facade is not None)
        with self.do.one_place():
            normal, albedo = self.looks(patch, hit, wall)
        lit = np.asarray(self.lit(patch, hit))
        color = self.colored(patch, hit, albedo, normal, lit)

        count, spread = len(hits.hit_index), self.do.spread
        vectors = [[spread(x, kept, count, np.nan) for x in vector] for vector in (albedo, normal, color)]
        return Shaded(vectors[0], vectors[1], vectors[2], spread(lit, kept, count, False))

    def looks(self, patch: Patch, hit: Vector, wall: Bools) -> tuple[Vector, Vector]:
        """Normal and albedo."""
        gradient = self.gradient(patch, hit)
        normal, albedo = self.surface_normal(patch, hit, gradient), self.color_at(patch, hit[0], hit[1])
        some = np.flatnonzero(wall)
        if len(some):
            there, slope = [x[some] for x in hit], (gradient[0][some], gradient[1][some])
            found = self.wall_normal(patch, there, slope), self.facade_at(patch, there, slope)
            normal, albedo = (
                [self.do.replaced(x, some, w) for x, w in zip(vector, wall_vector, strict=True)]
                for vector, wall_vector in zip((normal, albedo), found, strict=True)
            )
        return normal, albedo

    def chosen(self, where: Bools, first: Vector, second: Vector) -> Vector:
        """A vector here, another elsewhere."""
        return [np.where(where, a, b) for a, b in zip(first, second, strict=True)]

    # --- Normals -----------------------------------------------------------------------------------------------------

    def gradient(self, patch: Patch, hit: Vector) -> tuple[Floats, Floats]:
        """g_u and g_v, central differences over two texels."""
        u, v, _ = hit
        rows, columns = patch.heights.shape
        step_u, step_v = self.do.divide(1.0, float(columns)), self.do.divide(1.0, float(rows))
        across = self.do.subtract(
            self.height_at(patch, self.do.add(u, step_u), v), self.height_at(patch, self.do.subtract(u, step_u), v)
        )
        along = self.do.subtract(
            self.height_at(patch, u, self.do.add(v, step_v)), self.height_at(patch, u, self.do.subtract(v, step_v))
        )
        return self.slope(across, columns), self.slope(along, rows)

    def slope(self, difference: Floats, size: int) -> Floats:
        """The derivative of a difference over two texels."""
        none = np.asarray(np.abs(difference) < LEAST_DIFFERENCE)
        up = np.asarray((difference >= LEAST_DIFFERENCE) & ~none)
        return self.do.multiply(np.where(none, 0.0, self.do.beyond(difference, LEAST_DIFFERENCE, up)), size / 2.0)

    def surface_normal(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Vector:
        """The unit normal of the surface: from the normal map, or without one from the heights."""
        if patch.normals is None:
            return self.height_normal(patch, gradient)
        code = self.fetch(patch.normals, hit[0], hit[1], patch.repeat).T
        tangent = self.do.unit(patch.edge_u)
        frame = [tangent, self.bitangent(patch.normal, tangent), patch.normal]
        mapped = self.combined(frame, [self.decoded(x) for x in code])
        vanishes = np.asarray((mapped[0] == 0.0) & (mapped[1] == 0.0) & (mapped[2] == 0.0))  # texels that cancel
        return self.chosen(vanishes, patch.normal, self.normalized(mapped))

    def bitangent(self, normal: Vector, tangent: Vector) -> Vector:
        """n x x."""
        return self.cross(normal, tangent)

    def decoded(self, code: Floats) -> Floats:
        """2 c - 1."""
        return self.multiply_add(code, 2.0, -1.0)

    def normalized(self, vector: Vector) -> Vector:
        """A mapped normal, of length 1."""
        return self.do.unit(vector)

    def height_normal(self, patch: Patch, gradient: tuple[Floats, Floats]) -> Vector:
        """normalize(n - s (g_u U* + g_v V*)), or the cross product of the tangents."""
        uphill = self.uphill(patch, gradient)
        ours = self.do.unit([self.multiply_add(-patch.scale, x, n) for n, x in zip(patch.normal, uphill, strict=True)])
        if not self.right("uphill"):
            return ours
        return self.do.either(ours, lambda: self.crossed_tangents(patch, gradient))

    def crossed_tangents(self, patch: Patch, gradient: tuple[Floats, Floats]) -> Vector:
        """The unit cross product of U + g_u s n and V + g_v s n."""
        tangents = [
            [self.multiply_add(g, up, edge) for up, edge in zip(patch.up, edges, strict=True)]
            for g, edges in zip(gradient, (patch.edge_u, patch.edge_v), strict=True)
        ]
        return self.do.unit(self.cross(tangents[0], tangents[1]))

    def uphill(self, patch: Patch, gradient: tuple[Floats, Floats]) -> Vector:
        """g_u U* + g_v V*: the world's gradient of H."""
        return self.combined(patch.rows[:2], gradient)

    # --- Walls -------------------------------------------------------------------------------------------------------

    def wall_normal(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Vector:
        """Downhill; where the map is flat, towards the eye, as far as that is horizontal; else n."""
        downhill: Vector = self.do.unit([-x for x in self.uphill(patch, gradient)])
        way = self.towards(patch.eye, hit)
        backwards = self.do.unit(self.combined([patch.edge_u, patch.edge_v], way[:2]))
        straight_down = np.asarray((way[0] == 0.0) & (way[1] == 0.0))
        flat = np.asarray(self.flat(gradient))
        return self.chosen(flat, self.chosen(straight_down, patch.normal, backwards), downhill)

    def flat(self, gradient: tuple[Floats, Floats]) -> Bools:
        """g = 0."""
        return (gradient[0] == 0.0) & (gradient[1] == 0.0)

    def faces_u(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Bools:
        """Whether a wall faces along u, rather than along v."""
        lengths = self.edge_lengths(patch)
        slopes = [self.do.divide(np.abs(g), length) for g, length in zip(gradient, lengths, strict=True)]
        way = self.towards(patch.eye, hit)
        ways = [self.do.multiply(np.abs(way[k]), lengths[k]) for k in (0, 1)]
        return np.where(self.flat(gradient), ways[0] >= ways[1], slopes[0] >= slopes[1])

    def edge_lengths(self, patch: Patch) -> tuple[Floats, Floats]:
        """|U| and |V|."""
        return (
            self.do.root(self.do.dot(patch.edge_u, patch.edge_u)),
            self.do.root(self.do.dot(patch.edge_v, patch.edge_v)),
        )

    def facade_at(self, patch: Patch, hit: Vector, gradient: tuple[Floats, Floats]) -> Vector:
        """The tile on a wall: along it, and up from the ground."""
        assert patch.facade is not None
        across, down = self.facade_place(patch, hit, np.asarray(self.faces_u(patch, hit, gradient)))
        return list(self.facade_fetch(patch.facade, across, down).T)

    def facade_place(self, patch: Patch, hit: Vector, faces_u: Bools) -> tuple[Floats, Floats]:
        """Tiles across and down."""
        u, v, h = hit
        length_u, length_v = self.edge_lengths(patch)
        along = np.where(faces_u, self.do.multiply(v, length_v), self.do.multiply(u, length_u))
        across = self.do.divide(along, patch.facade_tile[0])
        return across, self.facade_row(self.do.divide(self.do.multiply(h, patch.scale), patch.facade_tile[1]))

    def facade_row(self, tiles_up: Floats) -> Floats:
        """Rows run down: the bottom row stands on the ground."""
        return -tiles_up

    def facade_fetch(self, facade: Floats, across: Floats, down: Floats) -> Floats:
        """Repeated."""
        return self.fetch(facade, across, down, True)

    # --- Light -------------------------------------------------------------------------------------------------------

    def colored(self, patch: Patch, hit: Vector, albedo: Vector, normal: Vector, lit: Bools) -> Vector:
        """Phong's colour, clamped."""
        world = self.to_world(patch, hit)
        to_light, to_eye = self.do.unit(self.light_way(patch, world)), self.do.unit(self.eye_way(patch, world))
        cosine = self.do.dot(normal, to_light)
        brightness = self.brightness(self.diffuse_cosine(cosine), lit)
        highlight = self.highlights(normal, to_light, to_eye, cosine, lit)
        return [self.clamped(self.lighted(color, brightness, highlight)) for color in albedo]

    def highlights(self, normal: Vector, to_light: Vector, to_eye: Vector, cosine: Floats, lit: Bools) -> Floats:
        """Of all hits, 0 where there is none."""
        if self.scene.light.specular == 0.0:
            return np.zeros(lit.shape)
        return np.where(self.shines(cosine, lit), self.highlight(normal, to_light, to_eye, cosine), 0.0)

    def light_way(self, patch: Patch, world: Vector) -> Vector:
        """From hits towards the light."""
        return self.towards(self.light, world)

    def eye_way(self, patch: Patch, world: Vector) -> Vector:
        """From hits towards the eye."""
        return self.towards(self.eye, world)

    def diffuse_cosine(self, cosine: Floats) -> Floats:
        """max(0, n.l)."""
        return np.maximum(cosine, 0.0)

    def brightness(self, cosine: Floats, lit: Bools) -> Floats:
        """Ambient + diffuse lit max(0, n.l)."""
        return self.multiply_add(self.do.number(self.scene.light.diffuse), np.where(lit, cosine, 0.0), self.ambient())

    def ambient(self) -> Floats:
        """Ambient coefficient."""
        return self.do.number(self.scene.light.ambient)

    def exponent(self) -> int:
        """Specular exponent."""
        return int(self.scene.light.exponent)

    def shines(self, cosine: Floats, lit: Bools) -> Bools:
        """Where there is a highlight."""
        return lit & (cosine > 0.0)

    def highlight(self, normal: Vector, to_light: Vector, to_eye: Vector, cosine: Floats) -> Floats:
        """Specular max(0, r.v)^e, with r.v also as 2 (n.l)(n.v) - l.v."""
        base = self.do.dot(self.reflected(normal, to_light, cosine), to_eye)
        if self.right("reflected"):
            base = self.do.either(base, lambda: self.reflected_cosine(normal, to_light, to_eye, cosine))
        base = np.maximum(base, 0.0)
        return self.do.multiply(self.do.number(self.scene.light.specular), self.do.power(base, self.exponent()))

    def reflected_cosine(self, normal: Vector, to_light: Vector, to_eye: Vector, cosine: Floats) -> Floats:
        """2 (n.l)(n.v) - l.v."""
        both = self.do.multiply(2.0, self.do.multiply(cosine, self.do.dot(normal, to_eye)))
        return self.do.subtract(both, self.do.dot(to_light, to_eye))

    def reflected(self, normal: Vector, to_light: Vector, cosine: Floats) -> Vector:
        """R = 2 (n.l) n - l."""
        twice = self.do.multiply(2.0, cosine)
        return [self.multiply_add(twice, n, -l) for n, l in zip(normal, to_light, strict=True)]

    def lighted(self, albedo: Floats, brightness: Floats, highlight: Floats) -> Floats:
        """Albedo times brightness, and the highlight on top."""
        return self.multiply_add(albedo, brightness, highlight)

    def clamped(self, color: Floats) -> Floats:
        """To [0, 1]."""
        return np.clip(color, 0.0, 1.0)
