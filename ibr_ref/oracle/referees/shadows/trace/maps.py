"""Traces of the maps and their control points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.referees.outcomes import stored
from ibr_ref.oracle.referees.rows import compared_numbers, number, told
from ibr_ref.oracle.referees.shadows import maps, replay_maps
from ibr_ref.oracle.referees.shadows.inputs import Inputs

MOST = 12
"""Triangles that are listed."""


def position(given: Inputs, index: tuple[int, ...]) -> list[TraceRow]:
    """Map (j, i): where the object stands along each axis."""
    j, i = index
    own = given.own("maps.positions", sampled=False)
    rows = []
    legal = given.model.bounded(given.model.program.positions())
    for k, (axis, at) in enumerate(zip((legal[0, :, 0], legal[:, 0, 1]), (i, j), strict=True)):
        name, widest = "xy"[k], max(abs(float(moved.value[k])) for moved in given.displacements)
        rows.append(told(f"{name}: range", np.asarray(given.case.scene.offset_range)[k].tolist()))
        rows.append(told(f"{name}: widened by the light's samples", f"{widest:.9g}"))
        rows += [number(f"{name}: line {n}", axis[n]) for n in range(3)]
        rows.append(told(f"{name}: of this map", f"line {at}"))
    return [
        *rows,
        number(
            "position x, y",
            [legal[j, i, k] for k in range(2)],
            None if own is None else own[j, i],
            array="maps.positions",
        ),
    ]


def depth(given: Inputs, index: tuple[int, ...]) -> list[TraceRow]:
    """Map (j, i): how far before the light the caster's middle is."""
    own, bounded = given.own("maps.depths", sampled=False), given.model.bounded
    found = None if own is None else own[index]
    low, high = np.asarray(given.case.scene.caster.bounds).tolist()
    return [
        told("the caster's box, from", ", ".join(f"{n:.9g}" for n in low)),
        told("to", ", ".join(f"{n:.9g}" for n in high)),
        number("offset of the map", [bounded(line)[n] for line, n in zip(given.lines, index[::-1], strict=True)]),
        number("depth of its middle along the view axis", bounded(given.made_depths)[index], found),
    ]


def control(given: Inputs, index: tuple[int, ...]) -> list[TraceRow]:
    """Point (j, i, r, c)."""
    own = given.own("controls", sampled=False)
    value, legal = given.reference("controls", sampled=False)[index], given.model.bounded(given.given_controls)
    points = [legal[(*index, k)] for k in range(2)]
    found = None if own is None else own[index]
    j, i, r, c = index
    return [
        told("map j, i", f"{j}, {i}"),
        told("row, column of the grid", f"{r}, {c}"),
        told("as the case gives it", f"{value[0]:.17g}, {value[1]:.17g}"),
        number("control point u, v", points, found, array="controls"),
    ]


def map_texel(given: Inputs, array: str, index: tuple[int, ...]) -> list[TraceRow]:
    """A texel of a map that is rendered: the triangles that may cover its samples."""
    case, k = given.case, int(given.case.params.map_samples)
    depth, moved = case.params.content == "depth", False
    (row, column), program, model = index[-2:], given.model.program, given.model
    if array == "maps.image":
        own, legal = given.own("maps.positions", sampled=False), program.positions()
        reference = given.reference("maps.positions", sampled=False)
        usable = own is not None and bool(np.isfinite(own[index[:2]]).all())
        moved = usable and own is not None and bool((own[index[:2]] != reference[index[:2]]).any())
        at = legal[index[:2]]
        if own is not None and usable:
            at = stored(model.machine, own[index[:2]], at)
        raster, clip = program.map_raster(model.machine), program.caster_clip(at, program.light_view(program.centre))
    else:
        place = program.places[index[0] if given.count > 1 else 0]
        at, raster, clip = program.offset, program.direct_raster(model.machine), program.sample_clip(place)
    size = int(case.params.map_size) * (1 if depth else k)
    found = maps.drawn(model, raster, clip)
    samples = 1 if depth else k
    port = np.asarray(given.handed[array])[index]
    rows = [number("the object's offset", [model.bounded(at)[k] for k in range(2)])]
    near = np.flatnonzero((found.found.rows // samples == row) & (found.found.columns // samples == column))
    rows.append(told("triangles that may cover its samples", len(near)))
    for i in near[:MOST]:
        name = f"triangle {int(found.found.triangle[i])}"
        rows.append(told(f"{name}: covers", "certainly" if found.found.certain[i] else "perhaps: near an edge"))
        if found.depth is not None:
            rows.append(number(f"{name}: depth", found.depth[i]))
    if depth:
        assert found.winners is not None
        rows.append(told("may be empty", "yes" if found.winners.empty.reshape(size, size)[row, column] else "no"))
    else:
        low, high = (maps.counts(c, k)[row, column] for c in found.covered)
        rows.append(told("share of its samples that are covered", f"from {low:.9g} to {high:.9g}"))
    texel = _texel(found, near, samples) if moved else float(np.asarray(case.frame.stages[array])[index])
    mine, theirs = (np.array([float(n)]) for n in (texel, port))
    return [*rows, compared_numbers("texel", mine, theirs, _legal(given, array, index), array)]


def _texel(found: maps.Drawn, near: NDArray[np.int64], samples: int) -> float:
    """The texel in exact arithmetic, of an object that stands where the port says."""
    inside = near[(found.found.weights[near] >= 0.0).all(axis=1)]
    if found.depth is not None:
        return float(found.depth.value[inside].min(initial=1.0))
    return len(np.unique(found.pixel[inside])) / float(samples * samples)


def _legal(given: Inputs, array: str, index: tuple[int, ...]) -> bool:
    found = (replay_maps.images if array == "maps.image" else replay_maps.warped)(given)
    return found is None or not bool(found.wrong[index])
