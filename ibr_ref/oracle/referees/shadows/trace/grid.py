"""Traces of the map for a place of the object among n x n maps."""

from __future__ import annotations

from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.referees.rows import number, told
from ibr_ref.oracle.referees.shadows.inputs import Inputs


def grid_texel(given: Inputs, index: tuple[int, ...]) -> list[TraceRow]:
    """Where the object lies among the maps, what those around hold there, and the texel."""
    program, bounded, at = given.model.program, given.model.bounded, index[-2:]
    place = program.places[index[0] if given.count > 1 else 0]
    seen, ends = program.place_of_object(place), program.grid_ends()
    lines = [program.lines_from_first(seen[k], *ends[k]) for k in range(2)]
    i, j = (min(max(int(line.value), 0), program.intervals() - 1) for line in lines)
    rows = [
        number("the object as the sample sees it", [bounded(seen[k]) for k in range(2)]),
        *(number(f"{axis}: first and last map", [bounded(end) for end in ends[k]]) for k, axis in enumerate("xy")),
        number("x, y in maps from the first", [bounded(line) for line in lines]),
    ]
    rows += [
        number(f"map of row {row}, column {column}", bounded(program.grid_image(column, row))[at])
        for row in (j, j + 1)
        for column in (i, i + 1)
    ]
    rows.append(told("taken are", "all four, mixed" if given.case.params.grid_mix else "the nearest"))
    own = given.own("warp.image")
    found = None if own is None else own[(index[0] if given.count > 1 else 0, *at)]
    return [*rows, number("texel", bounded(program.grid_map(place))[at], found, array="warp.image")]
