"""Of a trace: the search of a pixel's fragments, comparison by comparison."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.programs.displacement.searches.below import Descent
from ibr_ref.oracle.referees.displacement.replay import ARRAYS, Port
from ibr_ref.oracle.referees.displacement.rows import Hits, Points, Vector
from ibr_ref.oracle.referees.displacement.trace.row import compared, handed_words, number, vector


class _Search:
    """The search of one fragment."""

    def __init__(self, port: Port, point: Points) -> None:
        self.program, self.params = port.model.program, port.case.params
        self.patch = port.model.patches[int(point.polygon[0])]
        self.machine = port.model.machine
        self.machine.begin(np.zeros(1, np.int64))
        self.rays = self.program.rays(self.patch, [self.machine.lanes(x, np.zeros(1, np.int64)) for x in point.point])

    @property
    def first(self) -> int:
        """The first linear step that may stop."""
        return 0 if self.program.may_stop(0) else 1

    def sample(self, index: int) -> tuple[Vector, Number, bool]:
        """A sample's place, H - h, and whether it is outside the map."""
        point = [self.machine.of(x) for x in self.program.position(self.rays, np.array([index]))]
        height, empty = self.program.sample(self.patch, point)
        outside = bool(np.all(empty.must if hasattr(empty, "must") else empty))
        return point, self.machine.of(height).plus(self.program.above_floor(point[2]), -1.0), outside

    @property
    def asks(self) -> str:
        """What is asked of a sample."""
        return "1 - d <= H" if self.sunken else "h < H"

    @property
    def sunken(self) -> bool:
        """Below the polygon a sample on the surface is inside."""
        return bool(self.program.floor < 0.0)

    def inside(self, gap: Number) -> bool:
        """By the values themselves."""
        return bool(gap.value[0] >= 0.0 if self.sunken else gap.value[0] > 0.0)

    def stop(self) -> int | None:
        """The step at which the values themselves stop."""
        for i in range(self.first, self.params.linear_steps + 1):
            _, gap, outside = self.sample(i << self.params.binary_steps)
            if not outside and self.inside(gap):
                return i
        return None

    def comparison(self, step: str, index: int, said: bool | None) -> TraceRow:
        """h < H at one lattice index. said: what the port decided, as its indices tell."""
        (u, v, h), gap, outside = self.sample(index)
        answer = "" if said is None else ("yes" if said else "no")
        place = f"(u, v) = {vector([u.value[0], v.value[0]])}"
        if outside:
            reference = f"{place}: outside the map, empty: no"
            return TraceRow(step=step, reference=reference, port=answer, note="differs" if said else "certain")
        true, margin, bound = self.inside(gap), abs(float(gap.value[0])), float(gap.deviation[0])
        differs = said is not None and said != true
        note = "either way is legal" if margin <= bound else "differs" if differs else "certain"
        level, sign = self.machine.of(self.program.above_floor(h)).value[0], "<=" if self.sunken else "<"
        heights = f"{number(level)} {sign} {number(level + gap.value[0])}"
        reference = f"{place}: {heights}: {'yes' if true else 'no'}"
        return TraceRow(step=step, reference=reference, port=answer, margin=margin, bound=bound, note=note)

    def near_plane(self, index: int) -> TraceRow:
        """Of the lattice point that the search ended at: a hit before the near plane is discarded."""
        z = self.machine.of(self.program.projected(self.patch, self.sample(index)[0])[2])
        margin, bound = abs(float(z.value[0])), float(z.deviation[0])
        return TraceRow(
            step=f"k = {index}: clip z >= 0, at or behind the near plane",
            reference="yes" if z.value[0] >= 0.0 else "no: discarded",
            port="",
            margin=margin,
            bound=bound,
            note="certain" if margin > bound else "either way is legal",
        )


def march_rows(port: Port, pixel: int, point: Points) -> Iterator[TraceRow]:
    """The search of one fragment, along the port's own way where its indices say which way it took."""
    search, params = _Search(port, point), port.case.params
    start, way = ([search.machine.of(x) for x in part] for part in (search.rays.start, search.rays.way))
    yield compared("ray at t = 0", start, None)
    yield compared("ray at t = 1", [a.plus(b) for a, b in zip(start, way, strict=True)], None)
    if isinstance(search.program, Descent):
        told = search.program.told(search.patch, search.rays)
        yield from (compared(step, search.machine.of(result), None) for step, result in told)
        return
    linear = int(port.ints("march.linear_index")[pixel]) if port.has("march.linear_index") else None
    if linear is not None and linear > params.linear_steps:  # no sample of the search: which way it took is not known
        linear = None
    hit = int(port.ints("march.hit_index")[pixel]) if port.has("march.hit_index") else None
    stop = search.stop()
    last = params.linear_steps if stop is None or (linear is not None and linear < 0) else max(stop, linear or 0)
    for i in range(search.first, last + 1):
        said = None if linear is None or (linear >= 0 and i > linear) else i == linear
        yield search.comparison(f"linear search, sample {i}: {search.asks}", i << params.binary_steps, said)
    followed = linear if linear is not None and linear > 0 else stop
    if followed:
        low, high = (followed - 1) << params.binary_steps, followed << params.binary_steps
        while high - low > 1:
            middle = (low + high) // 2
            said = None if hit is None or hit < 0 else middle >= hit
            row = search.comparison(f"binary search, k = {middle}: {search.asks}", middle, said)
            yield row
            inside = said if said is not None else row.reference.endswith("yes")
            low, high = (low, middle) if inside else (middle, high)
        yield search.near_plane(high)


def outcomes(port: Port, pixel: int, hits: Hits) -> Iterator[TraceRow]:
    """What the marches may come to; a hit before the near plane is discarded."""
    walls = port.model.program.floor == 0.0
    for i in range(len(hits)):
        margin = hits.hit[2][i].plus(hits.height_before[i], -1.0).plus(port.case.params.steep_threshold, -1.0)
        kept = bool(hits.kept[i])
        yield TraceRow(
            step="a legal outcome: i, k, (u, v, h), a, steep",
            reference=f"{hits.linear_index[i]}, {hits.hit_index[i]}, {vector([x.value[i] for x in hits.hit])}, "
            f"{number(hits.height_before.value[i])}, {bool(hits.steep[i])}",
            port=handed_words(port, pixel, ARRAYS["march"]),
            margin=abs(float(margin.value)) if kept and walls else None,
            bound=float(margin.deviation) if kept and walls else None,
            note="" if kept else "discarded",
        )
