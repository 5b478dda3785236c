"""One pixel's or vertex' computation, step by step: what the program has, what the port has, and how close it was."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.displacement.drawn_faces import FACES, faces_rows, other_faces
from ibr_ref.oracle.referees.displacement.element import Element
from ibr_ref.oracle.referees.displacement.hits import hits_of
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.replay import ARRAYS, Port, march_input, raster_input, shade_input
from ibr_ref.oracle.referees.displacement.rows import Hits, Points
from ibr_ref.oracle.referees.displacement.trace.march import march_rows, outcomes
from ibr_ref.oracle.referees.displacement.trace.row import compared, number, one
from ibr_ref.oracle.referees.displacement.trace.shade import shade_rows

__all__ = ["trace"]


def trace(case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
    """The rows of one element of a stage; "image" and "resolve" follow the pixel through all stages."""
    if stage == "image":  # from the case alone
        handed = {name: handed[name] for name in ("color", "depth") if name in handed}
    port = Port(model=Model(case, device), handed=handed)
    if stage == "vertex":
        return faces_rows(port) if other_faces(port) else list(_vertex(port, int(index[0])))
    row, column = index
    pixel = int(row) * case.scene.camera.width + int(column)
    candidates, _ = raster_input(port)
    here = candidates.take(candidates.pixel == pixel)
    element = Element(port, pixel)
    rows = [*_raster(port, pixel, here), *element.raster(here)]
    if stage == "raster":
        return rows
    points, _ = march_input(port, candidates)
    points = points.take(points.pixel == pixel)
    hits, _ = hits_of(port.model, points)
    march = [row for i in range(len(points)) for row in march_rows(port, pixel, points.take(slice(i, i + 1)))]
    march += [*outcomes(port, pixel, hits), *element.march(hits)]
    if stage == "march":
        return march
    hits = shade_input(port, hits, lambda: candidates)
    hits = hits.take(hits.pixel == pixel)
    shade = list(shade_rows(port, pixel, hits))
    looks = element.shade(hits)
    if stage == "shade":
        return shade + looks
    resolve = list(_resolve(port, pixel, hits))
    return rows + march + shade + looks + resolve + (element.image() if stage == "image" else element.resolve(hits))


def _vertex(port: Port, index: int) -> Iterator[TraceRow]:
    legal = port.model.vertices
    for name in ("vertex.patch", "vertex.clip"):
        found = np.asarray(port.handed[name], np.float64) if name in port.handed else None
        usable = found is not None and index < len(found)
        own = found[index] if usable and found is not None else None
        yield replace(compared(f"{name}[{index}]", legal[name][index], own), array=name)


def _raster(port: Port, pixel: int, candidates: Points) -> Iterator[TraceRow]:
    names = ARRAYS["raster"]
    found = {name: port.floats(name)[pixel] for name in names if name in port.handed}
    says = ", ".join(f"{name} {found[name]:g}" for name in names[:2] if name in found)
    if not len(candidates):
        yield TraceRow(step="coverage", reference="no face covers the pixel", port=says)
    for i in range(len(candidates)):
        certain = bool(candidates.certain[i])
        yield TraceRow(
            step=f"coverage by polygon {candidates.polygon[i]}, face {FACES[candidates.face[i]]}",
            reference="covers the pixel" if certain else "may cover the pixel",
            port=says,
            note="certain" if certain else "either way is legal",
        )
        yield compared("C, the fragment's point on the face", one(candidates.point, i), found.get("raster.patch"))


def _resolve(port: Port, pixel: int, hits: Hits) -> Iterator[TraceRow]:
    found = port.floats("depth")[pixel] if port.has("depth") else None
    for i in range(len(hits)):
        yield compared(f"window depth, polygon {hits.polygon[i]}", hits.depth[i], found)
    picture = port.picture
    looks, winners = picture.all, picture.winners
    for i in map(int, np.flatnonzero(looks.pixel == pixel)):
        shown = "may be shown" if winners.possible[i] else "is not shown"
        face = FACES[picture.fragments.face[looks.box[i]]]
        depth = float(looks.depth.value[i])
        yield TraceRow(
            step=f"depth test: polygon {looks.polygon[i]}, face {face}, k = {looks.hit_index[i]}",
            reference=f"depth {number(depth)}: {shown}" if looks.hit_index[i] >= 0 else "discarded",
            port="" if found is None else number(float(found)),
            bound=float(looks.depth.deviation[i]),
        )
    if winners.empty[pixel]:
        yield TraceRow(step="background", reference="may be shown", port="" if found is None else number(float(found)))
