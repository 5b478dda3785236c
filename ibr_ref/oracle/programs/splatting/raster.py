"""Stage 4: square splats through the depth test, in the order of their points."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.programs.splatting.case import Bools, Case, Floats, Ints, Vector

_NO_GAUSSIANS = np.zeros((0, 5))


class Splats(NamedTuple):
    """What is drawn."""

    vertex: Ints
    x: Floats
    """Centre, snapped."""
    y: Floats
    width: Floats
    depth: Floats
    """As the depth buffer holds it."""
    gaussian: Floats = _NO_GAUSSIANS
    """(n, 5) xx, xy, yy, amplitude, distance of ellipses."""


class Fragments(NamedTuple):
    """Covered pixels, those of earlier splats first."""

    splat: Ints
    """Index into Splats."""
    row: Ints
    column: Ints


class Buffers(NamedTuple):
    """What fragments are drawn into; all pixels in one row."""

    winner: NDArray[np.int32]
    """-1 none."""
    depth: Floats
    overdraw: NDArray[np.int32]


BATCH = 1 << 16
"""Splats drawn at a time, so that the fragments of wide ones fit into memory."""


class Raster(Case):
    """The fixed function: coverage is exact, whatever the shaders' arithmetic is."""

    def raster(self, vertices: dict[str, Any]) -> dict[str, Any]:
        """The stage's arrays but for the margin, which is the reference's own."""
        camera = self.scene.camera
        buffers = self.cleared(camera.height * camera.width)
        splats = self.live(vertices)
        names = self.names(vertices["vertex.source"][:, 0], splats.vertex)
        for first, batch in self.batches(splats):
            fragments = self.fragments(batch)
            splat = first + fragments.splat
            pixel = fragments.row * camera.width + fragments.column
            self.draw(buffers, pixel, names[splat], splats.depth[splat])
        shape = camera.height, camera.width
        return {
            "raster.splat": buffers.winner.reshape(shape),
            "raster.depth": buffers.depth.reshape(shape),
            "raster.overdraw": buffers.overdraw.reshape(shape),
        }

    def live(self, vertices: dict[str, Any]) -> Splats:
        """Those of the vertex stage's arrays that are not dropped."""
        window, width, depth = (vertices[f"vertex.{name}"] for name in ("window", "width", "depth"))
        some = np.flatnonzero((width > 0.0) & np.isfinite(window).all(axis=1))
        splats = self.splats(some, list(window[some].T), width[some], depth[some])
        if "vertex.covariance" not in vertices:
            return splats
        columns = [*vertices["vertex.covariance"].T, vertices["vertex.amplitude"], vertices["vertex.distance"]]
        return splats._replace(gaussian=np.stack(columns, axis=1)[splats.vertex])

    def batches(self, splats: Splats) -> Iterator[tuple[int, Splats]]:
        """So many at a time, each with the number of its first."""
        for first in range(0, len(splats.vertex), BATCH):
            yield first, Splats._make(values[first : first + BATCH] for values in splats)

    def splats(self, vertex: Ints, window: Vector, width: Floats, depth: Floats) -> Splats:
        """Of the points that are not dropped."""
        x, y = (self.snapped(axis) for axis in window)
        return Splats(vertex, x, y, self.size(width), self.stored_depth(depth))

    def snapped(self, window: Floats) -> Floats:
        """Centres on the raster of subpixels, along an axis."""
        return self.do.snap(window)

    def size(self, width: Floats) -> Floats:
        """The width that is drawn: not snapped."""
        return width

    def stored_depth(self, depth: Floats) -> Floats:
        """As the depth buffer holds it."""
        return self.do.flat_depth(depth)

    # --- Coverage ----------------------------------------------------------------------------------------------------

    def fragments(self, splats: Splats) -> Fragments:
        """All pixels that the splats cover."""
        (left, right), (top, bottom) = ([end.astype(np.int64) for end in ends] for ends in self.spans(splats))
        columns, rows = np.maximum(right - left, 0), np.maximum(bottom - top, 0)
        splat = np.repeat(np.arange(len(left)), rows * columns)
        step = np.arange(len(splat)) - np.repeat(np.cumsum(rows * columns) - rows * columns, rows * columns)
        down, across = np.divmod(step, np.maximum(columns[splat], 1))
        fragments = Fragments(splat, top[splat] + down, left[splat] + across)
        if self.params.shape == "square":
            return fragments
        kept = self.inside(splats, fragments)
        return Fragments._make(values[kept] for values in fragments)

    def spans(self, splats: Splats) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Columns and rows of splats, inside the picture."""
        camera, half = self.scene.camera, self.half(splats.width)
        return self.span(splats.x, half, camera.width), self.span_of_rows(splats.y, half, camera.height)

    def half(self, width: Floats) -> Floats:
        """From the centre to a border."""
        return 0.5 * width

    def borders(self, center: Floats, half: Floats) -> tuple[Floats, Floats]:
        """c − w/2 and c + w/2."""
        return self.do.border(center - half), self.do.border(center + half)

    def span(self, center: Floats, half: Floats, count: int) -> tuple[Floats, Floats]:
        """The first column covered and the first that is not any more, inside the picture: [c − w/2, c + w/2)."""
        low, high = self.borders(center, half)
        return np.clip(self.first_from(low), 0, count), np.clip(self.end_before(high), 0, count)

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Floats, Floats]:
        """The same for rows."""
        return self.span(center, half, count)

    def first_from(self, low: Floats) -> Floats:
        """The first pixel whose centre does not lie before a border."""
        return np.ceil(low - 0.5)

    def end_before(self, high: Floats) -> Floats:
        """The same for the other border, where pixels are not covered any more."""
        return np.ceil(high - 0.5)

    def inside(self, splats: Splats, fragments: Fragments) -> Bools:
        """Of the pixels of splats' boxes those that are covered."""
        return self.in_disc(splats, fragments)

    def in_disc(self, splats: Splats, fragments: Fragments) -> Bools:
        """dx² + dy² ≤ w²/4."""
        splat, border = fragments.splat, self.do.border
        dx = self.do.subtract(fragments.column + 0.5, border(splats.x[splat]))
        dy = self.do.subtract(fragments.row + 0.5, border(splats.y[splat]))
        return self.do.dot([dx, dy], [dx, dy]) <= self.squared_radius(border(splats.width[splat], 2.0))

    def squared_radius(self, width: Floats) -> Floats:
        """w²/4."""
        return self.do.multiply(0.25, self.do.multiply(width, width))

    # --- Depth test --------------------------------------------------------------------------------------------------

    def cleared(self, count: int) -> Buffers:
        """The buffers of so many pixels before the first splat."""
        return Buffers(np.full(count, -1, np.int32), np.ones(count), np.zeros(count, np.int32))

    def draw(self, buffers: Buffers, pixel: Ints, name: Ints, depth: Floats) -> None:
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
        return new < old

    def counted(self, passes: Bools) -> Bools:
        """Which fragments are overdraw: all."""
        return np.ones_like(passes)

    def names(self, image: Ints, vertex: Ints) -> Ints:
        """The numbers that winners are known by: their own. image: of every point (V,); vertex: the points drawn."""
        return vertex
