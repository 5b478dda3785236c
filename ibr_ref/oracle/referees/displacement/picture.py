"""What a picture's pixels may show, from the case alone: the whole program over parts of the fragments' boxes.

A device snaps the corners of a face within its raster, so that the point of the face under a pixel's centre is uncertain in
two dimensions, and everything else follows from it but for roundings. With symbols the results are planes over the box.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.winners import Winners, winners
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.pipeline.raster import Fragments
from ibr_ref.oracle.programs.displacement import Port as Program
from ibr_ref.oracle.referees.displacement.model import AXES, Model, Raster
from ibr_ref.oracle.referees.displacement.rows import Rows

SMALLEST = 2.0**-14
"""Pixels: a box no larger has no parts; corners that are not snapped elsewhere move by their roundings only."""


ANYWHERE = 0.1
"""Of a patch: points that a sliver at the picture's border leaves so open are not followed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Boxes:
    """(n,) parts of the boxes of fragments, in units of their halves."""

    fragment: Ints
    middle: Floats
    """(n, 2)."""
    half: Floats
    """(n, 2)."""
    off: Floats
    """(n,) how far the results over the box that this is a part of were from planes."""

    def __len__(self) -> int:
        return len(self.fragment)

    def take(self, index: Any) -> Boxes:
        """Some of them."""
        return Boxes(**{n: getattr(self, n)[index] for n in ("fragment", "middle", "half", "off")})

    def parts(self) -> Boxes:
        """Four quarters each."""
        signs = [np.array([a, b]) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
        return joined_boxes(
            [replace(self, middle=self.middle + 0.5 * s * self.half, half=0.5 * self.half) for s in signs]
        )


def joined_boxes(parts: list[Boxes]) -> Boxes:
    """One list."""
    return Boxes(**{n: np.concatenate([getattr(p, n) for p in parts]) for n in ("fragment", "middle", "half", "off")})


@dataclass(frozen=True, kw_only=True, eq=False)
class Looks(Rows):
    """(n,) legal outcomes of boxes."""

    pixel: Ints
    box: Ints
    polygon: Ints
    hit_index: Ints
    """-1: discarded."""
    color: list[Number]
    """With slopes along the box."""
    depth: Number


@dataclass(frozen=True, eq=False)
class Picture:
    """Of one program, one case, one device."""

    model: Model
    among: Bools | None = None
    """(pixels,) of which pixels; None: of all."""

    @property
    def pixels(self) -> int:
        """Of the picture."""
        camera = self.model.case.scene.camera
        return int(camera.width * camera.height)

    @cached_property
    def raster(self) -> Raster:
        """All candidates."""
        found = self.model.raster
        return found if self.among is None else found.take(self.among[found.fragments.pixel])

    @property
    def fragments(self) -> Fragments:
        """All candidates."""
        return self.raster.fragments

    def whole(self, index: Ints) -> Boxes:
        """All of the boxes of some fragments."""
        box = np.zeros((len(index), 2))
        off = np.where(self.fragments.moved[index] > SMALLEST, np.inf, 0.0)
        return Boxes(fragment=index, middle=box, half=box + 1.0, off=off)

    def looks(self, boxes: Boxes) -> Iterator[tuple[Looks, Ints]]:
        """The outcomes of boxes, some thousands at a time, and the boxes that have too many."""
        anywhere = self.fragments.pieces[boxes.fragment, :3].max(axis=1, initial=0.0) > ANYWHERE
        if anywhere.any():
            yield self._nothing(), np.flatnonzero(anywhere)
        rows = np.flatnonzero(~anywhere)
        parts = self.model.shares(rows, self.fragments.polygon[boxes.fragment[rows]])
        jobs = [partial(self._looks, polygon, boxes.take(some), some) for polygon, some in parts]
        yield from self.model.machine.side_by_side(jobs)

    def _looks(self, polygon: int, boxes: Boxes, names: Ints) -> tuple[Looks, Ints]:
        model, fragment = self.model, boxes.fragment
        machine, program, patch = model.machine, model.program, model.patches[polygon]

        def run(origin: Ints) -> dict[str, Any]:
            lane = np.arange(len(origin))
            face = self.fragments.face[fragment[origin]]
            point, face_depth = self.raster.points(fragment[origin], lane, boxes.middle[origin], boxes.half[origin])
            march = model.marched(polygon, face, point, face_depth)
            kept = np.flatnonzero(march["hit_index"] >= 0)
            hit = [x[kept] for x in march["hit"]]
            with machine.one_place():
                normal, albedo = program.looks(patch, hit, march["steep"][kept] & (patch.facade is not None))
            lit = np.asarray(program.lit(patch, hit))
            color = model.written(program.colored(patch, hit, albedo, normal, lit))
            return {
                "hit_index": march["hit_index"],
                "color": [machine.spread(x, kept, len(lane), np.nan) for x in color],
                "depth": model.depths(polygon, march["hit_index"], march["hit"], face_depth),
            }

        with np.errstate(all="ignore"):
            found, lost = machine.follow(run, len(boxes))
        at = found["origin"]
        pixel = self.fragments.pixel[fragment[at]]
        return Looks(
            pixel=pixel,
            box=names[at],
            polygon=np.full(len(at), polygon),
            hit_index=found["hit_index"],
            color=[x.absorbed(AXES) for x in found["color"]],
            depth=found["depth"].absorbed(AXES),
        ), names[lost]

    @cached_property
    def _all(self) -> tuple[Looks, Ints]:
        """Of all whole boxes, and the lost fragments."""
        parts = [*self.looks(self.whole(np.arange(len(self.fragments))))]
        lost = np.concatenate([np.zeros(0, np.int64), *(l for _, l in parts)])
        return (Looks.joined([p for p, _ in parts]) if parts else self._nothing()), lost

    def _nothing(self) -> Looks:
        none, zero = Number(self.model.machine, np.zeros(0)), np.zeros(0, np.int64)
        return Looks(pixel=zero, box=zero, polygon=zero, hit_index=zero, color=[none] * 3, depth=none)

    @property
    def all(self) -> Looks:
        """All outcomes."""
        return self._all[0]

    @property
    def lost(self) -> Ints:
        """Fragments with too many."""
        return self._all[1]

    @cached_property
    def winners(self) -> Winners:
        """The depth test between polygons."""
        looks, count = self.all, len(self.model.patches)
        certain = self.fragments.certain[looks.box] & ~np.isin(looks.box, self.lost)
        owner = looks.pixel * count + looks.polygon
        return winners(looks.pixel, certain, looks.depth.low, looks.depth.high, self.pixels, owner=owner)

    @cached_property
    def possible(self) -> Bools:
        """(n,) whether outcomes of whole boxes may be what their pixels show."""
        return self.winners.possible if self.model.program.right("nearer") else self._tested()

    def _tested(self) -> Bools:
        """By another depth test, where it is certain: elsewhere anything may be shown."""
        looks, nearer = self.all, self.model.program.nearer
        result = np.asarray(looks.hit_index >= 0)
        low, high, certain = looks.depth.low, looks.depth.high, self.fragments.certain[looks.box]
        order = np.lexsort((looks.box, looks.pixel))
        for rows in np.split(order, np.flatnonzero(np.diff(looks.pixel[order])) + 1):
            alone = len(set(looks.polygon[rows].tolist())) == len(rows) and certain[rows].all()
            kept = rows[result[rows]]
            if not alone or len(kept) < 2:
                continue
            winner, near, far = -1, 1.0, 1.0
            for row in kept:
                one, other = bool(nearer(low[row], far)), bool(nearer(high[row], near))
                if one != other:
                    break
                if one:
                    winner, near, far = row, low[row], high[row]
            else:
                result[kept] = kept == winner
        return result

    @cached_property
    def behind(self) -> Floats:
        """(pixels, polygons) the depth beyond which another polygon certainly hides what is at the pixel."""
        looks, count = self.all, len(self.model.patches)
        farthest, sure = np.full((self.pixels, count), -np.inf), np.ones((self.pixels, count), np.bool_)
        depth = np.where(looks.hit_index >= 0, looks.depth.high, np.inf)
        np.maximum.at(farthest, (looks.pixel, looks.polygon), depth)
        np.logical_and.at(sure, (looks.pixel, looks.polygon), self.fragments.certain[looks.box])
        lost = self.lost
        sure[self.fragments.pixel[lost], self.fragments.polygon[lost]] = False
        farthest[~sure | ~np.isfinite(farthest)] = np.inf
        others = [
            farthest[:, [k for k in range(count) if k != own]].min(axis=1, initial=np.inf) for own in range(count)
        ]
        return np.stack(others, axis=1)

    def shown(self, looks: Looks) -> Bools:
        """Whether outcomes may be what their pixels show."""
        if not self.model.program.right("nearer"):
            polygons = len(self.model.patches)
            may = np.zeros((self.pixels, polygons), np.bool_)
            np.logical_or.at(may, (self.all.pixel, self.all.polygon), self.possible)
            return np.asarray((looks.hit_index >= 0) & may[looks.pixel, looks.polygon])
        limit = self.behind[looks.pixel, looks.polygon]
        with np.errstate(invalid="ignore"):
            return np.asarray((looks.hit_index >= 0) & (looks.depth.low <= limit) & (looks.depth.low < 1.0))


def picture_of(case: Case, device: Device, kind: type[Program] = Program, among: Bools | None = None) -> Picture:
    """Computed once for a case and its last device, for as long as the case lives; a suspect's, or of some pixels, anew."""
    if kind is not Program or among is not None:
        return Picture(Model(case, device, kind), among)
    known: Picture | None = case.kept.get("displacement.picture")
    if known is None or known.model.device != device:
        known = case.kept["displacement.picture"] = Picture(Model(case, device))
    return known
