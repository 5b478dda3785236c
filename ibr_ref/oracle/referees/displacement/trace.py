"""One pixel's or vertex' computation, step by step: what the program has, what the port has, and how close it was."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats, Ints
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.programs.displacement.searches.below import Descent
from ibr_ref.oracle.referees.displacement.drawn_faces import FACES, faces_rows, other_faces
from ibr_ref.oracle.referees.displacement.element import Element
from ibr_ref.oracle.referees.displacement.hits import hits_of, lighted, shades_of
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.replay import (
    ARRAYS,
    Port,
    march_input,
    raster_input,
    shade_input,
)
from ibr_ref.oracle.referees.displacement.rows import Hits, Points, Shades, Vector


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
    march = [row for i in range(len(points)) for row in _march(port, pixel, points.take(slice(i, i + 1)))]
    march += [*_outcomes(port, pixel, hits), *element.march(hits)]
    if stage == "march":
        return march
    hits = shade_input(port, hits, lambda: candidates)
    hits = hits.take(hits.pixel == pixel)
    shade = list(_shade(port, pixel, hits))
    looks = element.shade(hits)
    if stage == "shade":
        return shade + looks
    resolve = list(_resolve(port, pixel, hits))
    return rows + march + shade + looks + resolve + (element.image() if stage == "image" else element.resolve(hits))


def _number(value: float) -> str:
    return f"{value:.9g}"


def _vector(values: Sequence[float] | Floats) -> str:
    return "(" + ", ".join(_number(float(v)) for v in values) + ")"


def _row(step: str, legal: Number | Vector, found: Any) -> TraceRow:
    """A result, a number or components, of one element, and what the port has of it."""
    parts = list(legal) if isinstance(legal, list) else [legal]
    value = np.concatenate([np.ravel(x.value) for x in parts])
    error = np.concatenate([np.ravel(np.broadcast_to(x.deviation, x.shape)) for x in parts])
    found = None if found is None else np.ravel(found)
    note = ""
    if found is not None:
        near = (np.abs(found - value) <= error) | (found == value) | (np.isnan(found) & np.isnan(value))
        note = "" if bool(near.all()) else "differs"

    def words(values: Floats) -> str:
        return _vector(values) if len(values) > 1 else _number(float(values[0]))

    port = "" if found is None else words(found)
    return TraceRow(step=step, reference=words(value), port=port, bound=float(np.max(error)), note=note)


def _one(vector: Vector, i: int) -> Vector:
    return [x[i : i + 1] for x in vector]


def _vertex(port: Port, index: int) -> Iterator[TraceRow]:
    legal = port.model.vertices
    for name in ("vertex.patch", "vertex.clip"):
        found = np.asarray(port.handed[name], np.float64) if name in port.handed else None
        usable = found is not None and index < len(found)
        own = found[index] if usable and found is not None else None
        yield replace(_row(f"{name}[{index}]", legal[name][index], own), array=name)


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
        yield _row("C, the fragment's point on the face", _one(candidates.point, i), found.get("raster.patch"))


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
        place = f"(u, v) = {_vector([u.value[0], v.value[0]])}"
        if outside:
            reference = f"{place}: outside the map, empty: no"
            return TraceRow(step=step, reference=reference, port=answer, note="differs" if said else "certain")
        true, margin, bound = self.inside(gap), abs(float(gap.value[0])), float(gap.deviation[0])
        differs = said is not None and said != true
        note = "either way is legal" if margin <= bound else "differs" if differs else "certain"
        level, sign = self.machine.of(self.program.above_floor(h)).value[0], "<=" if self.sunken else "<"
        heights = f"{_number(level)} {sign} {_number(level + gap.value[0])}"
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


def _march(port: Port, pixel: int, point: Points) -> Iterator[TraceRow]:
    """The search of one fragment, along the port's own way where its indices say which way it took."""
    search, params = _Search(port, point), port.case.params
    start, way = ([search.machine.of(x) for x in part] for part in (search.rays.start, search.rays.way))
    yield _row("ray at t = 0", start, None)
    yield _row("ray at t = 1", [a.plus(b) for a, b in zip(start, way, strict=True)], None)
    if isinstance(search.program, Descent):
        told = search.program.told(search.patch, search.rays)
        yield from (_row(step, search.machine.of(result), None) for step, result in told)
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


def _outcomes(port: Port, pixel: int, hits: Hits) -> Iterator[TraceRow]:
    """What the marches may come to; a hit before the near plane is discarded."""
    walls = port.model.program.floor == 0.0
    for i in range(len(hits)):
        margin = hits.hit[2][i].plus(hits.height_before[i], -1.0).plus(port.case.params.steep_threshold, -1.0)
        kept = bool(hits.kept[i])
        yield TraceRow(
            step="a legal outcome: i, k, (u, v, h), a, steep",
            reference=f"{hits.linear_index[i]}, {hits.hit_index[i]}, {_vector([x.value[i] for x in hits.hit])}, "
            f"{_number(hits.height_before.value[i])}, {bool(hits.steep[i])}",
            port=_handed(port, pixel, ARRAYS["march"]),
            margin=abs(float(margin.value)) if kept and walls else None,
            bound=float(margin.deviation) if kept and walls else None,
            note="" if kept else "discarded",
        )


def _handed(port: Port, pixel: int, names: Sequence[str]) -> str:
    """The port's own numbers, in their order."""
    shown = []
    for name in (name for name in names if name in port.handed):
        value = np.atleast_1d(port.floats(name)[pixel])
        if np.asarray(port.handed[name]).dtype == np.bool_:
            shown.append(str(bool(value[0])))
        else:
            shown.append(_vector(value) if len(value) > 1 else _number(float(value[0])))
    return ", ".join(shown)


def _shade(port: Port, pixel: int, hits: Hits) -> Iterator[TraceRow]:
    model = port.model
    shades, _ = shades_of(model, hits)
    for i in range(len(hits)):
        yield TraceRow(
            step="hit (u, v, h), steep",
            reference=f"{_vector([x.value[i] for x in hits.hit])}, {bool(hits.steep[i])}",
            port=_handed(port, pixel, ("march.hit", "march.steep")),
        )
        if not hits.kept[i]:
            continue
        lane = np.zeros(1, np.int64)
        model.machine.begin(lane)
        patch, hit = model.patches[int(hits.polygon[i])], [model.machine.lanes(x, lane) for x in _one(hits.hit, i)]
        gradient = [model.machine.of(g) for g in model.program.gradient(patch, hit)]
        yield _row("gradient (g_u, g_v) of the height map", gradient, None)
        yield from _shadow(port, patch, hit, shades.lit[shades.hit == i])
        if patch.facade is not None and bool(hits.steep[i]):
            yield from _facade(model, patch, hit)
    for i in range(len(shades)):
        for name, legal in (("shade.albedo", shades.albedo), ("shade.normal", shades.normal)):
            yield _row(f"legal: {name}" if name in port.handed else name, _one(legal, i), None)
        yield TraceRow(step="legal: shade.lit", reference=str(bool(shades.lit[i])), port="")
        yield from _terms(model, hits, shades, i)
    if not port.names("shade"):
        _, color, _ = lighted(model, hits, shades)
        for i in range(len(color[0])):
            yield _row("colour", _one(color, i), None)


def _facade(model: Model, patch: Any, hit: Vector) -> Iterator[TraceRow]:
    """Where on its tile a wall's colour comes from."""
    program, machine = model.program, model.machine
    machine.begin(np.zeros(1, np.int64))
    faces_u = bool(np.asarray(program.faces_u(patch, hit, program.gradient(patch, hit)))[0])
    yield TraceRow(step="the wall faces along", reference="u" if faces_u else "v", port="")
    machine.begin(np.zeros(1, np.int64))
    yield _row(
        "tiles across, and down", [machine.of(x) for x in program.facade_place(patch, hit, np.array([faces_u]))], None
    )


def _terms(model: Model, hits: Hits, shades: Shades, shade: int) -> Iterator[TraceRow]:
    """What a colour is made of."""
    program, machine, lane = model.program, model.machine, np.zeros(1, np.int64)
    machine.begin(lane)
    at = int(shades.hit[shade])
    patch = model.patches[int(hits.polygon[at])]
    hit = [machine.lanes(x, lane) for x in _one(hits.hit, at)]
    normal = [machine.lanes(x, lane) for x in _one(shades.normal, shade)]
    world = program.to_world(patch, hit)
    to_light, to_eye = program.do.unit(program.light_way(patch, world)), program.do.unit(program.eye_way(patch, world))
    cosine, lit = program.do.dot(normal, to_light), shades.lit[shade : shade + 1]
    yield _row("n . l", machine.of(cosine), None)
    yield _row("ambient", machine.of(program.ambient()), None)
    yield _row(
        "ambient + diffuse max(0, n . l) where lit",
        machine.of(program.brightness(program.diffuse_cosine(cosine), lit)),
        None,
    )
    if model.case.scene.light.specular > 0.0:
        yield _row("r . v", machine.of(program.reflected_cosine(normal, to_light, to_eye, cosine)), None)
        yield _row("highlight", machine.of(program.highlights(normal, to_light, to_eye, cosine, lit)), None)


def _shadow(port: Port, patch: Any, hit: Vector, lit: Ints) -> Iterator[TraceRow]:
    program, params, machine = port.model.program, port.case.params, port.model.machine
    if not params.shadow_steps:
        return
    way = program.towards(patch.light, hit)
    stretch = machine.of(program.stretch(patch, hit, way))
    yield _row("share of the way to the light inside the volume", stretch, None)
    for j in program.shadow_samples():
        share = machine.multiply(stretch, program.shadow_fraction(j))
        u, v, h = (program.multiply_add(d, share, x) for x, d in zip(hit, way, strict=True))
        gap = machine.of(program.height_at(patch, u, v)).plus(machine.add(h, program.shadow_bias(patch)), -1.0)
        margin, bound = abs(float(gap.value[0])), float(gap.deviation[0])
        yield TraceRow(
            step=f"self-shadow, sample {j}: h + bias < H",
            reference="yes" if gap.value[0] > 0.0 else "no",
            port="",
            margin=margin,
            bound=bound,
            note="either way is legal" if margin <= bound else "certain",
        )
    yield TraceRow(step="lit", reference="either" if len(set(lit.tolist())) > 1 else str(bool(lit.any())), port="")


def _resolve(port: Port, pixel: int, hits: Hits) -> Iterator[TraceRow]:
    found = port.floats("depth")[pixel] if port.has("depth") else None
    for i in range(len(hits)):
        yield _row(f"window depth, polygon {hits.polygon[i]}", hits.depth[i], found)
    picture = port.picture
    looks, winners = picture.all, picture.winners
    for i in map(int, np.flatnonzero(looks.pixel == pixel)):
        shown = "may be shown" if winners.possible[i] else "is not shown"
        face = FACES[picture.fragments.face[looks.box[i]]]
        depth = float(looks.depth.value[i])
        yield TraceRow(
            step=f"depth test: polygon {looks.polygon[i]}, face {face}, k = {looks.hit_index[i]}",
            reference=f"depth {_number(depth)}: {shown}" if looks.hit_index[i] >= 0 else "discarded",
            port="" if found is None else _number(float(found)),
            bound=float(looks.depth.deviation[i]),
        )
    if winners.empty[pixel]:
        yield TraceRow(step="background", reference="may be shown", port="" if found is None else _number(float(found)))
