"""Bugs of quadtree displacement mapping."""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.maximum_mipmap import Quadtree
from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.searches.maximum_mipmap import MaximumMipmap, Node, Walk

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


@MAXIMUM_MIPMAP.add("level not raised again", only=ONLY)
class _StaysFine(MaximumMipmap):
    """After a node is left, the search goes on at its level: it fetches more, and sees the same."""

    def levels_up(self) -> int:
        return 0


@MAXIMUM_MIPMAP.add("two levels up", only=ONLY)
class _TwoUp(MaximumMipmap):
    """After a node is left, the search goes on two levels above."""

    def levels_up(self) -> int:
        return 2


class _Leaf(MaximumMipmap):
    """Another meeting with the cell's surface."""

    def share(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        """Of the way through the cell."""
        raise NotImplementedError

    def comes_up(self, start: Floats, rise: Floats, bend: Floats, end: Floats) -> Bools:
        return end > 0.0

    def crossing(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        return self.share(start, rise, bend)


@MAXIMUM_MIPMAP.add("secant in the cell", only=ONLY)
class _Secant(_Leaf):
    """The surface in a cell is taken for straight along the ray: a secant in place of the quadratic."""

    def share(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        return np.clip(self.do.divide(-start, self.do.add(rise, bend)), 0.0, 1.0)


@MAXIMUM_MIPMAP.add("hit where the ray leaves the cell", only=ONLY)
class _CellEnd(_Leaf):
    """The end of the ray in the cell is the hit, not where it meets the surface."""

    def share(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        return self.do.in_lanes(1.0, start)


@MAXIMUM_MIPMAP.add("hit in the middle of the cell", only=ONLY)
class _CellMiddle(_Leaf):
    """The middle of the ray in the cell is the hit."""

    def share(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        return self.do.in_lanes(0.5, start)


@MAXIMUM_MIPMAP.add("hit where the ray enters the cell", only=ONLY)
class _CellStart(_Leaf):
    """Where the ray enters the cell whose surface it meets is the hit: blocks of cells show."""

    def share(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        return self.do.in_lanes(0.0, start)


@MAXIMUM_MIPMAP.add("peaks at cells as blocks", only=ONLY)
class _Blocks(MaximumMipmap):
    """A cell of the finest level is a block as high as its maximum, as in point-sampled leaves."""

    def patch_hit(self, walk: Walk, rows: Ints, out: Floats) -> Bools:
        walk.fetches[rows] += 1
        tree = walk.tree
        row, column = (walk.cell[k][rows] % size for k, size in ((1, tree.rows[0]), (0, tree.columns[0])))
        top = self.do.subtract(1.0, self.do.texels(tree.values)[row * tree.columns[0] + column])
        walk.depth = self.do.replaced(walk.depth, rows, self.do.greatest(walk.depth[rows], top))
        return np.ones(len(rows), np.bool_)


@MAXIMUM_MIPMAP.add("quadtree half a texel off", only=ONLY)
class _HalfOff(MaximumMipmap):
    """Cells are taken to lie between texels' edges, not between their centres."""

    def shift(self, patch: Patch) -> float:
        return super().shift(patch) + 0.5


@MAXIMUM_MIPMAP.add("ray not moved to the highest point", only=ONLY)
class _NotDown(MaximumMipmap):
    """Where a node reaches up to the ray, the ray stays where it is, and is not moved down to the highest point."""

    def go_down(self, walk: Walk, node: Node, some: Ints) -> None:
        walk.level[node.rows[some]] -= 1
