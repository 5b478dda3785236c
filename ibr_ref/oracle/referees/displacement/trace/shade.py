"""Of a trace: what the shading of a pixel's hits is made of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ibr_ref.array_types import Ints
from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.referees.displacement.hits import lighted, shades_of
from ibr_ref.oracle.referees.displacement.model import Model
from ibr_ref.oracle.referees.displacement.replay import Port
from ibr_ref.oracle.referees.displacement.rows import Hits, Shades, Vector
from ibr_ref.oracle.referees.displacement.trace.row import compared, handed_words, one, vector


def shade_rows(port: Port, pixel: int, hits: Hits) -> Iterator[TraceRow]:
    """Hits, what lies between them and their shades, and what these may be."""
    model = port.model
    shades, _ = shades_of(model, hits)
    for i in range(len(hits)):
        yield TraceRow(
            step="hit (u, v, h), steep",
            reference=f"{vector([x.value[i] for x in hits.hit])}, {bool(hits.steep[i])}",
            port=handed_words(port, pixel, ("march.hit", "march.steep")),
        )
        if not hits.kept[i]:
            continue
        lane = np.zeros(1, np.int64)
        model.machine.begin(lane)
        patch, hit = model.patches[int(hits.polygon[i])], [model.machine.lanes(x, lane) for x in one(hits.hit, i)]
        gradient = [model.machine.of(g) for g in model.program.gradient(patch, hit)]
        yield compared("gradient (g_u, g_v) of the height map", gradient, None)
        yield from _shadow(port, patch, hit, shades.lit[shades.hit == i])
        if patch.facade is not None and bool(hits.steep[i]):
            yield from _facade(model, patch, hit)
    for i in range(len(shades)):
        for name, legal in (("shade.albedo", shades.albedo), ("shade.normal", shades.normal)):
            yield compared(f"legal: {name}" if name in port.handed else name, one(legal, i), None)
        yield TraceRow(step="legal: shade.lit", reference=str(bool(shades.lit[i])), port="")
        yield from _terms(model, hits, shades, i)
    if not port.names("shade"):
        _, color, _ = lighted(model, hits, shades)
        for i in range(len(color[0])):
            yield compared("colour", one(color, i), None)


def _facade(model: Model, patch: Any, hit: Vector) -> Iterator[TraceRow]:
    """Where on its tile a wall's colour comes from."""
    program, machine = model.program, model.machine
    machine.begin(np.zeros(1, np.int64))
    faces_u = bool(np.asarray(program.faces_u(patch, hit, program.gradient(patch, hit)))[0])
    yield TraceRow(step="the wall faces along", reference="u" if faces_u else "v", port="")
    machine.begin(np.zeros(1, np.int64))
    yield compared(
        "tiles across, and down", [machine.of(x) for x in program.facade_place(patch, hit, np.array([faces_u]))], None
    )


def _terms(model: Model, hits: Hits, shades: Shades, shade: int) -> Iterator[TraceRow]:
    """What a colour is made of."""
    program, machine, lane = model.program, model.machine, np.zeros(1, np.int64)
    machine.begin(lane)
    at = int(shades.hit[shade])
    patch = model.patches[int(hits.polygon[at])]
    hit = [machine.lanes(x, lane) for x in one(hits.hit, at)]
    normal = [machine.lanes(x, lane) for x in one(shades.normal, shade)]
    world = program.to_world(patch, hit)
    to_light, to_eye = program.do.unit(program.light_way(patch, world)), program.do.unit(program.eye_way(patch, world))
    cosine, lit = program.do.dot(normal, to_light), shades.lit[shade : shade + 1]
    yield compared("n . l", machine.of(cosine), None)
    yield compared("ambient", machine.of(program.ambient()), None)
    yield compared(
        "ambient + diffuse max(0, n . l) where lit",
        machine.of(program.brightness(program.diffuse_cosine(cosine), lit)),
        None,
    )
    if model.case.scene.light.specular > 0.0:
        yield compared("r . v", machine.of(program.reflected_cosine(normal, to_light, to_eye, cosine)), None)
        yield compared("highlight", machine.of(program.highlights(normal, to_light, to_eye, cosine, lit)), None)


def _shadow(port: Port, patch: Any, hit: Vector, lit: Ints) -> Iterator[TraceRow]:
    program, params, machine = port.model.program, port.case.params, port.model.machine
    if not params.shadow_steps:
        return
    way = program.towards(patch.light, hit)
    stretch = machine.of(program.stretch(patch, hit, way))
    yield compared("share of the way to the light inside the volume", stretch, None)
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
