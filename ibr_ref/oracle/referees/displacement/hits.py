"""Fragments marched, hits shaded and lit: all legal outcomes of the program's stages, one stage a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from ibr_ref.array_types import Ints
from ibr_ref.oracle.accept.winners import Winners, winners
from ibr_ref.oracle.arithmetic.decisions import joined
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.rows import Hits, Points, Shades, Vector, absorbed, taken


def points_of(model: Model) -> Points:
    """The candidates of the program's own vertices, each anywhere in its box."""
    return _points(model, model.raster)


def points_from(model: Model, quads: list[list[Any]]) -> Points:
    """Of other vertices."""
    return _points(model, model.rasterized(quads))


def _points(model: Model, raster: Any) -> Points:
    fragments = raster.fragments

    def points(mine: Ints) -> Points:
        model.machine.begin(mine)
        box = np.zeros((len(mine), 2))
        point, depth = raster.points(mine, np.arange(len(mine)), box, box + 1.0)
        return Points(
            pixel=fragments.pixel[mine],
            polygon=fragments.polygon[mine],
            face=fragments.face[mine],
            certain=fragments.certain[mine],
            point=absorbed(point),
            depth=absorbed(depth),
        )

    jobs = [partial(points, some) for _, some in model.shares(np.arange(len(fragments)), fragments.polygon)]
    parts = [*model.machine.side_by_side(jobs)]
    return Points.joined(parts) if parts else no_points(model)


def no_points(model: Model) -> Points:
    """An empty table."""
    nothing = np.zeros(0, np.int64)
    none = Number(model.machine, np.zeros(0))
    return Points(pixel=nothing, polygon=nothing, face=nothing, certain=nothing > 0, point=[none] * 3, depth=none)


Outcomes = tuple[Ints, dict[str, Any], Ints]
"""The row of each outcome, its columns, and the rows that are lost."""


def _followed(
    model: Model, rows: Ints, polygon: Ints, run: Callable[[int, Ints, Ints], dict[str, Any]]
) -> Iterator[Outcomes]:
    """All outcomes of a run of a polygon, rows and lanes: of rows whose polygons are given, some thousands at a time."""
    jobs = [partial(_outcomes, model, some, partial(run, number)) for number, some in model.shares(rows, polygon)]
    return model.machine.side_by_side(jobs)


def _outcomes(model: Model, rows: Ints, run: Callable[[Ints, Ints], dict[str, Any]]) -> Outcomes:
    with np.errstate(all="ignore"):
        outcomes, lost = model.machine.follow(lambda origin: run(rows[origin], np.arange(len(origin))), len(rows))
    columns = {name: absorbed(column) for name, column in outcomes.items() if name != "origin"}
    return rows[outcomes["origin"]], columns, rows[lost]


def _lanes(model: Model, vector: Vector, at: Ints, lane: Ints) -> Vector:
    return [model.machine.lanes(x[at], lane) for x in vector]


def hits_of(model: Model, points: Points) -> tuple[Hits, Ints]:
    """The legal outcomes of all fragments, and the pixels of those that have too many."""
    parts, lost = [], [np.zeros(0, np.int64)]

    def run(polygon: int, at: Ints, lane: Ints) -> dict[str, Any]:
        depth = model.machine.lanes(points.depth[at], lane)
        march = model.marched(polygon, points.face[at], _lanes(model, points.point, at, lane), depth)
        return {**march, "depth": model.depths(polygon, march["hit_index"], march["hit"], depth)}

    for at, found, many in _followed(model, np.arange(len(points)), points.polygon, run):
        lost.append(points.pixel[many])
        parts.append(
            Hits(
                pixel=points.pixel[at],
                polygon=points.polygon[at],
                face=points.face[at],
                certain=points.certain[at],
                point=taken(points.point, at),
                **found,
            )
        )
    hits = Hits.joined(parts) if parts else no_hits(model)
    # Where the eye may lie at the fragment's own height, the ray may lead anywhere.
    anywhere = hits.kept & ~np.all([np.isfinite(x.value + x.deviation) for x in hits.hit], axis=0)
    lost.append(hits.pixel[anywhere])
    return hits.take(~anywhere), np.unique(np.concatenate(lost))


def no_hits(model: Model) -> Hits:
    """An empty table."""
    points = no_points(model)
    nothing, none = points.pixel, points.depth
    return Hits(
        **{f: getattr(points, f) for f in ("pixel", "polygon", "face", "certain", "point", "depth")},
        linear_index=nothing,
        hit_index=nothing,
        hit=[none] * 3,
        height_before=none,
        steep=nothing > 0,
    )


def redepthed(model: Model, hits: Hits) -> Number:
    """The depths of hits that lie elsewhere than they were found; not of the polygon."""
    parts, order = [Number(model.machine, np.zeros(0))], [np.zeros(0, np.int64)]

    def run(polygon: int, at: Ints, lane: Ints) -> dict[str, Any]:
        face_depth = model.machine.lanes(hits.depth[at], lane)
        hit = _lanes(model, hits.hit, at, lane)
        return {"depth": model.depths(polygon, hits.hit_index[at], hit, face_depth)}

    for at, found, _ in _followed(model, np.arange(len(hits)), hits.polygon, run):
        parts.append(found["depth"])
        order.append(at)
    where = np.concatenate(order)
    _, first = np.unique(where, return_index=True)
    depth: Number = joined(parts)
    return depth[first]


def shades_of(model: Model, hits: Hits) -> tuple[Shades, Ints]:
    """The legal looks of all kept hits, and the pixels of those that have too many."""
    parts, lost = [], [np.zeros(0, np.int64)]
    kept = np.flatnonzero(hits.kept)

    def run(polygon: int, at: Ints, lane: Ints) -> dict[str, Any]:
        patch, program = model.patches[polygon], model.program
        hit = _lanes(model, hits.hit, at, lane)
        wall = hits.steep[at] & (patch.facade is not None)
        with model.machine.one_place():
            normal, albedo = program.looks(patch, hit, wall)
        columns = {"normal": normal, "albedo": albedo}
        columns = {name: [model.machine.lanes(x, lane) for x in vector] for name, vector in columns.items()}
        return {**columns, "lit": np.asarray(program.lit(patch, hit))}

    for at, found, many in _followed(model, kept, hits.polygon[kept], run):
        lost.append(hits.pixel[many])
        parts.append(Shades(pixel=hits.pixel[at], hit=at, **found))
    if not parts:
        nothing, none = np.zeros(0, np.int64), Number(model.machine, np.zeros(0))
        return Shades(pixel=nothing, hit=nothing, albedo=[none] * 3, normal=[none] * 3, lit=nothing > 0), nothing
    return Shades.joined(parts), np.concatenate(lost)


def lighted(model: Model, hits: Hits, shades: Shades) -> tuple[Ints, Vector, Ints]:
    """Colours of shades, of which shade each is, and the pixels of those that have too many."""
    index, colors = [np.zeros(0, np.int64)], [[Number(model.machine, np.zeros(0))] * 3]
    lost = [np.zeros(0, np.int64)]

    def run(polygon: int, at: Ints, lane: Ints) -> dict[str, Any]:
        vectors = [(hits.hit, shades.hit[at]), (shades.albedo, at), (shades.normal, at)]
        hit, albedo, normal = (_lanes(model, vector, rows, lane) for vector, rows in vectors)
        color = model.program.colored(model.patches[polygon], hit, albedo, normal, shades.lit[at])
        return {"color": model.written(color)}

    for at, found, many in _followed(model, np.arange(len(shades)), hits.polygon[shades.hit], run):
        lost.append(shades.pixel[many])
        index.append(at)
        colors.append(found["color"])
    return np.concatenate(index), joined(colors), np.concatenate(lost)


def winners_of(model: Model, hits: Hits) -> Winners:
    """Which outcomes their pixels may show: the depth test between polygons."""
    camera = model.case.scene.camera
    owner = hits.pixel * len(model.patches) + hits.polygon
    return winners(hits.pixel, hits.certain, hits.depth.low, hits.depth.high, camera.width * camera.height, owner=owner)
