"""A program on the numbers of a device: what a case lets every legal device make of it, stage by stage.

The program is the right one, or one with a known bug: both are run alike, and judged alike.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.arithmetic.decisions import joined
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.arithmetic.number import Number, may_and_must
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.pipeline.machine import Machine
from ibr_ref.oracle.pipeline.splats import Contest, Drawn, contest
from ibr_ref.oracle.programs.program import Program as AnyProgram
from ibr_ref.oracle.programs.program import overridden
from ibr_ref.oracle.programs.splatting import Port as Program
from ibr_ref.oracle.programs.splatting.atlas import Atlas
from ibr_ref.oracle.programs.splatting.case import Case as Shared
from ibr_ref.oracle.programs.splatting.ellipses import Ellipses, Footprints
from ibr_ref.oracle.programs.splatting.lighting import Lighting
from ibr_ref.oracle.programs.splatting.normals import Preparation
from ibr_ref.oracle.programs.splatting.raster import Raster
from ibr_ref.oracle.programs.splatting.unproject import Unprojection
from ibr_ref.oracle.programs.splatting.vertex import Vertex
from ibr_ref.oracle.referees.splatting.table import Codes, Table, joined_columns, table

NOTHING: Handed = {}


@dataclass(frozen=True, eq=False)
class Placed(Drawn):
    """And where they are in the world."""

    world: list[Number] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Branch:
    """(V,) colours of points where the decisions of lighting came out one way."""

    color: Number
    """(V, 3); NaN of points that were not asked for."""
    legal: Bools
    """(V,) whether they may."""


@dataclass(frozen=True, eq=False)
class Model:
    """One program, one case, one device."""

    case: Case
    device: Device
    kind: type[Program] = field(default=Program)
    right: Model | None = None
    """By the right program: a suspect's shares what no fault of it changes."""

    def changes(self, *parts: type[Any]) -> bool:
        """Whether a fault changes what these parts of the program have."""
        return bool(overridden(self.kind, Program) & {name for part in parts for name in vars(part)})

    @property
    def fetches_of(self) -> Model | None:
        """The right model, where points are fed with the same texels."""
        fetches = self.program.right("texels", "fetch", "fetch_normals")
        return self.right if fetches and not self.changes(Atlas) else None

    @property
    def places_of(self) -> Model | None:
        """The right model, where points lie as in it."""
        parts = (AnyProgram, Shared, Atlas, Unprojection, Vertex, Footprints)
        normals = (Lighting,) if self.elliptic else ()  # by which ellipses have their shape
        return None if self.right is None or self.changes(*parts, *normals) else self.right

    @property
    def elliptic(self) -> bool:
        """Whether splats are ellipses, which are averaged."""
        return bool(self.case.params.shape == "ellipse")

    @cached_property
    def machine(self) -> Machine:
        """What it runs on; a fault may take the device for another one."""
        return Machine(replace(self.device, **self.kind.limits))

    @cached_property
    def program(self) -> Program:
        """The case's."""
        return self.kind(self.case.scene, self.case.params, Policy(), {}).on(self.machine)

    @cached_property
    def preparation(self) -> Preparation:
        """What the normals are prepared with."""
        return self.kind.preparation(self.case.scene, self.case.params, Policy(), {}).on(self.machine)

    @cached_property
    def atlas(self) -> dict[str, Any]:
        """Rectangles, colours and depths."""
        return self.program.atlas()

    @cached_property
    def given(self) -> list[Codes]:
        """(H, W, 3) 8-bit normals of each image: those that the case hands over, or the reference's."""
        if "normals" in self.case.inputs:
            return [np.asarray(codes) for codes in self.case.inputs["normals"]]
        stages = self.case.frame.stages
        pages, rects = stages["atlas.normal"], stages["atlas.rects"].tolist()
        return [pages[page][y : y + height, x : x + width] for page, x, y, width, height in rects]

    @cached_property
    def own(self) -> Table:
        """The points from the case alone."""
        return self.fetches_of.own if self.fetches_of else self.table(NOTHING)

    @cached_property
    def own_places(self) -> Placed:
        """Theirs."""
        return self.places_of.own_places if self.places_of else self._placed(self.own)

    @cached_property
    def own_contest(self) -> Contest:
        """Theirs against each other."""
        if self.places_of and not self.changes(Raster, Ellipses):
            return self.places_of.own_contest
        return contest(self.program, self.own_places)

    def table(self, handed: Handed) -> Table:
        """The points with what was handed in of an atlas."""
        return table(self.program, self.atlas, self.given, handed)

    def placed(self, points: Table) -> Placed:
        """Every point through unprojection, T_R->W, T_W->C and T_P."""
        return self.own_places if points is self.own else self._placed(points)

    def _placed(self, points: Table) -> Placed:
        parts = []
        self.machine.run.rows += len(points)
        for number, share in points.shares():
            with np.errstate(all="ignore"):
                found = self.program.placed(self.case.scene.images[number], points.texels(share))
            count = share.stop - share.start
            numbers = [*found.window, found.depth, found.width, *found.world, *found.gaussian]
            may, must = (np.broadcast_to(end, count) for end in may_and_must(found.kept))
            parts.append([*(self._row(x, count) for x in numbers), must, may])
        if not parts:
            none, no = Number(self.machine, np.zeros(0)), np.zeros(0, np.bool_)
            return Placed([none] * 2, none, none, no, no, world=[none] * 3)
        x, y, depth, width, *more, must, may = (joined(list(column)) for column in zip(*parts, strict=True))
        gaussian = joined_columns(more[3:]) if more[3:] else None
        return Placed([x, y], depth, width, must, may, gaussian=gaussian, world=more[:3])

    def _row(self, number: Any, count: int) -> Number:
        """A number of each point, where it is one of all of them too."""
        x: Number = self.machine.of(number)
        return x if x.shape == (count,) else x.each(lambda v: np.broadcast_to(v, count), None)

    def colors(self, points: Table, world: list[Number], asked: Ints | None = None) -> list[Branch]:
        """Lit points, those that are asked for, by every outcome of their decisions: the first is always there."""
        asked = np.arange(len(points)) if asked is None else asked
        rows, colors, lost = [np.zeros(0, np.int64)], [Number(self.machine, np.zeros((0, 3)))], []
        for number, share in points.shares():
            some = asked[(asked >= share.start) & (asked < share.stop)]
            at, color, many = self._lit(number, points.take(some), [x[some] for x in world])
            rows.append(some[at])
            colors.append(color)
            lost.append(some[many])
        vertex, color = np.concatenate(rows), joined(colors)
        order = np.argsort(vertex, kind="stable")
        turn = np.empty_like(order)  # of a point's outcomes, which one
        turn[order] = np.arange(len(order)) - np.searchsorted(vertex[order], vertex[order])
        some = [np.flatnonzero(turn == k) for k in range(turn.max(initial=0) + 1)]
        branches = [self._branch(len(points), vertex[which], color[which]) for which in some]
        anything = np.zeros((len(points), 1))
        for vertices in lost:
            anything[vertices] = np.inf
        return [Branch(branches[0].color.off_by(anything), branches[0].legal), *branches[1:]]

    def _lit(self, number: int, some: Table, world: list[Number]) -> tuple[Ints, Number, Ints]:
        """Rows, and colours (n, 3), of points of one image; and the rows that have too many outcomes."""
        texels, machine = some.texels(slice(None)), self.machine

        def run(origin: Ints) -> dict[str, Any]:
            vectors = (world, texels.codes, texels.albedo)
            at, codes, albedo = (machine.rows([machine.of(x) for x in vector], origin) for vector in vectors)
            color = self.program.lit(self.case.scene.images[number], at, codes, albedo)
            return {"color": joined_columns([self._row(x, len(origin)) for x in color])}

        with np.errstate(all="ignore"):
            found, lost = machine.follow(run, len(some))
        return found["origin"], found["color"], lost

    def _branch(self, count: int, vertex: Ints, color: Number) -> Branch:
        value, error, legal = np.full((count, 3), np.nan), np.zeros((count, 3)), np.zeros(count, np.bool_)
        value[vertex], error[vertex], legal[vertex] = color.value, color.deviation, True
        return Branch(Number(self.machine, value, error), legal)


_LAST: list[Model] = []
"""What was asked for last, or nothing."""


def model_of(case: Case, device: Device) -> Model:
    """Of the right program, kept until another case or device is asked for."""
    if not _LAST or _LAST[0].case is not case or _LAST[0].device != device:
        _LAST[:] = [Model(case, device)]
    return _LAST[0]
