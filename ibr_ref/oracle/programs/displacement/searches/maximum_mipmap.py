"""Quadtree displacement mapping (Drobot 2009) on a maximum mipmap (Tevs et al. 2008): first intersections.

Where rounding may turn a comparison, devices go other ways through the tree, and find the same: all ways are followed at
once (`arithmetic/ways.py`), and what is told apart is where they end. So a row here is a state of a ray, of which a device
has one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from typing import Any, ClassVar

import numpy as np

from ibr_ref.displacement.port_maps import quadtree_of
from ibr_ref.displacement.quadtree import Quadtree
from ibr_ref.oracle.programs.displacement.case import Bools, Floats, Ints, Patch
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Descent, Found
from ibr_ref.oracle.programs.displacement.searches.leaf import Leaf

MOST_NODES = 1 << 12
"""That one ray looks at; beyond, it is given up."""
MISSED, HIT = 0, 1
"""Ends of a search."""


@dataclass(frozen=True)
class Walk:
    """What rays go through, a row each."""

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


@dataclass(frozen=True)
class States:
    """Where rays are in the quadtree."""

    ray: Ints
    """Rows of the walk."""
    cell: list[Ints]
    """Column and row of level 0."""
    level: Ints
    depth: Floats

    def some(self, which: Any) -> States:
        """Those chosen."""
        return States(self.ray[which], [x[which] for x in self.cell], self.level[which], self.depth[which])

    def at(self, depth: Floats, level: Ints) -> States:
        """At another depth and level."""
        return States(self.ray, self.cell, level, depth)

    @property
    def keys(self) -> Ints:
        """One number for ray, level and cell; cells beyond 2^19 from the map are taken for others, 2^20 away."""
        key = self.ray.astype(np.int64) << 5 | self.level
        for cell in self.cell:
            key = key << 20 | (cell + (1 << 19)) & ((1 << 20) - 1)
        return key

    @staticmethod
    def joined(parts: list[States]) -> States:
        """One after the other."""
        return States(
            np.concatenate([part.ray for part in parts]),
            [np.concatenate([part.cell[k] for part in parts]) for k in (0, 1)],
            np.concatenate([part.level for part in parts]),
            np.concatenate([part.depth for part in parts]),
        )


@dataclass(frozen=True)
class Node:
    """The nodes that states are in."""

    first: list[Ints]
    """Their first cells."""
    stop: list[Ints]
    """The cells after their last ones."""
    top: Floats
    """Depth of the highest point."""
    exits: list[Floats]
    """Depths at which the ray leaves along x and y."""
    out: Floats
    """Depth at which it leaves, or ends in it."""

    def some(self, which: Any) -> Node:
        """Those chosen."""
        first, stop, exits = ([x[which] for x in each] for each in (self.first, self.stop, self.exits))
        return Node(first, stop, self.top[which], exits, self.out[which])


@dataclass(frozen=True)
class Move:
    """From nodes to other cells."""

    rows: Ints
    """Of the nodes."""
    to: States
    """At the depth and on the level of there."""
    crossed: list[Bools]
    """Whether the border along x and y is crossed."""


@dataclass(frozen=True)
class Ends:
    """States that a search ends in."""

    ray: Ints
    kind: Ints
    depth: Floats


class MaximumMipmap(Leaf, Descent, search="maximum_mipmap"):
    """Down the quadtree where a node reaches up to the ray, on and up where it does not."""

    counts_nodes: ClassVar[bool] = False
    """Whether it matters after how many nodes a state is reached."""

    def most_steps(self) -> int:
        """Nothing is added up."""
        return 0

    def tree(self, patch: Patch) -> Quadtree:
        """The maxima as a float texture."""
        return quadtree_of(self.scene.polygons[patch.number])

    def most_nodes(self) -> int:
        """That a ray looks at."""
        return MOST_NODES

    def descend(self, patch: Patch, rays: Rays) -> Found:
        """The first intersection; without one the bottom, where the ray reaches it."""
        walk = self.begun(patch, rays)
        none = self.do.in_lanes(0.0, rays.start[0])
        ends = [Ends(np.zeros(0, np.int64), np.zeros(0, np.int64), none[:0])]
        ends += [each for _, _, found in self.walked(walk) for each in found]
        ray, kind = (np.concatenate([getattr(each, name) for each in ends]) for name in ("ray", "kind"))
        kinds, depth = self.do.one_end(rays.start[0], ray, kind, np.concatenate([each.depth for each in ends]))
        hit, missed = kinds == HIT, np.flatnonzero(kinds != HIT)
        if len(missed):
            bottom = missed[np.asarray(self.reaches_bottom(patch, rays.some(missed)))]
            depth = self.do.replaced(depth, bottom, self.do.in_lanes(1.0, depth[bottom]))
            hit[bottom] = True
        return Found(np.where(hit, 0, -1), depth, none)

    def walked(self, walk: Walk) -> Iterator[tuple[States, Node, list[Ends]]]:
        """Step by step what states look at, and the ends that are found there."""
        states, explored = self.set_out(walk), self.do.explored()
        for _ in range(self.most_nodes()):
            if self.counts_nodes:
                explored = self.do.explored()
            rows, depth = explored.fresh(states.keys, states.depth)
            states = states.some(rows)
            states = states.at(depth, states.level)
            if not len(states.ray):
                return
            node = self.node(walk, states)
            after, ends = self.stepped(walk, states, node)
            yield states, node, ends
            states = after
        yield states, self.node(walk, states), [self.missed(states)]

    def told(self, patch: Patch, rays: Rays) -> Iterator[tuple[str, Floats]]:
        """Node by node of the first ray, which is the only one that a trace follows."""
        for states, node, ends in self.walked(self.begun(patch, rays)):
            for i, level in enumerate(states.level):
                columns, rows = (f"{a[i]} to {b[i] - 1}" for a, b in zip(node.first, node.stop, strict=True))
                name = f"level {level}, columns {columns}, rows {rows}"
                yield f"{name}: depth of its highest point", node.top[i : i + 1]
                yield f"{name}: depth at which the ray leaves it", node.out[i : i + 1]
            for end in ends:
                for row in np.flatnonzero(end.kind == HIT):
                    yield "d of the hit", end.depth[row : row + 1]

    # --- Setting out --------------------------------------------------------------------------------------------------

    def begun(self, patch: Patch, rays: Rays) -> Walk:
        """On the polygon."""
        rows, columns = np.shape(patch.heights)
        place, way = [], []
        for x, dx, size in zip(rays.start, rays.way, (columns, rows), strict=False):
            place.append(self.do.named("x", self.multiply_add(x, float(size), self.shift(patch))))
            way.append(self.do.multiply(dx, float(size)))
        return Walk(
            patch=patch,
            tree=self.tree(patch),
            rays=rays,
            place=place,
            way=way,
            ahead=[np.asarray(dx > 0.0) for dx in way],
            last=reduce(self.do.least, self.exits(patch, rays), self.do.in_lanes(1.0, rays.start[0])),
        )

    def set_out(self, walk: Walk) -> States:
        """In the coarsest node."""
        ray, cell = np.arange(len(walk.last)), list[Ints]()
        for k, size in enumerate((walk.tree.columns[0], walk.tree.rows[0])):
            at = walk.place[k][ray]
            rows, whole = self.do.wholes(at if walk.patch.repeat else np.clip(at, 0.0, size - 0.5))
            ray, cell = ray[rows], [*(x[rows] for x in cell), whole]
        depth = self.do.in_lanes(0.0, walk.last)[ray]
        return States(ray, cell, np.full(len(ray), len(walk.tree.offsets) - 1), depth)

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

    def node(self, walk: Walk, states: States) -> Node:
        """What states look at."""
        tree, level, index = walk.tree, states.level, self.node_index(walk, states)
        first, stop, exits = [], [], []
        for k, size in enumerate((tree.columns[0], tree.rows[0])):
            period = states.cell[k] // size * size  # cells repeat after `size`
            first.append(period + (index[k] << level))
            stop.append(period + np.minimum((index[k] + 1) << level, size))
            border = self.border(walk.ahead[k][states.ray], first[k], stop[k]).astype(np.float64)
            exits.append(self.do.divide(self.do.subtract(border, walk.place[k][states.ray]), walk.way[k][states.ray]))
        top = self.do.in_lanes(self.do.subtract(1.0, self.highest(tree, level, index)), states.depth)
        out = self.do.greatest(states.depth, self.do.least(self.do.least(*exits), walk.last[states.ray]))
        return Node(first, stop, top, exits, out)

    def node_index(self, walk: Walk, states: States) -> list[Ints]:
        """Column and row of the nodes that states are in, on their levels."""
        sizes = (walk.tree.columns[0], walk.tree.rows[0])
        return [cell % size >> states.level for cell, size in zip(states.cell, sizes, strict=True)]

    def border(self, ahead: Bools, first: Ints, stop: Ints) -> Ints:
        """The one of a node's borders that the ray leaves it by, in cells."""
        return np.where(ahead, stop, first)

    def highest(self, tree: Quadtree, level: Ints, index: list[Ints]) -> Floats:
        """The maxima of nodes, by column and row."""
        at = tree.offsets[level] + index[1] * tree.columns[level] + index[0]
        return self.do.texels(tree.values)[at]

    def stepped(self, walk: Walk, states: States, node: Node) -> tuple[States, list[Ends]]:
        """The states after a node, and the ends that are found in it."""
        passes, meets = self.do.parted(self.passes_over(node))
        coarse = states.level > 0
        down, leaf = np.flatnonzero(meets & coarse), np.flatnonzero(meets & ~coarse)
        lower, moves = self.go_down(states, node, down)
        on, hits = self.meet(walk, states.some(leaf), node.out[leaf])
        some = np.union1d(np.flatnonzero(passes), leaf[on])
        goes, ends = self.do.parted(self.goes_on(walk, states.some(some), node.some(some)))
        moves += self.go_on(walk, states, node, some[goes])
        hits.append(self.missed(states.some(some[ends])))
        return States.joined([lower, self.entered(walk, node, moves)]), hits

    def missed(self, states: States) -> Ends:
        """Without a hit, wherever that is."""
        return Ends(states.ray, np.full(len(states.ray), MISSED), self.do.in_lanes(0.0, states.depth))

    def passes_over(self, node: Node) -> Bools:
        """Whether the ray leaves a node above its highest point."""
        return node.top >= node.out

    def goes_on(self, walk: Walk, states: States, node: Node) -> Bools:
        """Whether the ray leaves a node before it ends."""
        last = walk.last[states.ray]
        return ((node.exits[0] < last) | (node.exits[1] < last)) & (states.depth < last)

    def go_down(self, states: States, node: Node, some: Ints) -> tuple[States, list[Move]]:
        """A level down: those that stay where they are, and those above the highest point, down to it."""
        above, below = self.do.parted(node.top[some] > states.depth[some])
        lower, moved = states.some(some[below]), states.some(some[above])
        inside = [np.zeros(len(moved.ray), np.bool_)] * 2
        return lower.at(lower.depth, lower.level - 1), [
            Move(some[above], moved.at(node.top[some[above]], moved.level - 1), inside)
        ]

    def go_on(self, walk: Walk, states: States, node: Node, some: Ints) -> list[Move]:
        """Into the next node, a level up; through a corner into the one across."""
        (x, y), before = (exits[some] for exits in node.exits), states.depth[some]
        over = [self.do.parted((x <= y) | (x <= before)), self.do.parted((y <= x) | (y <= before))]
        level = np.minimum(states.level + self.levels_up(), len(walk.tree.offsets) - 1)
        moves = []
        for ways in ((0, 0), (0, 1), (1, 0)):  # both, x, y
            rows = some[over[0][ways[0]] & over[1][ways[1]]]
            crossed = [np.full(len(rows), way == 0) for way in ways]
            moves.append(Move(rows, states.some(rows).at(node.out[rows], level[rows]), crossed))
        return moves

    def levels_up(self) -> int:
        """After a node is left."""
        return 1

    def entered(self, walk: Walk, node: Node, moves: list[Move]) -> States:
        """In the cells that the ray is in at its depth: beyond the node's border along x and y, or inside the node."""
        states, from_ = States.joined([move.to for move in moves]), np.concatenate([move.rows for move in moves])
        index = np.arange(len(from_))
        cells: list[Ints] = []
        for k in (0, 1):
            crossed = np.concatenate([move.crossed[k] for move in moves])[index]
            within, over = np.flatnonzero(~crossed), np.flatnonzero(crossed)
            first, stop, ray = node.first[k][from_[index]], node.stop[k][from_[index]], states.ray[index]
            way, place = walk.way[k][ray[within]], walk.place[k][ray[within]]
            at = self.multiply_add(way, states.depth[index[within]], place)
            rows, whole = self.do.wholes(np.clip(at, first[within], stop[within] - 0.5))
            beyond = np.where(walk.ahead[k][ray[over]], stop[over], first[over] - 1)
            rows, whole = np.concatenate([within[rows], over]), np.concatenate([whole, beyond])
            index, cells = index[rows], [*(cell[rows] for cell in cells), whole]
        return States(states.ray[index], cells, states.level[index], states.depth[index])

    # --- In a cell ----------------------------------------------------------------------------------------------------

    def meet(self, walk: Walk, states: States, out: Floats) -> tuple[Ints, list[Ends]]:
        """The states that leave cells without a hit, and the hits of those that meet the surface there."""
        if not len(states.ray):
            return states.ray, []
        on, hits = self.patch_hit(walk.patch, walk.rays.some(states.ray), states.depth, out)
        return on, [Ends(states.ray[rows], np.full(len(rows), HIT), depth) for rows, depth in hits]
