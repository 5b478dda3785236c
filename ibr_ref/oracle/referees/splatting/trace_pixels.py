"""Pixels, step by step: the splats that may be seen there, and what is."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.pipeline.splats import Contest, contest
from ibr_ref.oracle.programs.splatting.raster import Fragments, Splats
from ibr_ref.oracle.referees.rows import color, compared, compared_numbers, journaled, number, one, told
from ibr_ref.oracle.referees.splatting.pixels import Seen, colors_of, outcomes, shown
from ibr_ref.oracle.referees.splatting.points import Port
from ibr_ref.oracle.referees.splatting.trace_points import lit

MOST = 8
"""Splats that are listed, the nearest first."""


class Pixel:
    """A pixel (row, column), by what it is replayed from (`port`), beside all that was handed in."""

    def __init__(self, port: Port, handed: Handed, at: tuple[int, int]) -> None:
        self.port, self.model, self.handed, self.at = port, port.model, handed, at
        camera = port.model.case.scene.camera
        self.pixel = at[0] * camera.width + at[1]
        self.result: Contest = contest(self.model.program, port.landed)
        # The reference computes in float64, and decides as its numbers have it.
        self.exact = self.model.kind(port.model.case.scene, port.model.case.params, Policy(float_bits=64), {})

    def rows(self) -> list[TraceRow]:
        """The splats that may be seen there, and the colour of the one that is."""
        landed, port = self.port.landed, self.own("raster.splat")
        splats = self.result.splat[self.result.pixel == self.pixel]
        splats = splats[np.argsort(landed.depth.value[splats], kind="stable")]
        covering = self.covering()
        winner = self.winner(covering)
        count = len(self.port.fed)
        listed = [int(splat) for splat in splats[:MOST]]
        listed += [v for v in (winner, -1 if port is None else int(port)) if 0 <= v < count]
        rows = [told("splats that may win", len(splats))]
        for splat in dict.fromkeys(listed):
            rows += self.splat(splat)
        named = "raster.splat" in self.port.handed and port is not None and -1 <= int(port) < count
        at = int(port) if named and port is not None else winner
        return [*rows, self.named(winner, splats), self.depth(at), self.overdraw(len(covering)), *self.picture(at)]

    def own(self, name: str) -> NDArray[np.generic] | None:
        """The port's number."""
        return np.asarray(np.asarray(self.handed[name])[self.at]) if name in self.handed else None

    def drawn(self, vertices: Ints) -> Splats:
        """Splats of the reference."""
        landed = self.port.landed
        window = [x.value[vertices] for x in landed.window]
        return self.exact.splats(vertices, window, landed.width.value[vertices], landed.depth.value[vertices])

    def covering(self) -> Ints:
        """The splats that cover the pixel in the reference."""
        landed = self.port.landed
        near = np.flatnonzero(landed.possible & (landed.width.value > 0.0))
        reach = 0.5 * landed.width.value[near] + 1.0
        for x, index in zip(landed.window, self.at[::-1], strict=True):
            inside = np.abs(x.value[near] - index - 0.5) <= reach
            near, reach = near[inside], reach[inside]
        splats = self.drawn(near)
        fragments = self.exact.fragments(splats)
        here = (fragments.row == self.at[0]) & (fragments.column == self.at[1])
        return np.asarray(splats.vertex[fragments.splat[here]])

    def winner(self, covering: Ints) -> int:
        """The nearest, of equal ones the first; -1 none."""
        depth = self.port.landed.depth.value[covering]
        return int(covering[np.argmin(depth)]) if len(depth) and depth.min() < 1.0 else -1

    def splat(self, splat: int) -> list[TraceRow]:
        """Its borders, as distances from the pixel's centre: positive inside."""
        name, landed, program = f"splat {splat}", self.port.landed, self.model.program
        if not landed.possible[splat] or not np.isfinite(landed.width.value[splat]):
            return [told(f"{name}: drawn", "no")]
        at, rows = np.array([splat]), []
        legal = program.splats(at, [x[at] for x in landed.window], landed.width[at], landed.depth[at])
        exact = self.drawn(at)
        for label, index in (("x", self.at[1]), ("y", self.at[0])):
            ends = program.borders(getattr(legal, label), program.half(legal.width))
            values = self.exact.borders(getattr(exact, label), self.exact.half(exact.width))
            (first, off_first), (last, off_last) = (_end(*pair) for pair in zip(values, ends, strict=True))
            low, high = index + 0.5 - first, last - (index + 0.5)
            rows.append(compared(f"{name}: {label} >= {first:.9g}", low >= 0.0, low, off_first))
            rows.append(compared(f"{name}: {label} < {last:.9g}", high > 0.0, high, off_last))
        return [*rows, *self.disc(name, legal), number(f"{name}: depth", one(self.result.depth, splat))]

    def disc(self, name: str, splats: Splats) -> list[TraceRow]:
        """dx^2 + dy^2 <= w^2 / 4."""
        if self.model.case.params.shape != "disc":
            return []
        where = (np.zeros(1, np.int64), *(np.array([index]) for index in self.at))
        return journaled([(f"{name}: dx^2 + dy^2 <= w^2 / 4", self.model.program.in_disc(splats, Fragments(*where)))])

    def named(self, winner: int, splats: Ints) -> TraceRow:
        """Who wins."""
        port = self.own("raster.splat")
        legal = port is None or int(port) in splats or (int(port) == -1 and bool(self.result.empty[self.pixel]))
        return told("winner (-1 none)", winner, port, legal=legal, array="raster.splat")

    def depth(self, at: int) -> TraceRow:
        """The depth buffer, of the splat that the port shows if that may be."""
        port, named = self.own("raster.depth"), self.own("raster.splat")
        splat = int(named) if named is not None and 0 <= int(named) < len(self.port.fed) else at
        depth = one(self.result.depth, splat) if splat >= 0 else one(Number(self.model.machine, 1.0))
        return number("depth buffer", depth, port, array="raster.depth")

    def overdraw(self, covering: int) -> TraceRow:
        """How many splats cover it."""
        port, least, most = self.own("raster.overdraw"), *(x[self.pixel] for x in (self.result.least, self.result.most))
        legal = port is None or bool(least <= int(port) <= most)
        step = "overdraw" if least == most else f"overdraw, legal from {least} to {most}"
        return told(step, covering, port, legal=legal, array="raster.overdraw")

    def picture(self, at: int) -> list[TraceRow]:
        """Colour and depth of what is shown."""
        rows, model, points = [], self.model, self.port.fed
        own = self.own_color(at)
        if at >= 0:
            rows += lit(model, points.take(np.array([at])), own)
        found = self.seen()
        here = found.take(found.pixel == self.pixel)
        mine = np.flatnonzero(here.winner == at)
        chosen = int(mine[0]) if len(mine) else 0
        if (depth := self.own("depth")) is not None and len(here.pixel):
            legal = bool(here.depth.allows(depth).any())
            rows.append(self.compared("picture: depth", here.depth[chosen : chosen + 1], depth, legal, "depth"))
        if (port := self.own("color")) is not None and len(here.pixel):
            rows.append(self.color(here, chosen, port))
        return rows

    def own_color(self, at: int) -> Any:
        """The port's own of a point."""
        return np.asarray(self.handed["vertex.color"])[at] if at >= 0 and "vertex.color" in self.handed else None

    def seen(self) -> Seen:
        """All that may be shown."""
        return outcomes(self.port)

    def color(self, here: Seen, chosen: int, port: NDArray[np.generic]) -> TraceRow:
        """The pixel of the picture."""
        colors = [
            shown(self.model, here, colors_of(self.model, points, self.port.landed, here.winner, self.port.handed))
            for points in self.port.fed.lightings
        ]
        bounds = [Bounded(c.color.value, c.color.deviation, self.model.machine.device) for c in colors]
        fits = [allows_color(b, port).all(axis=1) for b in bounds]
        k = next((i for i, each in enumerate(fits) if each.any()), 0)
        row = int(np.argmax(fits[k])) if fits[k].any() else int(np.flatnonzero(colors[k].row == chosen)[0])
        return color("picture: colour", [bounds[k][row, c] for c in range(3)], port, bool(fits[k].any()))

    def compared(self, step: str, legal: Number, found: Any, right: bool, array: str) -> TraceRow:
        """A number of the picture, which another outcome may have."""
        value = np.atleast_1d(legal.value)
        return compared_numbers(step, value, np.atleast_1d(found), right, array, None, float(legal.deviation[0]))


def _end(value: Floats, legal: Number) -> tuple[float, float]:
    """A border, and how far a device's may lie from there."""
    exact = float(value[0])
    return exact, float(max(legal.high[0] - exact, exact - legal.low[0]))
