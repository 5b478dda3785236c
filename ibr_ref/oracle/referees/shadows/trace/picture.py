"""The trace of a pixel: every fragment that may be shown, from its depth to its colour."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.accept.bounded import Bounded, converted, stored
from ibr_ref.oracle.accept.bytes import allows_color
from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.shadows import resolve
from ibr_ref.oracle.referees.shadows.accumulate import accumulated
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.project import Coordinate, Shadow, coordinate, handed, shadow
from ibr_ref.oracle.referees.shadows.trace.rows import DIFFERS, EITHER, number, text, told

MOST = 4
"""Fragments that are listed, the nearest first."""


def pixel(case: Case, device: Device, arrays: Handed, stage: str, index: tuple[int, ...]) -> list[TraceRow]:
    """Pixel (row, column). For the stage "image" nothing of the port is fed to anything."""
    given = Inputs(case, device, {} if stage == "image" else arrays)
    seen = given.seen
    at = index[0] * seen.shape[1] + index[1]
    fragments = np.flatnonzero(seen.pixel == at)
    fragments = fragments[np.argsort(seen.depth.value[fragments], kind="stable")]
    rows = [
        told("surfaces that may be shown", len(fragments)),
        told("nothing may be", "yes" if seen.empty[at] else "no"),
    ]
    for fragment in fragments[:MOST]:
        rows += _surface(given, int(fragment), arrays, index)
    shown = fragments[0] if len(fragments) else -1
    if shown >= 0:
        rows += _shaded(given, int(shown), arrays, index)
    for name in ("color", "depth"):
        if name in arrays:
            rows.append(_shown(name, getattr(case.frame, name)[index], np.asarray(arrays[name])[index]))
    return rows


def _surface(given: Inputs, fragment: int, arrays: Handed, index: tuple[int, ...]) -> list[TraceRow]:
    seen = given.seen
    name = f"triangle {int(seen.triangle[fragment])}" + (" of the caster" if seen.caster[fragment] else "")
    found = None if "depth" not in arrays else np.asarray(arrays["depth"])[index]
    return [
        number(f"{name}: depth", seen.depth[fragment], found),
        number(f"{name}: world x, y, z", [axis[fragment] for axis in seen.world]),
    ]


def _shaded(given: Inputs, fragment: int, arrays: Handed, index: tuple[int, ...]) -> list[TraceRow]:
    """The nearest one, through all samples."""
    seen, rows, shadows = given.seen, [], []
    one = slice(fragment, fragment + 1)
    world, caster = [axis[one] for axis in seen.world], seen.caster[one]
    coords, own = _own(given, arrays, "project.coord"), _own(given, arrays, "project.shadow")
    for i, lens in enumerate(given.lenses):
        name = f"sample {i}: " if given.count > 1 else ""
        place = coordinate(lens, world)
        rows.append(
            number(f"{name}s, t, r", [axis[0] for axis in place.axes], None if coords is None else coords[i][index])
        )
        if "project.coord" in given.handed and coords is not None:
            place = handed(coords[i][index][None], place)
        legal = shadow(given.case, given.map(i), place, caster)
        port = None if own is None else float(own[i][index])
        rows += [*_read(given, i, place, name), _told_shadow(name, legal, port)]
        fed = "project.shadow" in given.handed and port is not None
        shadows.append(stored(np.array([port]), given.device) if fed else legal.first)
    total = accumulated(shadows, given.case.params.accumulation == "unorm8")
    found = None if "accumulate.shadow" not in arrays else float(np.asarray(arrays["accumulate.shadow"])[index])
    rows.append(number("sum of the samples", total[0], found))
    if "accumulate.shadow" in given.handed and found is not None:
        read = converted if given.case.params.accumulation == "unorm8" else stored
        total = read(np.array([found]), given.device)
    color = resolve.colors(given.case.scene, seen, np.array([fragment]), np.zeros(1, np.bool_), total)
    rows.append(number("surface colour", [channel[fragment] for channel in seen.color]))
    rows.append(number("max(0, n . l)", seen.cosine[fragment]))
    if seen.edge_on[fragment]:
        rows.append(number("the same from the triangle's other side, " + EITHER, seen.other[fragment]))
    return [*rows, _colored(color, arrays, index)]


def _own(given: Inputs, arrays: Handed, name: str) -> Any:
    if name not in arrays:
        return None
    array = np.asarray(arrays[name]).astype(np.float64)
    return array[None] if given.count == 1 else array


def _read(given: Inputs, sample: int, at: Coordinate, name: str) -> list[TraceRow]:
    """The texels around."""
    texels = given.map(sample).firm
    size = len(texels.value)
    x, y = (float(a.value[0]) * size for a in (at.s, at.t))
    if not (np.isfinite(x) and np.isfinite(y) and 0.0 <= x <= size and 0.0 <= y <= size):
        return [told(f"{name}on the map", "no: lit")]
    rows = [told(f"{name}texel x, y of the map", f"{x:.9g}, {y:.9g}")]
    if given.case.params.content == "depth" and not given.case.params.pcf:
        row, column = (min(int(n), size - 1) for n in (y, x))
        return [*rows, told(f"{name}depth of texel ({row}, {column})", f"{texels.value[row, column]:.9g}")]
    low_x, low_y = (int(np.floor(n - 0.5)) for n in (x, y))
    around = [
        f"{texels.value[np.clip(low_y + i, 0, size - 1), np.clip(low_x + j, 0, size - 1)]:.9g}"
        for i in (0, 1)
        for j in (0, 1)
    ]
    return [*rows, told(f"{name}texels 00, 10, 01, 11", ", ".join(around))]


def _told_shadow(name: str, legal: Shadow, port: float | None) -> TraceRow:
    note = EITHER if legal.open[0] else ""
    if port is not None and not bool(legal.allows(np.array([port]))[0]):
        note = DIFFERS
    reference = text(legal.first.value) + (f" or up to {text(legal.other.high)}" if legal.open[0] else "")
    return TraceRow(
        step=f"{name}shadow", reference=reference, port=text(port), bound=float(legal.first.error[0]), note=note
    )


def _colored(color: list[Bounded], arrays: Handed, index: tuple[int, ...]) -> TraceRow:
    """In bytes where the port's picture is."""
    found = np.asarray(arrays["color"])[index] if "color" in arrays else None
    bound = max(float(channel.error[0]) for channel in color)
    legal = found is None or all(bool(allows_color(c, found[k : k + 1])[0]) for k, c in enumerate(color))
    port = "" if found is None else text(found / 255.0 if found.dtype == np.uint8 else found)
    value = text([channel.value[0] for channel in color])
    return TraceRow(step="colour", reference=value, port=port, bound=bound, note="" if legal else DIFFERS)


def _shown(name: str, reference: Any, port: Any) -> TraceRow:
    port = port / 255.0 if port.dtype == np.uint8 else port
    return TraceRow(step=f"picture: {name}", reference=text(reference), port=text(port))
