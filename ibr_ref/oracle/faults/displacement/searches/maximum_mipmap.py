"""Bugs of quadtree displacement mapping."""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.quadtree import Quadtree, build
from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.searches.maximum_mipmap import HIT, Ends, MaximumMipmap, States, Walk

MAXIMUM_MIPMAP = Bugs("march")
ONLY = ("maximum_mipmap",)


@MAXIMUM_MIPMAP.add("means in the quadtree", only=ONLY)
class _Means(MaximumMipmap):
    """The levels are made of means, as a common mip chain is, not of maxima: nodes that reach up to the ray are missed."""

    def tree(self, patch: Patch) -> Quadtree:
        tree, parts = super().tree(patch), []
        fine = tree.values[: tree.columns[0] * tree.rows[0]].reshape(tree.rows[0], tree.columns[0])
        for rows, columns in zip(tree.rows[1:], tree.columns[1:], strict=True):
            parts.append(fine)
            even = np.pad(fine, [(0, fine.shape[0] % 2), (0, fine.shape[1] % 2)], "edge")
            fine = even.reshape(rows, 2, columns, 2).mean(axis=(1, 3))
        return tree._replace(values=np.concatenate([part.reshape(-1) for part in [*parts, fine]]))


@MAXIMUM_MIPMAP.add("maxima of single texels", only=ONLY)
class _Texels(MaximumMipmap):
    """The finest level holds texels, not the largest of the four around each cell: patches beside a peak are passed over."""

    def tree(self, patch: Patch) -> Quadtree:
        tree, values = super().tree(patch), None
        heights = np.asarray(self.scene.polygons[patch.number].height_map, np.float64)
        border = [(0, 0), (0, 0)] if patch.repeat else [(1, 0), (1, 0)]
        values = np.array(tree.values)
        values[: tree.columns[0] * tree.rows[0]] = np.pad(heights, border, "edge").reshape(-1)
        return tree._replace(values=values)


@MAXIMUM_MIPMAP.add("minima in the quadtree", only=ONLY)
class _Minima(MaximumMipmap):
    """The levels hold the least heights of their cells, as of a map of depths, not the largest."""

    def tree(self, patch: Patch) -> Quadtree:
        tree = super().tree(patch)
        heights = np.asarray(self.scene.polygons[patch.number].height_map, np.float64)
        opposite = build(1.0 - heights, patch.repeat)
        return tree._replace(values=1.0 - opposite.values)


@MAXIMUM_MIPMAP.add("maxima taken for depths", only=ONLY)
class _TakenForDepths(MaximumMipmap):
    """The depth of a node's highest point is taken to be its maximum m, not 1 - m."""

    def highest(self, tree: Quadtree, level: Ints, index: list[Ints]) -> Floats:
        return self.do.subtract(1.0, super().highest(tree, level, index))


@MAXIMUM_MIPMAP.add("sizes of levels rounded down", only=ONLY)
class _RoundedDown(MaximumMipmap):
    """A level has half as many nodes as the one before, rounded down, as in a mip chain: the last odd cells are in none."""

    def highest(self, tree: Quadtree, level: Ints, index: list[Ints]) -> Floats:
        last = [np.maximum((size >> level) - 1, 0) for size in (tree.columns[0], tree.rows[0])]
        return super().highest(tree, level, [np.minimum(i, end) for i, end in zip(index, last, strict=True)])


@MAXIMUM_MIPMAP.add("borders of rays that go right and down", only=ONLY)
class _OneDirection(MaximumMipmap):
    """A ray is taken to leave a node across its right and lower border, wherever it goes."""

    def border(self, ahead: Bools, first: Ints, stop: Ints) -> Ints:
        return stop


@MAXIMUM_MIPMAP.add("too few nodes", only=ONLY)
class _FewNodes(MaximumMipmap):
    """The loop ends after 8 nodes, before the slower rays have met the surface."""

    counts_nodes = True

    def most_nodes(self) -> int:
        return 8


@MAXIMUM_MIPMAP.add("the other root in the cell", only=ONLY)
class _OtherRoot(MaximumMipmap):
    """Of the quadratic's two roots that where the ray comes out of the surface again, clamped to the cell."""

    def crossing(self, start: Floats, rise: Floats, bend: Floats, slope: int) -> Floats:
        root = self.do.root(self.do.greatest(self.discriminant(start, rise, bend), 0.0))
        return self.do.divide(-self.do.add(rise, root), self.do.multiply(bend, 2.0))


class _Straight(MaximumMipmap):
    """The end of the cell says whether the surface is met in it."""

    def comes_up(self, start: Floats, rise: Floats, bend: Floats, end: Floats) -> Bools:
        return end > 0.0


@MAXIMUM_MIPMAP.add("secant in the cell", only=ONLY)
class _Secant(_Straight):
    """The surface in a cell is taken for straight along the ray: a secant in place of the quadratic."""

    def crossing(self, start: Floats, rise: Floats, bend: Floats, slope: int) -> Floats:
        return self.do.divide(-start, self.do.add(rise, bend))


@MAXIMUM_MIPMAP.add("hit where the ray leaves the cell", only=ONLY)
class _CellEnd(_Straight):
    """The end of the ray in the cell is the hit, not where it meets the surface."""

    def crossing(self, start: Floats, rise: Floats, bend: Floats, slope: int) -> Floats:
        return self.do.in_lanes(1.0, start)


@MAXIMUM_MIPMAP.add("hit in the middle of the cell", only=ONLY)
class _CellMiddle(_Straight):
    """The middle of the ray in the cell is the hit."""

    def crossing(self, start: Floats, rise: Floats, bend: Floats, slope: int) -> Floats:
        return self.do.in_lanes(0.5, start)


@MAXIMUM_MIPMAP.add("hit where the ray enters the cell", only=ONLY)
class _CellStart(_Straight):
    """Where the ray enters the cell whose surface it meets is the hit: blocks of cells show."""

    def crossing(self, start: Floats, rise: Floats, bend: Floats, slope: int) -> Floats:
        return self.do.in_lanes(0.0, start)


@MAXIMUM_MIPMAP.add("peaks at cells as blocks", only=ONLY)
class _Blocks(MaximumMipmap):
    """A cell of the finest level is a block as high as its maximum, as in point-sampled leaves."""

    def meet(self, walk: Walk, states: States, out: Floats) -> tuple[Ints, list[Ends]]:
        top = self.do.subtract(1.0, self.highest(walk.tree, states.level, self.node_index(walk, states)))
        depth = self.do.greatest(states.depth, self.do.in_lanes(top, states.depth))
        return states.ray[:0], [Ends(states.ray, np.full(len(states.ray), HIT), depth)]


@MAXIMUM_MIPMAP.add("quadtree half a texel off", only=ONLY)
class _HalfOff(MaximumMipmap):
    """Cells are taken to lie between texels' edges, not between their centres."""

    def shift(self, patch: Patch) -> float:
        return super().shift(patch) + 0.5
