"""Traces of the warp: places, grids and texels."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.accept.bounded import Bounded, exact, lerp
from ibr_ref.oracle.accept.fetch import Texture, fetch
from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.referees.shadows import places
from ibr_ref.oracle.referees.shadows.inputs import Inputs
from ibr_ref.oracle.referees.shadows.trace.rows import compared, number, told
from ibr_ref.oracle.referees.shadows.warp import Source, mesh_of


def place(given: Inputs, index: tuple[int, ...]) -> list[TraceRow]:
    """Cell and fraction on one axis; index: sample, if there are more, and axis."""
    sample, k = (index[0], index[1]) if given.count > 1 else (0, index[0])
    line, at = given.lines[k], given.offset_seen(sample)[k]
    cell, fraction = given.own("warp.cell"), given.own("warp.fraction")
    legal = places.located(line, at)
    found = None if cell is None else int(cell[sample, k])
    rows = [
        number("displacement of the sample", given.samples[sample].displacement[k]),
        number("the object as the sample sees it", at),
        told("the maps' lines", ", ".join(f"{n:.9g}" for n in line.value)),
        compared("at or above the middle line", at - line[1]),
        told("cell", legal[0].cell, found, legal=found is None or found in [p.cell for p in legal]),
    ]
    here = legal[0].fraction if found not in (0, 1) else places.fraction_in(line, at, found)
    return [*rows, number("fraction", here, None if fraction is None else fraction[sample, k])]


def share(given: Inputs, index: tuple[int, ...]) -> list[TraceRow]:
    """A projective fraction; index: sample, if there are more, and upper row, lower row, or between them."""
    sample, (which,) = _split(given, index)
    x, y = given.places(sample)[0]
    corners = [[given.depths[y.cell + k, x.cell + n] for n in range(2)] for k in range(2)]
    ends = corners[which] if which < 2 else [lerp(row[0], row[1], x.fraction) for row in corners]
    own = given.own("warp.shares")
    return [
        number("fraction", x.fraction if which < 2 else y.fraction),
        number("depths w0, w1", ends),
        number("share", given.made_shares((x, y))[which], None if own is None else own[sample, which]),
    ]


def _split(given: Inputs, index: tuple[int, ...]) -> tuple[int, tuple[int, ...]]:
    return (index[0], index[1:]) if given.count > 1 else (0, index)


def grid_point(given: Inputs, array: str, index: tuple[int, ...]) -> list[TraceRow]:
    """A point of a grid in between."""
    sample, rest = _split(given, index)
    spot = given.places(sample)[0]
    own = given.own(array)
    found = None if own is None else own[(sample, *rest)]
    if array == "warp.grid":
        ends, mix, made = given.row_grids(sample, spot), given.shares(sample, spot)[2], given.made_grid(sample, spot)
        names = ("row grid 0", "row grid 1")
    else:
        row, *rest_of = rest
        rest = tuple(rest_of)
        x, y = spot
        ends = [given.controls[y.cell + row, x.cell + n] for n in range(2)]
        mix, made = given.shares(sample, spot)[row], given.made_row_grids(sample, spot)[row]
        names = (f"grid of map {y.cell + row}, {x.cell}", f"grid of map {y.cell + row}, {x.cell + 1}")
    return [
        *(number(f"{name}: u, v", _point(end, rest)) for name, end in zip(names, ends, strict=True)),
        number("fraction", mix),
        number("lerp: u, v", _point(made, rest), found),
    ]


def _point(grid: Bounded, at: tuple[int, ...]) -> list[Bounded]:
    return [grid[(*at, k)] for k in range(2)]


def warped_texel(given: Inputs, array: str, index: tuple[int, ...]) -> list[TraceRow]:
    """A texel of a row or of the result: the triangle over it, both fetches and their mix."""
    sample, rest = _split(given, index)
    spot = given.places(sample)[0]
    own = given.own(array)
    found = None if own is None else own[(sample, *rest)]
    if array == "warp.image":
        grids, rows = given.row_grids(sample, spot), given.rows(sample, spot)
        sources = [Source(row, grid) for row, grid in zip(rows, grids, strict=True)]
        target, mix, made = given.grid(sample, spot), given.shares(sample, spot)[2], given.made_image(sample, spot)
    else:
        row, *rest_of = rest
        rest = tuple(rest_of)
        sources = given.sources(spot, row)
        target, mix = given.row_grids(sample, spot)[row], given.shares(sample, spot)[row]
        made = given.made_rows(sample, spot)[row]
    lines = [number("fraction", mix)]
    if given.nearest:
        half = mix - exact(0.5, given.device)
        lines.append(compared("fraction >= 0.5", half, "the second image" if half.value >= 0.0 else "the first image"))
    size = len(made.value)
    mesh = mesh_of(target, size)
    for i in np.flatnonzero((mesh.found.rows == rest[0]) & (mesh.found.columns == rest[1])):
        name = f"triangle {int(mesh.found.triangle[i])}"
        lines.append(told(f"{name}: covers", "certainly" if mesh.found.certain[i] else "perhaps: near an edge"))
        for n, source in enumerate(sources):
            u, v = (axis[i : i + 1] for axis in mesh.coordinates(source.grid))
            lines.append(number(f"{name}: image {n}: u, v", [u[0], v[0]]))
            lines.append(number(f"{name}: image {n}: bilinear fetch", fetch(Texture(source.image.value), u, v)[0]))
    return [*lines, number("texel", made[rest], found)]
