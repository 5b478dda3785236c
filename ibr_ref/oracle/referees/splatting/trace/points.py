"""The vertex stage of one point."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ibr_ref.oracle.cases.case import Case
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.judgement import Handed, TraceRow
from ibr_ref.oracle.referees.rows import compared, number, text, told
from ibr_ref.oracle.referees.splatting.lighting import lit_terms, shades
from ibr_ref.oracle.referees.splatting.place import Placed, placed
from ibr_ref.oracle.referees.splatting.table import Table, table
from ibr_ref.oracle.referees.splatting.vertex import wrong_color


def point(case: Case, device: Device, handed: Handed, vertex: int) -> list[TraceRow]:
    """From the texel to the window, the width and the colour."""
    points = alone(table(case, device, handed), vertex)
    where = placed(case, device, points)
    image = int(np.flatnonzero(np.diff(points.starts))[0])
    source = (image, int(points.rows[0]), int(points.columns[0]))
    own = {name: np.asarray(array)[vertex] for name, array in handed.items() if name.startswith("vertex.")}
    rows = [
        told("image, row, column", _listed(source), _integers(own.get("vertex.source")), array="vertex.source"),
        number("fetch: depth", [points.depth[0]]),
        number("world x, y, z", [axis[0] for axis in where.world]),
        *_kept(where),
        *_landed(where, own),
    ]
    return rows + colored(case, device, points, where, own.get("vertex.color"))


def alone(points: Table, vertex: int) -> Table:
    """The table of one point."""
    image = int(np.searchsorted(points.starts, vertex, side="right")) - 1
    starts = np.where(np.arange(len(points.starts)) > image, 1, 0)
    one = slice(vertex, vertex + 1)
    return replace(
        points,
        starts=starts,
        rows=points.rows[one],
        columns=points.columns[one],
        depth=points.depth[one],
        albedo=points.albedo[one],
        codes=points.codes[one],
        given=points.given[one],
        usable=points.usable[one],
    )


def _integers(array: Any) -> str | None:
    return None if array is None else _listed(array)


def _listed(numbers: Any) -> str:
    return ", ".join(str(int(number)) for number in numbers)


def _landed(where: Placed, own: dict[str, Any]) -> list[TraceRow]:
    """Where the point is in the window, and how wide; as the port has decided where both is legal."""
    kept = bool(where.kept[0])
    if where.doubtful[0] and "vertex.width" in own:
        kept = bool(own["vertex.width"] > 0.0)
    if not kept:
        expected = {"vertex.window": "nan, nan", "vertex.depth": "nan", "vertex.width": "0"}
        return [
            told(f"dropped: {name}", nothing, _text(own.get(name)), array=name) for name, nothing in expected.items()
        ]
    return [
        number("window x, y", [where.x[0], where.y[0]], own.get("vertex.window"), array="vertex.window"),
        number("window depth z / w", [where.depth[0]], own.get("vertex.depth"), array="vertex.depth"),
        number("distance d of the law", [where.distance[0]]),
        number("width, clamped", [where.width[0]], own.get("vertex.width"), array="vertex.width"),
    ]


def _text(array: Any) -> str | None:
    return None if array is None else text(array)


def _kept(where: Placed) -> list[TraceRow]:
    z, w = where.clip_z[0], where.clip_w[0]
    return [
        compared("w > 0", bool(w.value > 0.0), float(w.value), float(w.error)),
        compared("0 <= z", bool(z.value >= 0.0), float(z.value), float(z.error)),
        compared("z <= w", bool(z.value <= w.value), float(w.value - z.value), float(z.error + w.error)),
    ]


def colored(case: Case, device: Device, points: Table, where: Placed, port: Any = None) -> list[TraceRow]:
    """The light on the only point of a table: with the normal that the port's colour agrees with, if one does."""
    for lighting in points.lightings if port is not None else ():
        legal = shades(case, device, where.world, lighting.codes, points.albedo)
        if not wrong_color(legal, np.asarray(port, np.float64)[None]).any():
            points = lighting
            break
    rows = [number("fetch: stored colour", [points.albedo[0, c] for c in range(3)])]
    if case.scene.light is not None:
        terms = lit_terms(case, device, where.world, points.codes)
        facing = terms.facing[0]
        rows.append(told("fetch: 8-bit normal", tuple(points.codes[0].tolist())))
        rows.append(compared("n.l > 0", bool(facing.value > 0.0), float(facing.value), float(facing.error)))
        rows.append(number("n.l", [facing]))
        if case.scene.light.specular > 0.0:
            rows.append(number("r.v", [terms.mirrored[0]]))
            rows.append(number("highlight, where n.l > 0", [terms.shine[0]]))
    legal = shades(case, device, where.world, points.codes, points.albedo)
    taken = not legal.split[0] or port is None or not legal.other[0].allows(port).all()
    # Stored as a float32 once more, as where it is judged.
    color = legal.color.widened(UNIT * np.abs(legal.color.value))
    rows.append(number("colour", [color[0, c] for c in range(3)], port if taken else None, array="vertex.color"))
    if legal.split[0]:
        rows.append(number("colour with n.l > 0 decided otherwise", [legal.other[0, c] for c in range(3)], port))
    return rows
