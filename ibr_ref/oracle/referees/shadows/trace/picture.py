"""The trace of a pixel: every fragment that may be shown, from its depth to its colour."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded, converted, exact, stored
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.rows import DIFFERS, EITHER, color, number, text, told
from ibr_ref.oracle.referees.shadows import replay_soft, resolve
from ibr_ref.oracle.referees.shadows.accumulate import accumulated, in_bytes
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.project import Coordinate, Shadow, coordinate, handed, shadow

MOST = 4
"""Fragments that are listed, the nearest first."""
Index = tuple[int, ...]


def pixel(given: Inputs, stage: str, index: Index) -> list[TraceRow]:
    """Pixel (row, column). For the stage "image" nothing of the port is fed to anything."""
    arrays = given.handed
    if stage == "image":
        given = Inputs(given.case, given.device, {}, given.alone)
    seen = given.seen
    at = index[0] * seen.shape[1] + index[1]
    fragments = np.flatnonzero(seen.pixel == at)
    fragments = fragments[np.argsort(seen.depth.value[fragments], kind="stable")]
    rows = [
        told("surfaces that may be shown", len(fragments)),
        told("nothing may be", "yes" if seen.empty[at] else "no"),
    ]
    for fragment in fragments[:MOST]:
        rows += _surface(given, int(fragment))
    first = int(seen.first[at])
    rows += _depth(given, first, arrays, index)
    shown = _shown(given, fragments, first, at)
    return rows + (_shaded(given, shown, arrays, index) if shown >= 0 else _nothing(given, arrays, index))


def _surface(given: Inputs, fragment: int) -> list[TraceRow]:
    seen = given.seen
    name = f"triangle {int(seen.triangle[fragment])}" + (" of the caster" if seen.caster[fragment] else "")
    return [
        number(f"{name}: depth", seen.depth[fragment]),
        number(f"{name}: world x, y, z", [axis[fragment] for axis in seen.world]),
    ]


def _depth(given: Inputs, first: int, arrays: Handed, index: Index) -> list[TraceRow]:
    """What is seen in exact arithmetic; where the port sees another surface that may be, that one."""
    if "depth" not in arrays:
        return []
    seen, found = given.seen, float(np.asarray(arrays["depth"])[index])
    mine = np.flatnonzero(seen.pixel == index[0] * seen.shape[1] + index[1])
    agreeing = [int(i) for i in mine if bool(seen.depth[int(i)].allows(found))]
    shown = agreeing[0] if agreeing and first not in agreeing else first
    bound = exact(1.0, given.device) if shown < 0 else seen.depth[shown]
    return [number("depth", bound, found, array="depth")]


def _shown(given: Inputs, fragments: NDArray[np.int64], first: int, at: int) -> int:
    """The fragment that is followed: by the port's own depth, if that is a legal one's; -1 none."""
    own = given.own("depth", sampled=False)
    if own is None:
        return first
    found = own.reshape(-1)[at]
    legal = [int(i) for i in fragments if bool(given.seen.depth[int(i)].allows(found))]
    if legal:
        return first if first in legal else legal[0]
    return -1 if found == 1.0 and given.seen.empty[at] else first


def _nothing(given: Inputs, arrays: Handed, index: Index) -> list[TraceRow]:
    """Of a pixel that shows the background."""
    rows, device = [], given.device
    for name, count in (("project.coord", 3), ("project.blocker", 1), ("project.penumbra", 1), ("project.shadow", 1)):
        own = _own(given, arrays, name)
        for i in range(given.count if own is not None else 0):
            place = (i, *index) if given.count > 1 else None
            none = [exact(0.0, device)] * count
            rows.append(number(f"nothing: {name}", none, own[i][index], array=name, index=place))
    if "accumulate.shadow" in arrays:
        own = _own(given, given.handed, "project.shadow")  # whatever the pixel shows, its own shadows are summed
        shadows = [exact([0.0 if own is None else np.nan_to_num(own[i][index])], device) for i in range(given.count)]
        rows.append(_sum(given, shadows, arrays, index)[0])
    background = [channel[0] for channel in resolve.background(given.model)]
    return [*rows, *_colored(background, arrays, index, "background")]


def _shaded(given: Inputs, fragment: int, arrays: Handed, index: Index) -> list[TraceRow]:
    """One fragment through all samples."""
    seen, rows, shadows = given.seen, [], []
    one = slice(fragment, fragment + 1)
    world, caster = [axis[one] for axis in seen.world], seen.caster[one]
    coords, own = _own(given, arrays, "project.coord"), _own(given, arrays, "project.shadow")
    for i in range(given.count):
        name, sample = (f"sample {i}: ", (i, *index)) if given.count > 1 else ("", None)
        place = coordinate(given.model, i, world)
        found = None if coords is None else coords[i][index]
        axes = [axis[0] for axis in place.axes]
        rows.append(number(f"{name}s, t, r", axes, found, array="project.coord", index=sample))
        if "project.coord" in given.handed and found is not None:
            place = handed(found[None], place)
        legal = shadow(given.model, given.map(i), place, caster)
        port = None if own is None else float(own[i][index])
        read = _softened(given, fragment, arrays, index) if given.model.program.soft else _read(given, i, place, name)
        rows += [*read, _told_shadow(name, legal, port, sample)]
        fed = "project.shadow" in given.handed and port is not None and bool(np.isfinite(port))
        shadows.append(stored(np.array([port]), given.device) if fed else legal.first)
    total_row, total = _sum(given, shadows, arrays, index)
    light = resolve.colors(given.model, seen, np.array([fragment]), np.zeros(1, np.bool_), total)
    rows += [
        total_row,
        number("surface colour", [channel[fragment] for channel in seen.color]),
        number("max(0, n . l)", seen.cosine[fragment]),
    ]
    if seen.edge_on[fragment]:
        rows.append(number("the same from the triangle's other side, " + EITHER, seen.other[fragment]))
    return [*rows, *_colored([channel[0] for channel in light], arrays, index, "colour")]


def _sum(given: Inputs, shadows: list[Bounded], arrays: Handed, index: Index) -> tuple[TraceRow, Bounded]:
    """The samples' sum, and what the colour is made with."""
    total = accumulated(given.model, shadows)
    if "accumulate.shadow" not in arrays:
        return number("sum of the samples", total[0]), total
    found = np.array([float(np.asarray(arrays["accumulate.shadow"])[index])])
    row = number("sum of the samples", total[0], found, array="accumulate.shadow")
    if given.case.params.accumulation == "unorm8" and not bool(in_bytes(found, given.device)[0]):
        row = TraceRow(**{**vars(row), "step": "sum of the samples, a byte k / 255", "note": DIFFERS})
    fed = "accumulate.shadow" in given.handed and bool(np.isfinite(found[0]))
    read = converted if given.case.params.accumulation == "unorm8" else stored
    return row, read(found, given.device) if fed else total


def _own(given: Inputs, arrays: Handed, name: str) -> Any:
    if name not in arrays:
        return None
    array = np.asarray(arrays[name]).astype(np.float64)
    return array[None] if given.count == 1 else array


def _softened(given: Inputs, fragment: int, arrays: Handed, index: Index) -> list[TraceRow]:
    """Blocker and penumbra, each from the port's own before it."""
    rows = []
    for name, step in (("project.blocker", "mean distance of blockers"), ("project.penumbra", "penumbra, 1/b - 1/r")):
        own = _own(given, arrays, name)
        port = None if own is None else float(own[0][index])
        which, outcome, _, _ = replay_soft.outcomes(given, name)
        mine = [int(k) for k in np.flatnonzero(which == fragment)]
        agreeing = [k for k in mine if port is not None and bool(outcome[k].allows(port))]
        rows.append(number(step, outcome[(agreeing or mine)[0]], port, array=name))
    return rows


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


def _told_shadow(name: str, legal: Shadow, port: float | None, sample: Index | None) -> TraceRow:
    row = number(f"{name}shadow", legal.first[0], port, array="project.shadow", index=sample)
    other = f", either way is legal: or up to {text(legal.other.high)}" if legal.open[0] else ""
    note = EITHER if legal.open[0] else ""
    if port is not None and not bool(legal.allows(np.array([port]))[0]):
        note = DIFFERS
    return TraceRow(**{**vars(row), "step": row.step + other, "note": note})


def _colored(legal: list[Bounded], arrays: Handed, index: Index, step: str) -> list[TraceRow]:
    """In bytes where the port's picture is."""
    if "color" not in arrays:
        return [number(step, legal)]
    found = np.asarray(arrays["color"])[index]
    right = bool(resolve.allows(legal, found))
    return [color(step, legal, found, right)]
