"""One pixel's or vertex' computation, step by step: what the reference has, what the port has, and how close it was."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.displacement.arrays import joined
from ibr_ref.oracle.referees.displacement.drawn_faces import FACES, faces_rows, other_faces
from ibr_ref.oracle.referees.displacement.element import Element
from ibr_ref.oracle.referees.displacement.hits import Hits, hits_of, window_depth
from ibr_ref.oracle.referees.displacement.light import lit_of, shadow_gap, stretch
from ibr_ref.oracle.referees.displacement.march import Search, compared, domain, search_of
from ibr_ref.oracle.referees.displacement.raster import Fragments
from ibr_ref.oracle.referees.displacement.rays import towards
from ibr_ref.oracle.referees.displacement.replay import (
    ARRAYS,
    Port,
    march_input,
    raster_input,
    shade_input,
)
from ibr_ref.oracle.referees.displacement.shade import slope
from ibr_ref.oracle.referees.displacement.shown import lighted, shades_of

Ints = NDArray[np.int64]


def trace(case: Case, device: Device, handed: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
    """The rows of one element of a stage; "image" and "resolve" follow the pixel through all stages."""
    if stage == "image":  # from the case alone
        handed = {name: handed[name] for name in ("color", "depth") if name in handed}
    port = Port(case=case, device=device, handed=handed)
    if stage == "vertex":
        return faces_rows(port) if other_faces(port) else list(_vertex(port, int(index[0])))
    row, column = index
    pixel = int(row) * case.scene.camera.width + int(column)
    candidates, _ = raster_input(port)
    candidates = candidates.take(candidates.pixel == pixel)
    element = Element(port, pixel)
    rows = [*_raster(port, pixel, candidates), *element.raster(candidates)]
    if stage == "raster":
        return rows
    fragments, _ = march_input(port, candidates)
    fragments = fragments.take(fragments.pixel == pixel)
    hits, _ = hits_of(port.constants, case.params, fragments)
    march = [row for i in range(len(fragments)) for row in _march(port, pixel, fragments.take(slice(i, i + 1)))]
    march += [*_outcomes(port, pixel, hits), *element.march(hits)]
    if stage == "march":
        return march
    hits = shade_input(port, hits)
    hits = hits.take(hits.pixel == pixel)
    shade = list(_shade(port, pixel, hits))
    looks = element.shade(hits)
    if stage == "shade":
        return shade + looks
    resolve = list(_resolve(port, pixel, hits))
    return rows + march + shade + looks + resolve + (element.image() if stage == "image" else element.resolve(hits))


def _number(value: float) -> str:
    return f"{value:.9g}"


def _vector(values: Sequence[float] | NDArray[np.float64]) -> str:
    return "(" + ", ".join(_number(float(v)) for v in values) + ")"


def _row(step: str, legal: Bounded, found: NDArray[np.float64] | None) -> TraceRow:
    """A result and what the port has of it."""
    value, error = (
        np.atleast_1d(legal.value),
        np.broadcast_to(np.atleast_1d(legal.error), np.shape(np.atleast_1d(legal.value))),
    )
    note = ""
    if found is not None:
        note = "" if bool(np.all(legal.allows(found))) else "differs"
    return TraceRow(
        step=step,
        reference=_vector(value) if len(value) > 1 else _number(float(value[0])),
        port="" if found is None else (_vector(np.atleast_1d(found)) if len(value) > 1 else _number(float(found))),
        bound=float(np.max(error)),
        note=note,
    )


def _vertex(port: Port, index: int) -> Iterator[TraceRow]:
    faces = port.candidates.faces
    for name, legal in (
        ("vertex.patch", joined([f.patch for f in faces])),
        ("vertex.clip", joined([f.clip for f in faces])),
    ):
        found = np.asarray(port.handed[name], np.float64) if name in port.handed else None
        usable = found is not None and index < len(found)
        own = found[index] if usable and found is not None else None
        yield replace(_row(f"{name}[{index}]", legal[index], own), array=name)


def _raster(port: Port, pixel: int, candidates: Fragments) -> Iterator[TraceRow]:
    names = ARRAYS["raster"]
    found = {name: port.floats(name)[pixel] for name in names if name in port.handed}
    says = ", ".join(f"{name} {found[name]:g}" for name in names[:2] if name in found)
    if not len(candidates):
        yield TraceRow(step="coverage", reference="no face covers the pixel", port=says)
    for i in range(len(candidates)):
        face = FACES[candidates.face[i]]
        covers = "covers the pixel" if candidates.certain[i] else "may cover the pixel"
        yield TraceRow(
            step=f"coverage by polygon {candidates.polygon[i]}, face {face}",
            reference=covers,
            port=says,
            note="certain" if candidates.certain[i] else "either way is legal",
        )
        yield _row("C, the fragment's point on the face", candidates.point[i], found.get("raster.patch"))


def _march(port: Port, pixel: int, fragment: Fragments) -> Iterator[TraceRow]:
    """The search of one fragment, along the port's own way where its indices say which way it took."""
    constants, params = port.constants[int(fragment.polygon[0])], port.case.params
    search = search_of(constants, params, [fragment.point[:, k] for k in range(3)])
    yield _row("ray at t = 0", joined(search.rays.start), None)
    yield _row("ray at t = 1", joined(search.rays.end), None)
    linear = int(port.ints("march.linear_index")[pixel]) if port.has("march.linear_index") else None
    hit = int(port.ints("march.hit_index")[pixel]) if port.has("march.hit_index") else None
    stop = _reference_stop(search)
    last = max(x for x in (stop, linear, 0) if x is not None) if linear is not None else stop
    if (stop is None or (linear is not None and linear < 0)) or last is None:
        last = params.linear_steps
    for i in range(0 if search.volume else 1, last + 1):
        said = None if linear is None or (linear >= 0 and i > linear) else i == linear
        yield _comparison(search, f"linear search, sample {i}: h < H", search.step(i), said)
    followed = linear if linear is not None and linear > 0 else stop
    if followed:
        low, high = search.step(followed - 1), search.step(followed)
        while high - low > 1:
            middle = (low + high) // 2
            said = None if hit is None or hit < 0 else middle >= hit
            row = _comparison(search, f"binary search, k = {middle}: h < H", middle, said)
            yield row
            inside = said if said is not None else row.reference.endswith("yes")
            low, high = (low, middle) if inside else (middle, high)
        yield from _near_plane(search, high)


def _outcomes(port: Port, pixel: int, hits: Hits) -> Iterator[TraceRow]:
    """What the marches may come to; a hit before the near plane is discarded."""
    threshold = port.case.params.steep_threshold
    for i in range(len(hits)):
        margin = float(hits.hit.value[i, 2] - hits.height_before.value[i] - threshold)
        kept = hits.hit_index[i] >= 0
        yield TraceRow(
            step="a legal outcome: i, k, (u, v, h), a, steep",
            reference=f"{hits.linear_index[i]}, {hits.hit_index[i]}, {_vector(hits.hit.value[i])}, "
            f"{_number(hits.height_before.value[i])}, {bool(hits.steep[i])}",
            port=_handed(port, pixel, ARRAYS["march"]),
            margin=abs(margin) if kept else None,
            bound=float(hits.hit.error[i, 2] + hits.height_before.error[i]) if kept else None,
            note="" if kept else "discarded",
        )


def _near_plane(search: Search, index: int) -> Iterator[TraceRow]:
    """Of the lattice point that the search ended at: a hit before the near plane is discarded."""
    point = search.rays.at(np.array([0]), np.array([index]), search.lattice)
    z, _ = window_depth(search.constants, point)
    certain = abs(z.value[0]) > z.error[0]
    yield TraceRow(
        step=f"k = {index}: clip z >= 0, at or behind the near plane",
        reference="yes" if z.value[0] >= 0.0 else "no: discarded",
        port="",
        margin=abs(float(z.value[0])),
        bound=float(z.error[0]),
        note="certain" if certain else "either way is legal",
    )


def _reference_stop(search: Search) -> int | None:
    """The step at which the values themselves stop."""
    for i in range(0 if search.volume else 1, search.params.linear_steps + 1):
        gap, may, _ = compared(search, np.array([0]), np.array([search.step(i)]))
        if may[0] and gap.value[0] > 0.0:
            return i
    return None


def _comparison(search: Search, step: str, index: int, said: bool | None) -> TraceRow:
    """h < H at one lattice index. said: what the port decided, as its indices tell."""
    one = np.array([0])
    gap, may, must = compared(search, one, np.array([index]))
    u, v, h = search.rays.at(one, np.array([index]), search.lattice)
    inside, _ = domain(search, u, v)
    answer = "" if said is None else ("yes" if said else "no")
    place = f"(u, v) = {_vector([u.value[0], v.value[0]])}"
    if not inside[0] or np.isnan(gap.value[0]):
        outside = f"{place}: outside the map, empty: no" if not inside[0] else f"{place}: above all heights: no"
        return TraceRow(step=step, reference=outside, port=answer, note="differs" if said else "certain")
    true = bool(gap.value[0] > 0.0)
    differs = said is not None and said != true
    note = "either way is legal" if may[0] and not must[0] else "differs" if differs else "certain"
    return TraceRow(
        step=step,
        reference=f"{place}: {_number(h.value[0])} < {_number(h.value[0] + gap.value[0])}: {'yes' if true else 'no'}",
        port=answer,
        margin=abs(float(gap.value[0])),
        bound=float(gap.error[0]),
        note=note,
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
    shades = shades_of(port.constants, port.case.params, hits)
    for i in range(len(hits)):
        constants = port.constants[int(hits.polygon[i])]
        hit = [hits.hit[i : i + 1, k] for k in range(3)]
        yield TraceRow(
            step="hit (u, v, h), steep",
            reference=f"{_vector(hits.hit.value[i])}, {bool(hits.steep[i])}",
            port=_handed(port, pixel, ("march.hit", "march.steep")),
        )
        gradient = slope(constants, hit)
        yield _row("gradient (g_u, g_v) of the height map", joined(gradient.along), None)
        yield from _shadow(port, constants_index=int(hits.polygon[i]), hit=hit)
    for i in range(len(shades.hit)):
        for name, legal in (("shade.albedo", shades.albedo[i]), ("shade.normal", shades.normal[i])):
            yield _row(f"legal: {name}" if name in port.handed else name, legal, None)
        yield TraceRow(step="legal: shade.lit", reference=str(bool(shades.lit[i])), port="")
    if not port.names("shade"):
        _, color = lighted(port.constants, hits, shades)
        for i in range(len(color.value)):
            yield _row("colour", color[i], None)


def _shadow(port: Port, constants_index: int, hit: list[Bounded]) -> Iterator[TraceRow]:
    constants, params = port.constants[constants_index], port.case.params
    if not params.shadow_steps:
        return
    way = towards(constants.light, constants.light_w, hit)
    share = stretch(constants, hit, way)
    path = [x * share for x in way]
    lit = lit_of(constants, params, hit)
    yield _row("share of the way to the light inside the volume", share, None)
    for j in range(1, params.shadow_steps + 1):
        gap = shadow_gap(constants, params, hit, path, j, np.array([0]))
        above = not np.isfinite(gap.value[0])
        yield TraceRow(
            step=f"self-shadow, sample {j}: h + bias < H",
            reference="above all heights: no" if above else ("yes" if gap.value[0] > 0.0 else "no"),
            port="",
            margin=None if above else abs(float(gap.value[0])),
            bound=float(gap.error[0]),
            note="either way is legal" if not above and abs(gap.value[0]) <= gap.error[0] else "certain",
        )
    yield TraceRow(
        step="lit",
        reference="either" if lit.may[0] and lit.may_not[0] else str(bool(lit.may[0])),
        port="",
    )


def _resolve(port: Port, pixel: int, hits: Hits) -> Iterator[TraceRow]:
    found = port.floats("depth")[pixel] if port.has("depth") else None
    for i in range(len(hits)):
        yield _row(f"window depth, polygon {hits.polygon[i]}", hits.depth[i], found)
    candidates = port.candidates
    for i in map(int, np.flatnonzero(candidates.hits.pixel == pixel)):
        hit = candidates.hits
        shown = "may be shown" if candidates.possible[i] else "is not shown"
        yield TraceRow(
            step=f"depth test: polygon {hit.polygon[i]}, face {FACES[hit.face[i]]}, k = {hit.hit_index[i]}",
            reference=f"depth {_number(float(hit.depth.value[i]))}: {shown}" if hit.hit_index[i] >= 0 else "discarded",
            port="" if found is None else _number(float(found)),
            bound=float(hit.depth.error[i]),
        )
    if candidates.empty[pixel]:
        yield TraceRow(step="background", reference="may be shown", port="" if found is None else _number(float(found)))
