"""The raster stage: from quads to fragments, by the conventions' rules."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ibr_ref.oracle.programs.displacement.case import Bools, Case, Floats, Ints, Vector
from ibr_ref.oracle.programs.displacement.vertex import Quad


@dataclass(frozen=True)
class Fragments:
    """Covered pixels of the faces of one volume, in the order of submission; everything (F,)."""

    row: Ints
    column: Ints
    triangle: Ints
    """Rising; a triangle covers a pixel once."""
    face: Ints
    point: Vector
    """C, in patch space."""
    depth: Floats
    """Window depth of the face."""

    def at(self, pixels: Bools) -> Fragments:
        """Those of some pixels (H, W) of the picture."""
        mine = pixels[self.row, self.column]
        alone = {name: getattr(self, name)[mine] for name in ("row", "column", "triangle", "face", "depth")}
        return Fragments(**alone, point=[x[mine] for x in self.point])


class Raster(Case):
    """Clipping, coverage, interpolation."""

    def fragments(self, quads: Sequence[Quad], first_triangle: int) -> Fragments:
        """All fragments of the quads, whose triangles are numbered from `first_triangle` on."""
        parts = [
            self.rasterized(np.array(vertices), first_triangle + number, face)
            for number, (face, vertices) in enumerate(self.triangles(quads))
        ]
        if not parts:
            none = np.zeros(0, np.int64)
            return Fragments(none, none, none, none, [np.zeros(0)] * 3, np.zeros(0))
        rows, columns, triangles, faces, points, depths = zip(*parts, strict=True)
        return Fragments(
            np.concatenate(rows),
            np.concatenate(columns),
            np.concatenate(triangles),
            np.concatenate(faces),
            [np.concatenate(component) for component in zip(*points, strict=True)],
            np.concatenate(depths),
        )

    def triangles(self, quads: Sequence[Quad]) -> list[tuple[int, list[Floats]]]:
        """The quads' faces and corners, clip coordinates and varyings (7,), in the order of submission, after clipping."""
        return self.fanned(self.polygons(quads))

    def polygons(self, quads: Sequence[Quad]) -> list[tuple[int, list[Floats]]]:
        """The quads' faces, and what clipping leaves of each triangle."""
        return [(face, self.clipped(corners)) for face, corners in self.unclipped(quads)]

    def unclipped(self, quads: Sequence[Quad]) -> list[tuple[int, list[Floats]]]:
        """The quads' faces, and the corners of each triangle as they are."""
        found = []
        for quad in quads:
            vertices = np.concatenate([quad.clip, quad.patch], axis=1)
            found += [(quad.face, [vertices[i] for i in corners]) for corners in self.triangles_of(quad)]
        return found

    def fanned(self, polygons: Sequence[tuple[int, list[Floats]]]) -> list[tuple[int, list[Floats]]]:
        """Polygons as triangles, from their first corners."""
        return [(face, [corners[0], *pair]) for face, corners in polygons for pair in pairwise(corners[1:])]

    def triangles_of(self, quad: Quad) -> Sequence[tuple[int, int, int]]:
        """Corners of the two triangles."""
        return ((0, 1, 2), (0, 2, 3))

    # --- Clipping ----------------------------------------------------------------------------------------------------

    def near_distance(self, clip: Floats) -> Floats:
        """How far behind the near plane, >= 0: kept."""
        return clip[2]

    def far_distance(self, clip: Floats) -> Floats:
        """How far before the far plane, >= 0: kept."""
        return self.do.subtract(clip[3], clip[2])

    def clipped(self, polygon: list[Floats]) -> list[Floats]:
        """What is left of a polygon, corners (7,), between the near and the far plane.

        A corner on a plane may count as inside or outside: what is drawn is the same but for rounding. Only a polygon that
        lies in a plane is drawn or not.
        """
        return self.cut(self.cut(polygon, self.near_distance), self.far_distance)

    def may_lie_in_a_plane(self, polygon: list[Floats]) -> bool:
        """Whether rounding decides if anything is left of a polygon, corners (7,)."""
        planes = (self.near_distance, self.far_distance)
        return any(self._open([distance(corner) for corner in polygon]) for distance in planes)

    def _open(self, distances: Sequence[Floats]) -> bool:
        """Whether none is known to be negative, not to be, or no number: of a device's own numbers that is always known."""
        surely = self.do.surely
        return not any(surely(d >= 0.0) or surely(d < 0.0) or surely(d != d) for d in distances)

    def cut(self, polygon: list[Floats], distance: Callable[[Floats], Floats]) -> list[Floats]:
        """The part of a polygon where a distance is not negative."""
        kept: list[Floats] = []
        distances = [distance(vertex) for vertex in polygon]
        if self._open(distances):
            return polygon
        behind = [bool(d >= 0.0) for d in distances]
        for i, here in enumerate(behind):
            j = (i + 1) % len(polygon)
            if here:
                kept.append(polygon[i])
            if here != behind[j]:
                inside, outside = (i, j) if here else (j, i)
                way = self.do.subtract(distances[inside], distances[outside])
                kept.append(self.do.lerp(polygon[inside], polygon[outside], self.do.divide(distances[inside], way)))
        return kept

    # --- Coverage ----------------------------------------------------------------------------------------------------

    def window(self, clip: Floats) -> tuple[Floats, Floats]:
        """Window x and y of clip coordinates (n, 4)."""
        x, y, _, w = clip.T
        return self.window_x(self.do.divide(x, w)), self.window_y(self.do.divide(y, w))

    def window_x(self, ndc: Floats) -> Floats:
        """(x + 1)/2 width."""
        return self.do.multiply(self.do.divide(self.do.add(ndc, 1.0), 2.0), self.width)

    def window_y(self, ndc: Floats) -> Floats:
        """(1 - y)/2 height: downwards."""
        return self.do.multiply(self.do.divide(self.do.subtract(1.0, ndc), 2.0), self.height)

    def snapped(self, window: Floats) -> Ints:
        """A window coordinate in whole subpixels."""
        return np.rint(self.do.snap(window) * self.subpixels()).astype(np.int64)

    def subpixels(self) -> int:
        """Subpixels a pixel."""
        return int(2**self.do.policy.subpixel_bits)

    def centre(self) -> float:
        """Where in a pixel its centre is."""
        return 0.5

    def varying_centre(self) -> float:
        """Where varyings are evaluated."""
        return self.centre()

    def rasterized(
        self, vertices: Floats, triangle: int, face: int
    ) -> tuple[Ints, Ints, Ints, Ints, list[Floats], Floats]:
        """The fields of `Fragments` of one triangle (3, 7)."""
        window = self.window(vertices[:, :4])
        x, y = (self.snapped(axis) for axis in window)
        row, column = self.pixels(x, y)
        edges, covered = self.coverage(x, y, row, column)
        row, column = row[covered], column[covered]
        weights = self.weights(window, [edge[covered] for edge in edges], row, column)
        w = vertices[:, 3]
        point = [self.varying(weights, vertices[:, 4 + k], w) for k in range(3)]
        depth = self.face_depth(weights, self.do.divide(vertices[:, 2], w), w)
        return row, column, np.full(len(row), triangle), np.full(len(row), self.face_number(face)), point, depth

    def face_number(self, face: int) -> int:
        """The face's number as it is written."""
        return face

    def pixels(self, x: Ints, y: Ints) -> tuple[Ints, Ints]:
        """Rows and columns of all pixels of the picture around snapped corners."""
        unit = self.subpixels()
        rows = np.arange(max(0, y.min() // unit - 1), min(self.height, y.max() // unit + 2))
        columns = np.arange(max(0, x.min() // unit - 1), min(self.width, x.max() // unit + 2))
        row, column = np.meshgrid(rows, columns, indexing="ij")
        return row.ravel(), column.ravel()

    def coverage(self, x: Ints, y: Ints, row: Ints, column: Ints) -> tuple[list[Ints], Bools]:
        """Edge functions of pixel centres, positive inside, and which are inside by the top-left rule."""
        unit = self.subpixels()
        px = column * unit + int(self.centre() * unit)
        py = row * unit + int(self.centre() * unit)
        area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0])
        covered = np.full(len(px), area != 0 and self.draws_orientation(int(area)))
        edges = []
        for a, b in ((1, 2), (2, 0), (0, 1)):
            dx, dy = np.sign(area) * (x[b] - x[a]), np.sign(area) * (y[b] - y[a])
            edge = dx * (py - y[a]) - dy * (px - x[a])
            covered &= (edge > 0) | ((edge == 0) & self.owns_border(int(dx), int(dy)))
            edges.append(edge)
        return edges, covered

    def draws_orientation(self, area: int) -> bool:
        """Both."""
        return True

    def owns_border(self, dx: int, dy: int) -> bool:
        """Whether an edge, run through clockwise, is a top or a left one."""
        return dy < 0 or (dy == 0 and dx > 0)

    # --- Interpolation -----------------------------------------------------------------------------------------------

    def weights(self, window: tuple[Floats, Floats], edges: Sequence[Ints], row: Ints, column: Ints) -> list[Floats]:
        """Barycentrics up to a factor: the edge functions, or those of the corners as they were before snapping."""
        if self.do.policy.snapped_varyings and self.varying_centre() == self.centre():
            return [self.do.number(edge) for edge in edges]
        x, y = window
        if self.do.policy.snapped_varyings:
            x, y = (self.snapped(c) / self.subpixels() for c in window)
        px, py = column + self.varying_centre(), row + self.varying_centre()
        weights = []
        for a, b in ((1, 2), (2, 0), (0, 1)):
            ways = [self.do.subtract(*pair) for pair in ((x[b], x[a]), (py, y[a]), (y[b], y[a]), (px, x[a]))]
            weights.append(self.do.dot([ways[0], -ways[2]], [ways[1], ways[3]]))
        return weights

    def varying(self, weights: Sequence[Floats], values: Floats, w: Floats) -> Floats:
        """A perspective-correct varying: a sum over the corners, or by plane equations from the first corner on."""
        w = [self.perspective(wi) for wi in w]
        over_w = [self.do.divide(self.do.multiply(e, a), wi) for e, a, wi in zip(weights, values, w, strict=True)]
        mixed = self.do.divide(
            self.do.sum(over_w), self.do.sum([self.do.divide(*pair) for pair in zip(weights, w, strict=True)])
        )
        return self.do.either(mixed, *(lambda i=i: self.by_planes(weights, values, w, i) for i in range(3)))

    def by_planes(self, weights: Sequence[Floats], values: Sequence[Floats], w: Sequence[Floats], first: int) -> Floats:
        """Varyings over w by plane equations, as rasterizers set them up."""
        order = [first, (first + 1) % 3, (first + 2) % 3]
        total = self.do.sum(weights)
        shares = [self.do.divide(weights[i], total) for i in order[1:]]
        planes = [self.do.divide(values[i], w[i]) for i in order], [self.do.divide(1.0, w[i]) for i in order]
        over, under = (self.do.dot([q[0], *(self.do.subtract(x, q[0]) for x in q[1:])], [1.0, *shares]) for q in planes)
        return self.do.divide(over, under)

    def perspective(self, w: Floats) -> Floats:
        """What a corner's varyings are divided by."""
        return w

    def face_depth(self, weights: Sequence[Floats], z: Floats, w: Floats) -> Floats:
        """Window depth, linear in window space; z in [0, 1]."""
        total = self.do.sum(weights)
        return self.do.dot([self.do.divide(e, total) for e in weights], list(z))
