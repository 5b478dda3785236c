"""Stage 4: square splats through the depth test, in the order of their points."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.atlas import Integers
from ibr_ref.oracle.ports.splatting.stage import Stage


class Splats(NamedTuple):
    """What is drawn."""

    vertex: Integers
    x: Floats
    """Centre, snapped."""
    y: Floats
    width: Floats
    depth: Floats
    """As the depth buffer holds it."""


class Fragments(NamedTuple):
    """Covered pixels, those of earlier splats first."""

    splat: Integers
    """Index into Splats."""
    row: Integers
    column: Integers


class Buffers(NamedTuple):
    """What fragments are drawn into; all pixels in one row."""

    winner: NDArray[np.int32]
    """-1 none."""
    depth: Floats
    overdraw: NDArray[np.int32]


BATCH = 1 << 16
"""Splats drawn at a time, so that the fragments of wide ones fit into memory."""


class Raster(Stage):
    """The fixed function: coverage is exact, whatever the shaders' arithmetic is."""

    def arrays(self, vertices: dict[str, Any]) -> dict[str, Any]:
        """The stage's arrays but for the margin, which is the reference's own."""
        camera = self.scene.camera
        buffers = self.cleared(camera.height * camera.width)
        splats = self.splats(vertices)
        names = self.names(vertices, splats.vertex)
        for first in range(0, len(names), BATCH):
            batch = slice(first, first + BATCH)
            fragments = self.fragments(Splats._make(values[batch] for values in splats))
            splat = first + fragments.splat
            pixel = fragments.row * camera.width + fragments.column
            self.draw(buffers, pixel, names[splat], splats.depth[splat])
        shape = camera.height, camera.width
        return {
            "raster.splat": buffers.winner.reshape(shape),
            "raster.depth": buffers.depth.reshape(shape),
            "raster.overdraw": buffers.overdraw.reshape(shape),
        }

    def splats(self, vertices: dict[str, Any]) -> Splats:
        """Of the points that are not dropped."""
        window, width, depth = (vertices[f"vertex.{name}"] for name in ("window", "width", "depth"))
        live = np.flatnonzero((width > 0.0) & np.isfinite(window).all(axis=1))
        x, y = self.snapped(window[live]).T
        return Splats(live, x, y, self.size(width[live]), self.stored_depth(depth[live]))

    def snapped(self, window: Floats) -> Floats:
        """Centres on the raster of subpixels."""
        return self.alu.snap(window)

    def size(self, width: Floats) -> Floats:
        """The width that is drawn: not snapped."""
        return width

    def stored_depth(self, depth: Floats) -> Floats:
        """As the depth buffer holds it."""
        return self.alu.depth(depth)

    def fragments(self, splats: Splats) -> Fragments:
        """All pixels that the splats cover."""
        camera, half = self.scene.camera, self.half(splats.width)
        left, right = self.span(splats.x, half, camera.width)
        top, bottom = self.span_of_rows(splats.y, half, camera.height)
        columns, rows = np.maximum(right - left, 0), np.maximum(bottom - top, 0)
        splat = np.repeat(np.arange(len(left)), rows * columns)
        step = np.arange(len(splat)) - np.repeat(np.cumsum(rows * columns) - rows * columns, rows * columns)
        down, across = np.divmod(step, np.maximum(columns[splat], 1))
        fragments = Fragments(splat, top[splat] + down, left[splat] + across)
        if self.params.shape != "disc":
            return fragments
        kept = self.in_disc(splats, fragments)
        return Fragments._make(values[kept] for values in fragments)

    def half(self, width: Floats) -> Floats:
        """From the centre to a border."""
        return 0.5 * width

    def borders(self, center: Floats, half: Floats) -> tuple[Floats, Floats]:
        """c − w/2 and c + w/2."""
        return center - half, center + half

    def span(self, center: Floats, half: Floats, count: int) -> tuple[Integers, Integers]:
        """The first column covered and the first that is not any more, inside the picture: [c − w/2, c + w/2)."""
        low, high = self.borders(center, half)
        first, end = self.first_from(low), self.end_before(high)
        return np.clip(first, 0, count).astype(np.int64), np.clip(end, 0, count).astype(np.int64)

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Integers, Integers]:
        """The same for rows."""
        return self.span(center, half, count)

    def first_from(self, low: Floats) -> Floats:
        """The first pixel whose centre does not lie before a border."""
        return np.ceil(low - 0.5)

    def end_before(self, high: Floats) -> Floats:
        """The same for the other border, where pixels are not covered any more."""
        return np.ceil(high - 0.5)

    def in_disc(self, splats: Splats, fragments: Fragments) -> Bools:
        """dx² + dy² ≤ w²/4."""
        dx = self.alu.subtract(fragments.column + 0.5, splats.x[fragments.splat])
        dy = self.alu.subtract(fragments.row + 0.5, splats.y[fragments.splat])
        return np.asarray(self.alu.dot([dx, dy], [dx, dy]) <= self.squared_radius(splats.width)[fragments.splat])

    def squared_radius(self, width: Floats) -> Floats:
        """w²/4."""
        return self.alu.multiply(0.25, self.alu.multiply(width, width))

    def cleared(self, count: int) -> Buffers:
        """The buffers of so many pixels before the first splat."""
        return Buffers(np.full(count, -1, np.int32), np.ones(count), np.zeros(count, np.int32))

    def draw(self, buffers: Buffers, pixel: Integers, name: Integers, depth: Floats) -> None:
        """Test fragments and store them: the n-th fragments of all pixels together."""
        order = np.argsort(pixel, kind="stable")
        pixel, name, depth = pixel[order], name[order], depth[order]
        places, starts, many = np.unique(pixel, return_index=True, return_counts=True)
        for turn in range(many.max(initial=0)):
            left = many > turn
            places, starts, many = places[left], starts[left], many[left]
            fragment = starts + turn
            passes = self.passes(depth[fragment], buffers.depth[places])
            buffers.depth[places[passes]] = depth[fragment[passes]]
            buffers.winner[places[passes]] = name[fragment[passes]]
            buffers.overdraw[places[self.counted(passes)]] += 1

    def passes(self, new: Floats, old: Floats) -> Bools:
        """The depth test: LESS."""
        return np.asarray(new < old)

    def counted(self, passes: Bools) -> Bools:
        """Which fragments are overdraw: all."""
        return np.ones_like(passes)

    def names(self, vertices: dict[str, Any], vertex: Integers) -> Integers:
        """The numbers that winners are known by, of points drawn: their own."""
        return vertex
