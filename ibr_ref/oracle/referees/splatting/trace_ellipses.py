"""Pixels of ellipses, step by step: those that are averaged there, each with its weight."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.pipeline.blends import Blended
from ibr_ref.oracle.programs.splatting.raster import Fragments, Splats
from ibr_ref.oracle.referees.rows import color, journaled, number, one, told
from ibr_ref.oracle.referees.splatting.blends import sums
from ibr_ref.oracle.referees.splatting.pixels import colors_of, looks
from ibr_ref.oracle.referees.splatting.trace_pixels import MOST, Pixel
from ibr_ref.oracle.referees.splatting.trace_points import stored_again


class Averaged(Pixel):
    """A pixel (row, column)."""

    def drawn(self, vertices: Ints) -> Splats:
        """Splats of the reference."""
        return super().drawn(vertices)._replace(gaussian=self._gaussian().value[vertices])

    def splat(self, splat: int) -> list[TraceRow]:
        """Whether it covers the pixel."""
        name, landed, program = f"splat {splat}", self.port.landed, self.model.program
        if not landed.possible[splat] or not np.isfinite(landed.width.value[splat]):
            return [told(f"{name}: drawn", "no")]
        at = np.array([splat])
        legal = program.splats(at, [x[at] for x in landed.window], landed.width[at], landed.depth[at])
        legal = legal._replace(gaussian=self._gaussian()[at])
        where = Fragments(np.zeros(1, np.int64), *(np.array([index]) for index in self.at))
        covered = program.covers(program.squared_distance(legal, where))
        rows = journaled([(f"{name}: d^T C^-1 d <= cutoff^2", covered)])
        distance = one(self._gaussian().T[4], splat)
        return [*rows, number(f"{name}: depth", one(self.result.depth, splat)), number(f"{name}: distance", distance)]

    def picture(self, at: int) -> list[TraceRow]:
        """What is averaged, colour and depth."""
        found = sums(self.model, self.port.fed, self.port.landed, np.array([self.pixel]), np.array([at]))
        chosen = self._outcome(found, at)
        mine = np.flatnonzero(found.of == chosen)
        rows = []
        for k in mine[:MOST].tolist():
            splat = int(found.splat[k])
            rows.append(number(f"splat {splat}: weight, amplitude exp(-q/2)", one(found.share, k)))
            rows.append(self._color(splat))
        weight, count = self.own("raster.weight"), self.own("raster.blended")
        rows.append(number("sum of the weights", one(found.weight, chosen), weight, array="raster.weight"))
        counts = [int(n) for n in found.count]
        legal = count is None or bool(found.lost.any()) or int(count) in counts
        rows.append(told("splats averaged", counts[chosen], count, legal=legal, array="raster.blended"))
        return [*rows, *self._shown(at)]

    def _gaussian(self) -> Number:
        gaussian = self.port.landed.gaussian
        if gaussian is None:
            raise ValueError("shape: found no ellipses, allowed: a model of ellipses")
        return gaussian

    def _outcome(self, found: Blended, at: int) -> int:
        """The one that the port's sum agrees with; else the reference's."""
        weight = self.own("raster.weight")
        if weight is not None:
            fits = np.flatnonzero(found.weight.allows(np.asarray(weight, np.float64)))
            if len(fits):
                return int(fits[0])
        distance, covering = self._gaussian().T[4].value, self.covering()
        near = self.exact.blends(distance[covering], distance[at]) if at >= 0 else np.zeros(len(covering), np.bool_)
        wanted = {*covering[near].tolist()}
        sets = [{*found.splat[found.of == m].tolist()} for m in range(len(found.row))]
        return sets.index(wanted) if wanted in sets else 0

    def _color(self, splat: int) -> TraceRow:
        model, landed, points = self.model, self.port.landed, self.port.fed
        branch = colors_of(model, points, landed, np.array([splat]), self.port.handed)[0]
        bounds = [stored_again(one(x, splat)) for x in branch.color.T]
        return number(f"splat {splat}: colour", bounds)

    def _shown(self, at: int) -> list[TraceRow]:
        """Colour and depth of what is shown."""
        seen = self.seen()
        some = np.flatnonzero(seen.pixel == self.pixel)
        if not len(some):
            return []
        rows, colors = looks(self.model, seen.take(some), self.port.fed, self.port.landed, self.port.handed)
        result, depth, port = [], self.own("depth"), self.own("color")
        mine = np.flatnonzero(rows.winner == at)
        first = int(mine[0]) if len(mine) else 0
        if depth is not None:
            deep = np.asarray(rows.depth.allows(depth))
            chosen = int(np.argmax(deep)) if deep.any() else first
            result.append(self.compared("picture: depth", rows.depth[[chosen]], depth, bool(deep.any()), "depth"))
        if port is not None:
            bounds = Bounded(colors.color.value, colors.color.deviation, self.model.machine.device)
            fits = np.asarray(allows_color(bounds, port).all(axis=1))
            k = int(np.argmax(fits)) if fits.any() else int(np.flatnonzero(colors.row == first)[0])
            result.append(color("picture: colour", [bounds[k, c] for c in range(3)], port, bool(fits.any())))
        return result
