"""Traces of the warp: places, grids and texels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded, exact
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.referees.rows import compared, number, told
from ibr_ref.oracle.referees.shadows import places
from ibr_ref.oracle.referees.shadows.inputs import Inputs, Spot
from ibr_ref.oracle.referees.shadows.model import stacked
from ibr_ref.oracle.referees.shadows.warp import mesh_of


def place(given: Inputs, index: tuple[int, ...]) -> list[TraceRow]:
    """Cell and fraction on one axis; index: sample, if there are more, and axis."""
    sample, k = (index[0], index[1]) if given.count > 1 else (0, index[0])
    line, at, bounded = given.lines[k], given.offset_seen(sample)[k], given.model.bounded
    cell, fraction = given.own("warp.cell"), given.own("warp.fraction")
    legal = places.located(given.model, line, at)
    found, cells = None if cell is None else int(cell[sample, k]), [p.cell for p in legal]
    rows = [
        number("displacement of the sample", bounded(given.displacements[sample][k])),
        number("the object as the sample sees it", bounded(at)),
        told("the maps' lines", ", ".join(f"{n:.9g}" for n in line.value)),
        _crossing("at or above the middle line", bounded(at - line[1])),
        told("cell", legal[0].cell, found, legal=found is None or found in cells, array="warp.cell"),
    ]
    here = next((p.fraction for p in legal if p.cell == found), legal[0].fraction)
    own = None if fraction is None else fraction[sample, k]
    return [*rows, number("fraction", here, own, array="warp.fraction")]


def _crossing(step: str, difference: Bounded, answer: str = "") -> TraceRow:
    """A comparison by the difference of its sides: true where that is >= 0."""
    value = float(difference.value)
    return compared(step, value >= 0.0, value, float(difference.error), answer=answer)


def _spot(
    given: Inputs, sample: int, own: NDArray[np.float64] | None, make: Callable[[int, Spot], Number]
) -> tuple[Spot, Bounded]:
    """Of the places that a sample may find the one that agrees with most of what the port has, as where it is judged."""
    made = [(spot, given.model.bounded(make(sample, spot))) for spot in given.places(sample)]
    if own is None or len(made) == 1:
        return made[0]
    return max(made, key=lambda each: int(each[1].allows(own[sample]).sum()))


def paced(given: Inputs, index: tuple[int, ...]) -> list[TraceRow]:
    """A projective fraction; index: sample, if there are more, and upper row, lower row, or between them."""
    sample, (which,) = _split(given, index)
    (x, y), bounded, do = given.places(sample)[0], given.model.bounded, given.model.machine
    corners = [[given.depths[y.cell + k, x.cell + n] for n in range(2)] for k in range(2)]
    share = given.model.number(x.fraction)
    ends = [bounded(w) for w in (corners[which] if which < 2 else [do.lerp(row[0], row[1], share) for row in corners])]
    own = given.own("warp.shares")
    return [
        number("fraction", x.fraction if which < 2 else y.fraction),
        number("depths w0, w1", ends),
        number(
            "share",
            bounded(given.made_shares((x, y))[which]),
            None if own is None else own[sample, which],
            array="warp.shares",
        ),
    ]


def _split(given: Inputs, index: tuple[int, ...]) -> tuple[int, tuple[int, ...]]:
    return (index[0], index[1:]) if given.count > 1 else (0, index)


def grid_point(given: Inputs, array: str, index: tuple[int, ...]) -> list[TraceRow]:
    """A point of a grid in between."""
    sample, rest = _split(given, index)
    own, bounded = given.own(array), given.model.bounded
    found = None if own is None else own[(sample, *rest)]
    if array == "warp.grid":
        spot, made = _spot(given, sample, own, given.made_grid)
        ends, share = [bounded(g) for g in given.row_grids(sample, spot)], bounded(given.shares(sample, spot)[2])
        names = ("row grid 0", "row grid 1")
    else:
        row, *rest_of = rest
        rest = tuple(rest_of)
        (x, y), both = _spot(given, sample, own, lambda n, place: stacked(given.made_row_grids(n, place)))
        ends = [bounded(given.controls)[y.cell + row, x.cell + n] for n in range(2)]
        share, made = bounded(given.shares(sample, (x, y))[row]), both[row]
        names = (f"grid of map {y.cell + row}, {x.cell}", f"grid of map {y.cell + row}, {x.cell + 1}")
    return [
        *(number(f"{name}: u, v", _point(end, rest)) for name, end in zip(names, ends, strict=True)),
        number("fraction", share),
        number("lerp: u, v", _point(made, rest), found, array=array),
    ]


def _point(grid: Bounded, at: tuple[int, ...]) -> list[Bounded]:
    return [grid[(*at, k)] for k in range(2)]


def warped_texel(given: Inputs, array: str, index: tuple[int, ...]) -> list[TraceRow]:
    """A texel of a row or of the result: the triangle over it, both fetches and their mix."""
    sample, rest = _split(given, index)
    own, bounded = given.own(array), given.model.bounded
    found = None if own is None else own[(sample, *rest)]
    if array == "warp.image":
        spot, made = _spot(given, sample, own, given.made_image)
        grids, rows = given.row_grids(sample, spot), given.rows(sample, spot)
        sources = list(zip(rows, grids, strict=True))
        target, share = given.grid(sample, spot), bounded(given.shares(sample, spot)[2])
    else:
        row, *rest_of = rest
        rest = tuple(rest_of)
        spot, both = _spot(given, sample, own, lambda s, place: stacked(given.made_rows(s, place)))
        made, two = both[row], slice(2 * row, 2 * row + 2)
        sources = list(zip(given.maps(spot)[two], given.grids(spot)[two], strict=True))
        target, share = given.row_grids(sample, spot)[row], bounded(given.shares(sample, spot)[row])
    lines = [number("fraction", share)]
    if given.case.params.policy == "nearest":
        half = share - exact(0.5, given.device)
        lines.append(_crossing("fraction >= 0.5", half, "the second image" if half.value >= 0.0 else "the first image"))
    size = len(made.value)
    mesh = mesh_of(given.model, target, size)
    fetched = [(mesh.coordinates(grid), mesh.fetched(image, grid)) for image, grid in sources]
    over = np.flatnonzero((mesh.found.rows == rest[0]) & (mesh.found.columns == rest[1]))
    if not len(over):
        lines.append(told("triangles of the grid over it", f"none: {given.model.program.empty():g} in either image"))
    for i in over:
        name = f"triangle {int(mesh.found.triangle[i])}"
        lines.append(told(f"{name}: covers", "certainly" if mesh.found.certain[i] else "perhaps: near an edge"))
        for n, (place, texel) in enumerate(fetched):
            lines.append(number(f"{name}: image {n}: u, v", [bounded(axis)[i] for axis in place]))
            lines.append(number(f"{name}: image {n}: bilinear fetch", texel[i]))
    return [*lines, number("texel", made[rest], found, array=array)]
