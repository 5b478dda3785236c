"""Quadtree displacement mapping (Drobot 2009) on a maximum mipmap (Tevs et al. 2008): first intersections."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce

import numpy as np

from ibr_ref.displacement.maximum_mipmap import Quadtree
from ibr_ref.displacement.quadtrees import quadtree_of
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Descent, Found

MOST_NODES = 1 << 12
"""That one ray looks at; beyond, it is given up."""


@dataclass
class Walk:
    """Where rays are in the quadtree: all of them, also those that are done."""

    patch: Patch
    tree: Quadtree
    rays: Rays
    place: list[Floats]
    """x and y on the polygon, in cells."""
    way: list[Floats]
    """The same per depth."""
    ahead: list[Bools]
    """Whether x and y grow on the way down."""
    last: Floats
    """Depth at which the ray leaves the map, or the volume."""
    cell: list[Ints]
    """Column and row of level 0."""
    level: Ints
    depth: Floats
    fetches: Ints


@dataclass(frozen=True)
class Node:
    """What rays look at: of some rays the node that they are in."""

    rows: Ints
    first: list[Ints]
    """Its first cells."""
    stop: list[Ints]
    """The cells after its last ones."""
    top: Floats
    """Depth of its highest point."""
    exits: list[Floats]
    """Depths at which the ray leaves it along x and y."""
    out: Floats
    """Depth at which it leaves it, or ends in it."""


class MaximumMipmap(Descent, search="maximum_mipmap"):
    """Down the quadtree where a node reaches up to the ray, on and up where it does not."""

    along_ray = False

    def most_steps(self) -> int:
        """Nothing is added up."""
        return 0

    def tree(self, patch: Patch) -> Quadtree:
        """The maxima as a float texture."""
        return quadtree_of(self.scene.polygons[patch.number])

    def descend(self, patch: Patch, rays: Rays) -> Found:
        """The first intersection; without one the bottom, where the ray reaches it."""
        walk = self.begun(patch, rays)
        searching, hit = np.arange(len(walk.fetches)), np.zeros(len(walk.fetches), np.bool_)
        for _ in range(MOST_NODES):
            if not len(searching):
                break
            node = self.node(walk, searching)
            searching, found = self.stepped(walk, node)
            hit[found] = True
        missed = np.flatnonzero(~hit)
        if len(missed):
            bottom = missed[np.asarray(self.reaches_bottom(patch, rays.some(missed)))]
            walk.depth = self.do.replaced(walk.depth, bottom, self.do.in_lanes(1.0, walk.depth[bottom]))
            hit[bottom] = True
        return Found(np.where(hit, walk.fetches, -1), walk.depth, self.do.in_lanes(0.0, walk.depth))

    def told(self, patch: Patch, rays: Rays) -> Iterator[tuple[str, Floats]]:
        """Node by node of the first ray, which is the only one that a trace follows."""
        walk, searching = self.begun(patch, rays), np.arange(len(rays.start[0]))
        while len(searching):
            node = self.node(walk, searching)
            name = f"level {walk.level[searching[0]]}, columns {node.first[0][0]} to {node.stop[0][0] - 1}, "
            name += f"rows {node.first[1][0]} to {node.stop[1][0] - 1}"
            yield f"{name}: depth of its highest point", node.top
            yield f"{name}: depth at which the ray leaves it", node.out
            searching, _ = self.stepped(walk, node)
        yield "d of the hit, if there is one", walk.depth

    # --- Setting out --------------------------------------------------------------------------------------------------

    def begun(self, patch: Patch, rays: Rays) -> Walk:
        """In the coarsest node, on the polygon."""
        tree, count = self.tree(patch), len(rays.start[0])
        rows, columns = np.shape(patch.heights)
        place, way, cell = [], [], []
        for x, dx, size, cells in zip(
            rays.start, rays.way, (columns, rows), (tree.columns[0], tree.rows[0]), strict=False
        ):
            place.append(self.do.named("x", self.multiply_add(x, float(size), self.shift(patch))))
            way.append(self.do.multiply(dx, float(size)))
            at = place[-1] if patch.repeat else np.clip(place[-1], 0.0, cells - 0.5)
            cell.append(np.asarray(self.do.whole(at), np.int64))
        return Walk(
            patch=patch,
            tree=tree,
            rays=rays,
            place=place,
            way=way,
            ahead=[np.asarray(dx > 0.0) for dx in way],
            last=reduce(self.do.least, self.exits(patch, rays), self.do.in_lanes(1.0, rays.start[0])),
            cell=cell,
            level=np.full(count, len(tree.offsets) - 1),
            depth=self.do.in_lanes(0.0, rays.start[0]),
            fetches=np.zeros(count, np.int64),
        )

    def shift(self, patch: Patch) -> float:
        """Of cells against texels' edges: the outer cells of a map that ends, half ones, are counted too."""
        return -0.5 if patch.repeat else 0.5

    def exits(self, patch: Patch, rays: Rays) -> list[Floats]:
        """Depths at which rays leave the map along u and v; none of one that repeats."""
        if patch.repeat:
            return []
        return [
            self.do.divide(self.do.subtract(np.where(np.asarray(way > 0.0), 1.0, 0.0), start), way)
            for start, way in zip(rays.start[:2], rays.way[:2], strict=True)
        ]

    def reaches_bottom(self, patch: Patch, rays: Rays) -> Bools:
        """Whether rays are still over the map at depth 1."""
        return reduce(
            lambda found, end: found & (end >= 1.0),
            self.exits(patch, rays),
            self.do.in_lanes(1.0, rays.start[0]) >= 1.0,
        )

    # --- Node by node -------------------------------------------------------------------------------------------------

    def node(self, walk: Walk, rows: Ints) -> Node:
        """What rays look at next."""
        tree, level = walk.tree, walk.level[rows]
        first, stop, index, exits = [], [], [], []
        for k, size in enumerate((tree.columns[0], tree.rows[0])):
            cell = walk.cell[k][rows]
            period = cell // size * size  # cells repeat after `size`
            number = (cell - period) >> level
            first.append(period + (number << level))
            stop.append(period + np.minimum((number + 1) << level, size))
            index.append(number)
            border = np.where(walk.ahead[k][rows], stop[k], first[k]).astype(np.float64)
            exits.append(self.do.divide(self.do.subtract(border, walk.place[k][rows]), walk.way[k][rows]))
        at = tree.offsets[level] + index[1] * tree.columns[level] + index[0]
        top = self.do.subtract(1.0, self.do.texels(tree.values)[at])
        walk.fetches[rows] += 1
        out = self.do.greatest(walk.depth[rows], self.do.least(self.do.least(*exits), walk.last[rows]))
        return Node(rows, first, stop, top, exits, out)

    def stepped(self, walk: Walk, node: Node) -> tuple[Ints, Ints]:
        """Those that search on, in their next nodes, and those that hit."""
        rows = node.rows
        meets = ~np.asarray(self.passes_over(node))
        coarse = walk.level[rows] > 0
        self.go_down(walk, node, np.flatnonzero(meets & coarse))
        leaf = np.flatnonzero(meets & ~coarse)
        hit = leaf[self.patch_hit(walk, rows[leaf], node.out[leaf])] if len(leaf) else leaf
        on = ~(meets & coarse)
        on[hit] = False
        some = np.flatnonzero(on)
        some = some[np.asarray(self.goes_on(walk, node, some))]
        self.go_on(walk, node, some)
        return np.sort(np.concatenate([rows[meets & coarse], rows[some]])), rows[hit]

    def passes_over(self, node: Node) -> Bools:
        """Whether the ray leaves a node above its highest point."""
        return node.top >= node.out

    def goes_on(self, walk: Walk, node: Node, some: Ints) -> Bools:
        """Whether the ray leaves a node before it ends."""
        last = walk.last[node.rows[some]]
        return ((node.exits[0][some] < last) | (node.exits[1][some] < last)) & (walk.depth[node.rows[some]] < last)

    def go_down(self, walk: Walk, node: Node, some: Ints) -> None:
        """To the highest point, if the ray is above it, and a level down there."""
        rows = node.rows[some]
        above = np.asarray(node.top[some] > walk.depth[rows]) if len(some) else np.zeros(0, np.bool_)
        some = some[above]
        if len(some):
            walk.depth = self.do.replaced(walk.depth, node.rows[some], self.do.in_lanes(node.top[some], node.out[some]))
            for k in range(2):
                walk.cell[k][node.rows[some]] = self.stays(walk, node, k, some, node.top[some])
        walk.level[rows] -= 1

    def go_on(self, walk: Walk, node: Node, some: Ints) -> None:
        """Into the next node, a level up; through a corner into the one across."""
        if not len(some):
            return
        rows = node.rows[some]
        x, y, out = node.exits[0][some], node.exits[1][some], node.out[some]
        before = walk.depth[rows]
        crossed = [np.array((x <= y) | (x <= before)), np.array((y <= x) | (y <= before))]
        crossed[1] |= ~crossed[0]
        for k in range(2):
            over, within = some[crossed[k]], some[~crossed[k]]
            beyond = np.where(walk.ahead[k][node.rows[over]], node.stop[k][over], node.first[k][over] - 1)
            walk.cell[k][node.rows[over]] = beyond
            if len(within):
                walk.cell[k][node.rows[within]] = self.stays(walk, node, k, within, node.out[within])
        walk.depth = self.do.replaced(walk.depth, rows, out)
        walk.level[rows] = np.minimum(walk.level[rows] + self.levels_up(), len(walk.tree.offsets) - 1)

    def levels_up(self) -> int:
        """After a node is left."""
        return 1

    def stays(self, walk: Walk, node: Node, k: int, some: Ints, depth: Floats) -> Ints:
        """The cell of a depth, inside the node."""
        rows = node.rows[some]
        at = self.multiply_add(walk.way[k][rows], depth, walk.place[k][rows])
        return np.asarray(self.do.whole(np.clip(at, node.first[k][some], node.stop[k][some] - 0.5)), np.int64)

    # --- In a cell ----------------------------------------------------------------------------------------------------

    def patch_hit(self, walk: Walk, rows: Ints, out: Floats) -> Bools:
        """Which rays meet the bilinear patch before they leave it; their depth is that of the hit."""
        walk.fetches[rows] += 1
        patch, rays, first = walk.patch, walk.rays.some(rows), walk.depth[rows]
        middle = self.do.multiply(self.do.add(first, out), 0.5)
        start, half, end = (self.below_surface(patch, rays, depth) for depth in (first, middle, out))
        inside = np.array(start > 0.0)
        bend = self.do.multiply(self.do.subtract(self.do.add(end, start), self.do.multiply(half, 2.0)), 2.0)
        rise = self.do.subtract(self.do.subtract(end, start), bend)
        through = np.array(~inside & np.asarray(self.comes_up(start, rise, bend, end)))
        at = np.flatnonzero(through)
        if len(at):
            share = self.crossing(start[at], rise[at], bend[at])
            depth = self.do.add(first[at], self.do.multiply(share, self.do.subtract(out[at], first[at])))
            walk.depth = self.do.replaced(walk.depth, rows[at], self.do.between(depth, first[at], out[at]))
        return inside | through

    def below_surface(self, patch: Patch, rays: Rays, depth: Floats) -> Floats:
        """d - D."""
        return self.overlap(depth, self.height_at(patch, *self.below(rays, depth)))

    def comes_up(self, start: Floats, rise: Floats, bend: Floats, end: Floats) -> Bools:
        """Whether bend s^2 + rise s + start becomes positive between 0 and 1: at the end, or at an apex before it."""
        apex = (bend < 0.0) & (rise > 0.0) & (rise < self.do.multiply(bend, -2.0))
        apex = apex & (self.discriminant(start, rise, bend) > 0.0)
        return (end > 0.0) | apex

    def discriminant(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        """rise^2 - 4 bend start."""
        return self.do.dot([rise, self.do.multiply(bend, -4.0)], [rise, start])

    def crossing(self, start: Floats, rise: Floats, bend: Floats) -> Floats:
        """The root with a rising slope, so that nothing cancels."""
        root = self.do.root(self.do.greatest(self.discriminant(start, rise, bend), 0.0))
        up = np.asarray(rise >= 0.0)
        over = np.where(up, self.do.multiply(start, -2.0), self.do.subtract(root, rise))
        under = np.where(up, self.do.add(rise, root), self.do.multiply(bend, 2.0))
        return np.clip(self.do.divide(over, under), 0.0, 1.0)
