"""The fixed-function part of a device: transforms, clipping, coverage, varyings and the depth test."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ibr_ref.oracle.programs.program import Bools, Floats, Ints

NEAR, FAR = 0, 1
MOST_PAIRS = 2**20
"""Of triangles and pixels that are looked at together."""


@dataclass(frozen=True)
class Fragments:
    """N pixels of T triangles, in submission order."""

    triangle: Ints
    """(N,)."""
    pixel: Ints
    """(N,) row times width, plus column."""
    edges: tuple[Floats, Floats, Floats]
    """Three (N,): the edge functions opposite to the corners, >= 0 inside."""
    area: Floats
    """(N,) their sum."""

    def take(self, chosen: Ints | Bools) -> Fragments:
        """Some of them."""
        edges = (self.edges[0][chosen], self.edges[1][chosen], self.edges[2][chosen])
        return Fragments(self.triangle[chosen], self.pixel[chosen], edges, self.area[chosen])


class Raster:
    """What all passes share; a pass may have one of its own."""

    def __init__(self, do: Any) -> None:
        self.do = do

    # Clipping

    planes: ClassVar[tuple[int, ...]] = (NEAR, FAR)
    """That triangles are clipped against, in turn."""

    def distances(self, corner: Floats) -> list[Floats]:
        """Of (..., K >= 4) clip coordinates from the planes, negative outside."""
        return [self.distance(corner, plane) for plane in self.planes]

    def distance(self, corner: Floats, plane: int) -> Floats:
        """From one of them."""
        return corner[..., 2] if plane == NEAR else self.do.subtract(corner[..., 3], corner[..., 2])

    def clip(self, corners: Floats) -> tuple[Floats, Ints]:
        """(T, 3, K) corners, clip coordinates first, against near, then far: (T', 3, K), and the triangle of each (T',)."""
        planes = self.distances(corners)
        whole = np.all([(d >= 0.0).all(axis=1) for d in planes], axis=0)
        outside = np.any([(d < 0.0).all(axis=1) for d in planes], axis=0)
        pieces, owners = [corners[whole]], [np.flatnonzero(whole)]
        for triangle in np.flatnonzero(~whole & ~outside):
            polygon = list(corners[triangle])
            for plane in range(len(planes)):
                polygon = self._cut(polygon, plane)
            fan = [[polygon[0], *polygon[i : i + 2]] for i in range(1, len(polygon) - 1)]
            if fan:
                pieces.append(np.array(fan))
                owners.append(np.full(len(fan), triangle))
        owner = np.concatenate(owners)
        order = np.argsort(owner, kind="stable")
        return np.concatenate(pieces)[order], owner[order]

    def _cut(self, polygon: list[Floats], plane: int) -> list[Floats]:
        result = []
        for current, following in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            here, there = self.distances(current)[plane], self.distances(following)[plane]
            if here >= 0.0:
                result.append(current)
            if (here >= 0.0) != (there >= 0.0):
                share = self.do.divide(here, self.do.subtract(here, there))
                result.append(self.do.lerp(current, following, share))
        return result

    # From clip space to the window

    def window(self, corners: Floats, width: int, height: int) -> tuple[Floats, Floats, Floats]:
        """Window x, y and depth, each (T, 3), of corners (T, 3, K)."""
        x, y, z = (self.do.divide(corners[..., i], corners[..., 3]) for i in range(3))
        return self.column(x, width), self.row(y, height), z

    def column(self, x: Floats, width: int) -> Floats:
        """Window x of NDC."""
        return self.in_window(self.do.add(x, 1.0), x, width)

    def row(self, y: Floats, height: int) -> Floats:
        """Window y of NDC: downwards."""
        return self.in_window(self.do.subtract(1.0, y), -y, height)

    def in_window(self, from_border: Floats, from_middle: Floats, size: int) -> Floats:
        """A coordinate from the window's border, or from its middle, in pixels."""
        do, half = self.do, 0.5 * size
        found = do.multiply(do.multiply(from_border, 0.5), float(size))
        return do.either(found, lambda: do.add(do.multiply(from_middle, half), half))

    # Coverage

    def centre(self, pixel: Ints) -> Floats:
        """Of pixels, on one axis of the window."""
        return np.asarray(pixel + 0.5, np.float64)

    def owned(self, dx: Ints, dy: Ints) -> Bools:
        """Whether a pixel centre on an edge (dx, dy), the inside on its right hand, y downwards, is inside: top or left."""
        return np.asarray((dy < 0) | ((dy == 0) & (dx > 0)), np.bool_)

    def inside(self, edge: Ints, owned: Bools) -> Bools:
        """Whether an edge function lets a pixel in."""
        return np.asarray((edge > 0) | ((edge == 0) & owned), np.bool_)

    def cover(self, x: Floats, y: Floats, width: int, height: int) -> Fragments:
        """The fragments of triangles with window corners x, y (T, 3), in submission order."""
        snapped = self.do.snap(x), self.do.snap(y)
        columns, rows = self._span(snapped[0], width), self._span(snapped[1], height)
        wide, tall = (np.maximum(high - low + 1, 0) for low, high in (columns, rows))
        pairs = wide * tall
        if pairs.sum() > MOST_PAIRS and len(pairs) > 1:
            half = len(pairs) // 2
            first, rest = (self.cover(x[part], y[part], width, height) for part in (slice(half), slice(half, None)))
            return _joined(first, rest, half)
        triangle = np.repeat(np.arange(len(pairs)), pairs)
        inner = np.arange(len(triangle)) - np.repeat(np.cumsum(pairs) - pairs, pairs)
        column = columns[0][triangle] + inner % wide[triangle]
        row = rows[0][triangle] + inner // wide[triangle]
        return self._covered((x, y), snapped, triangle, column, row, width)

    def _span(self, corners: Floats, size: int) -> tuple[Ints, Ints]:
        """First and last pixel that the triangles (T, 3) may cover."""
        low, high = (np.clip(end, -2.0, size + 2.0) for end in (corners.min(axis=1), corners.max(axis=1)))
        first, last = np.maximum(np.ceil(low - 1.0), 0.0), np.minimum(np.floor(high), size - 1.0)
        return first.astype(np.int64), last.astype(np.int64)

    def _covered(
        self,
        window: tuple[Floats, Floats],
        snapped: tuple[Floats, Floats],
        triangle: Ints,
        column: Ints,
        row: Ints,
        width: int,
    ) -> Fragments:
        """The pairs of triangle and pixel where the pixel's centre is inside, by exact arithmetic on snapped corners."""
        units = 2.0**self.do.policy.subpixel_bits
        x, y = (np.rint(corners * units).astype(np.int64)[triangle] for corners in snapped)
        px, py = (np.rint(self.centre(pixel) * units).astype(np.int64) for pixel in (column, row))
        sign = np.sign(_edge(x, y, 2, x[:, 2], y[:, 2]))  # of the area
        edges, covered = [], sign != 0
        for i in range(3):
            edge = sign * _edge(x, y, i, px, py)
            a, b = (i + 1) % 3, (i + 2) % 3
            owned = self.owned(sign * (x[:, b] - x[:, a]), sign * (y[:, b] - y[:, a]))
            edges.append(edge)
            covered &= self.inside(edge, owned)
        kept = np.flatnonzero(covered)
        triangle, pixel = triangle[kept], row[kept] * width + column[kept]
        if self.do.policy.snapped_varyings:
            e0, e1, e2 = (self.do.number(edge[kept]) for edge in edges)
            return Fragments(triangle, pixel, (e0, e1, e2), self.do.number(sum(edge[kept] for edge in edges)))
        return self._unsnapped(window, triangle, pixel, (self.centre(column[kept]), self.centre(row[kept])), sign[kept])

    def _unsnapped(
        self, window: tuple[Floats, Floats], triangle: Ints, pixel: Ints, centre: tuple[Floats, Floats], sign: Ints
    ) -> Fragments:
        """Edge functions of the triangles as they were before snapping: slightly negative at some borders."""
        do, (x, y), (px, py) = self.do, (corners[triangle] for corners in window), centre
        edges = []
        for i in range(3):
            a, b = (i + 1) % 3, (i + 2) % 3
            dx, dy = do.subtract(x[:, b], x[:, a]), do.subtract(y[:, b], y[:, a])
            across = do.subtract(do.multiply(dx, do.subtract(py, y[:, a])), do.multiply(dy, do.subtract(px, x[:, a])))
            edges.append(sign * across)
        return Fragments(triangle, pixel, (edges[0], edges[1], edges[2]), do.sum(edges))

    # Varyings

    def linear(self, fragments: Fragments, corners: Floats) -> Floats:
        """(N,) of values (T, 3): linear in the window."""
        shares = [self.do.divide(edge, fragments.area) for edge in fragments.edges]
        return self.do.dot(shares, list(corners[fragments.triangle].T))

    def perspective(self, fragments: Fragments, w: Floats, varyings: Sequence[Floats]) -> list[Floats]:
        """Each (N,), of values (T, 3) at corners whose clip w is (T, 3): linear in space."""
        do, ws = self.do, w[fragments.triangle].T
        below = do.sum([do.divide(edge, at) for edge, at in zip(fragments.edges, ws, strict=True)])
        result = []
        for varying in varyings:
            corners = varying[fragments.triangle].T
            terms = [
                do.divide(do.multiply(edge, value), at)
                for edge, value, at in zip(fragments.edges, corners, ws, strict=True)
            ]
            result.append(do.divide(do.sum(terms), below))
        return result

    # Output merger

    def passes(self, depth: Floats, held: Floats) -> Bools:
        """The depth test."""
        return depth < held

    def nearest(self, pixel: Ints, depth: Floats, count: int) -> tuple[Ints, Floats]:
        """For each of `count` pixels the fragment that stays, -1 for none, and the depth held; in submission order."""
        seen, held = np.full(count, -1), np.ones(count)
        order = np.argsort(pixel, kind="stable")
        starts = np.flatnonzero(np.diff(pixel[order], prepend=-1))
        layer = np.arange(len(order)) - np.repeat(starts, np.diff(starts, append=len(order)))
        for number in range(int(layer.max(initial=-1)) + 1):
            these = order[layer == number]
            these = these[self.passes(depth[these], held[pixel[these]])]
            seen[pixel[these]], held[pixel[these]] = these, depth[these]
        return seen, held


def _edge(x: Ints, y: Ints, corner: int, px: Ints, py: Ints) -> Ints:
    """The edge function opposite to a corner, at points (N,), of triangles (N, 3)."""
    a, b = (corner + 1) % 3, (corner + 2) % 3
    result: Ints = (x[:, b] - x[:, a]) * (py - y[:, a]) - (y[:, b] - y[:, a]) * (px - x[:, a])
    return result


def _joined(first: Fragments, rest: Fragments, shift: int) -> Fragments:
    """Fragments of two runs of triangles."""
    e0, e1, e2 = (np.concatenate(pair) for pair in zip(first.edges, rest.edges, strict=True))
    return Fragments(
        np.concatenate([first.triangle, rest.triangle + shift]),
        np.concatenate([first.pixel, rest.pixel]),
        (e0, e1, e2),
        np.concatenate([first.area, rest.area]),
    )
