"""A program on the numbers of a device: what a case lets every legal device make of it, stage by stage.

The program is the right one, or one with a known bug: both are run alike, and judged alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats, Ints
from ibr_ref.oracle.arithmetic.device import Policy
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.pipeline.machine import Machine
from ibr_ref.oracle.pipeline.raster import Fragments, fragments_of
from ibr_ref.oracle.programs.displacement import Port as Program
from ibr_ref.oracle.programs.displacement.raster import Fragments as Marched

CHUNK = 1 << 14
"""Rows that are followed at a time, at the most: more, and their arrays leave the cache; fewer, and Python takes longer."""


AXES = ("x", "y")
"""The symbols of a fragment's box."""

Vector = list[Any]


@dataclass(frozen=True, eq=False)
class Model:
    """One program, one case, one device."""

    case: Case
    device: Device
    kind: type[Program] = field(default=Program)

    @cached_property
    def machine(self) -> Machine:
        """What it runs on; a fault may take the device for another one."""
        return Machine(replace(self.device, **self.kind.limits))

    @cached_property
    def program(self) -> Program:
        """The case's."""
        return self.kind(self.case.scene, self.case.params, Policy(), {}).on(self.machine)

    @cached_property
    def patches(self) -> list[Any]:
        """Of each polygon."""
        self.machine.begin(np.zeros(1, np.int64))
        return self.program.patches()

    @cached_property
    def quads(self) -> list[list[Any]]:
        """The faces of each polygon."""
        return [self.program.quads(patch) for patch in self.patches]

    @cached_property
    def vertices(self) -> dict[str, Number]:
        """The legal corners of all faces, (V, 4) and (V, 3)."""
        machine, program = self.machine, self.program
        clip: list[Any] = [np.zeros((0, 4)), *(machine.of(quad.clip) for quads in self.quads for quad in quads)]
        patch: list[Any] = [np.zeros((0, 3))]
        for each, quads in zip(self.patches, self.quads, strict=True):
            patch += [machine.of(program.written_corners(each, quad)) for quad in quads]
        pairs = (("vertex.clip", clip), ("vertex.patch", patch))
        joined: Any = np.concatenate  # of numbers it is a number
        return {name: joined([machine.of(x) for x in parts]) for name, parts in pairs}

    @cached_property
    def raster(self) -> Raster:
        """Of the program's own vertices."""
        return self.rasterized(self.quads)

    def rasterized(self, quads: Sequence[Sequence[Any]]) -> Raster:
        """Of other vertices."""
        polygons = [self.program.polygons(each) for each in quads]
        triangles = [self.program.fanned(each) for each in polygons]
        parts = [
            fragments_of(
                self.program, polygons[number], self.program.unclipped(quads[number]), number, self.machine.device
            )
            for number, each in enumerate(triangles)
            if each
        ]
        return Raster(self, triangles, _concatenated(parts))

    def patch_number(self, polygon: Ints) -> Ints:
        """As it is written."""
        return np.array([self.program.patch_number(p) for p in self.patches], np.int64)[polygon]

    def shares(self, rows: Ints, polygon: Ints) -> list[tuple[int, Ints]]:
        """Rows (n,) of each polygon (n,), with its number, in equal parts; which parts does not depend on the threads."""
        found = []
        for number in range(len(self.patches)):  # which are there before their symbols are used side by side
            mine = rows[polygon == number]
            found += [(number, some) for some in np.array_split(mine, max(1, -(-len(mine) // CHUNK))) if len(some)]
        return found

    def marched(self, polygon: int, face: Ints, point: Vector, depth: Any) -> dict[str, Any]:
        """The march of fragments, a lane each, and their window depths; within `Machine.follow`."""
        nothing = np.zeros(len(face), np.int64)
        fragments = Marched(nothing, nothing, nothing, face, point, depth)
        hits = self.program.march(self.patches[polygon], fragments)
        return {
            "linear_index": hits.linear_index,
            "hit_index": hits.hit_index,
            "hit": list(hits.point),
            "height_before": hits.height_before,
            "steep": np.asarray(hits.steep),
        }

    def depths(self, polygon: int, hit_index: Ints, hit: Vector, face_depth: Any) -> Number:
        """Window depth of hits as the depth buffer holds them; infinite where there is none."""
        depth = self.program.window_depth(self.patches[polygon], hit, face_depth)
        return self.machine.where(hit_index >= 0, depth, np.inf)

    def written(self, color: Vector) -> Vector:
        """Colours as the frame buffer holds them."""
        return list(self.machine.of(self.program.written(np.stack(np.broadcast_arrays(*color), axis=-1))).T)

    @cached_property
    def background(self) -> Vector:
        """As it is written."""
        return self.written(list(self.machine.number(np.asarray(self.program.background()))))


@dataclass(frozen=True, eq=False)
class Raster:
    """What the rasterizer hands on."""

    model: Model
    triangles: list[list[tuple[int, list[Number]]]]
    """Of each polygon: face, and corners (7,)."""
    fragments: Fragments

    def take(self, index: Any) -> Raster:
        """Some of the fragments."""
        return replace(self, fragments=self.fragments.take(index))

    def points(self, index: Ints, lane: Ints, middle: Floats, half: Floats) -> tuple[Vector, Number]:
        """C and the face's depth of fragments of one polygon, over parts of their boxes."""
        some = self.fragments.take(index)
        machine, program = self.model.machine, self.model.program
        weights = some.shares(machine, lane, middle, half)
        corners = self._corners(int(some.polygon[0]) if len(some) else 0)
        at = [corner[some.triangle] for corner in corners]
        clip = [[machine.lanes(c[:, k], lane) for c in at] for k in range(7)]
        w = [machine.named(f"w {i}", x) for i, x in enumerate(clip[3])]
        point = [program.varying(weights, clip[4 + k], w) for k in range(3)]
        depth = program.face_depth(weights, [machine.divide(z, x) for z, x in zip(clip[2], w, strict=True)], w)
        off = [Number(machine, np.zeros(len(some)), each, {}, lane) for each in some.pieces.T]
        point = [machine.named(f"C {k}", x.plus(off[k]).absorbed(AXES)) for k, x in enumerate(point)]
        return point, depth.plus(off[3]).absorbed(AXES)

    def _corners(self, polygon: int) -> list[Number]:
        """(T, 7) of each corner."""
        triangles = self.triangles[polygon]
        stacked: Any = np.stack  # of numbers it is a number
        return [stacked([vertices[i] for _, vertices in triangles], axis=0) for i in range(3)]


def _concatenated(parts: Sequence[Fragments]) -> Fragments:
    names = Fragments.__dataclass_fields__
    if not parts:
        nothing = np.zeros(0, np.int64)
        shapes = {"weights": (0, 3), "rounding": (0, 3), "pieces": (0, 4), "gradient": (0, 3, 2), "moved": (0,)}
        empty: dict[str, Any] = {n: np.zeros(shapes[n]) if n in shapes else nothing for n in names}
        return Fragments(**{**empty, "certain": nothing > 0})
    return Fragments(**{name: np.concatenate([getattr(p, name) for p in parts]) for name in names})
