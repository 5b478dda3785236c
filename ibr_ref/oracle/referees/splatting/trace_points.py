"""Points, step by step: from the texel to the window, the width or the ellipse, and the colour."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.programs.splatting.vertex import GAUSSIAN
from ibr_ref.oracle.referees.rows import journaled, number, one, text, told
from ibr_ref.oracle.referees.splatting.model import Branch, Model
from ibr_ref.oracle.referees.splatting.points import Port, allowed, lightings
from ibr_ref.oracle.referees.splatting.table import Table

_PLACED = (
    "fetch: depth",
    "world x, y, z",
    "distance d of the law",
    "w > 0",
    "0 <= z",
    "z <= w",
    "normal of the footprint",
    "n.d, bounded",
    "Jacobian x_u, y_u, x_v, y_v",
    "covariance xx, xy, yy",
    "amplitude",
    "distance along the axis",
)
"""Told of with the place."""


@contextmanager
def journal(model: Model) -> Iterator[list[tuple[str, Any]]]:
    """What the program tells of meanwhile; what may go either way goes as the numbers have it."""
    kept: list[tuple[str, Any]] = []
    model.machine.begin(np.zeros(1, np.int64))
    model.machine.journal = kept
    try:
        yield kept
    finally:
        model.machine.journal = None


def shaped(port: Port, vertex: int) -> Port:
    """By the normals that the port's point agrees with, if it does with one."""
    found = {n: np.asarray(a, np.float64)[vertex] for n, a in port.handed.items() if n in GAUSSIAN[:2]}
    for way in port.ways[::-1]:
        gaussian = way.placed.gaussian
        if gaussian is None or not found:
            break
        numbers = np.concatenate([np.ravel(a) for a in found.values()])
        if len(found) < len(GAUSSIAN[:2]) or gaussian[vertex][: len(numbers)].allows(numbers).all():
            return way
    return port


def point_rows(port: Port, vertex: int) -> list[TraceRow]:
    """From the texel to the window, the width and the colour."""
    point = port.table.take(np.array([vertex]))
    model, own = port.model, {n: np.asarray(a)[vertex] for n, a in port.handed.items() if n.startswith("vertex.")}
    source = ", ".join(str(int(each[0])) for each in (point.image, point.rows, point.columns))
    mine = None if "vertex.source" not in own else ", ".join(str(int(each)) for each in own["vertex.source"])
    with journal(model) as kept:
        model.placed(point)
    rows = [told("image, row, column", source, mine, array="vertex.source"), *journaled(kept)]
    return [*rows, *_landed(model, point, own), *lit(model, point, own.get("vertex.color"))]


def _landed(model: Model, point: Table, own: dict[str, Any]) -> list[TraceRow]:
    """Where the point is in the window, and how wide; as the port has decided where both is legal."""
    placed = model.placed(point)
    kept = bool(placed.possible[0])
    if kept and not placed.sure[0] and "vertex.width" in own:
        kept = bool(own["vertex.width"] > 0.0)
    if not kept:
        nothing = {"vertex.window": "nan, nan", "vertex.depth": "nan", "vertex.width": "0"}
        if model.elliptic:
            nothing |= dict(zip(GAUSSIAN, ("nan, nan, nan", "nan", "nan"), strict=True))
        port = {name: text(own[name]) for name in nothing if name in own}
        return [told(f"dropped: {name}", left, port.get(name), array=name) for name, left in nothing.items()]
    window = [one(x) for x in placed.window]
    rows = [
        number("window x, y", window, own.get("vertex.window"), array="vertex.window"),
        number("window depth z / w", one(placed.depth), own.get("vertex.depth"), array="vertex.depth"),
    ]
    if placed.gaussian is None:
        return [*rows, number("width, clamped", one(placed.width), own.get("vertex.width"), array="vertex.width")]
    *covariance, amplitude, distance = (one(x) for x in placed.gaussian.T)
    numbers = dict(zip(GAUSSIAN, (covariance, [amplitude], [distance]), strict=True))
    side = number("larger side of the box", one(placed.width), own.get("vertex.width"), array="vertex.width")
    return [
        *rows, side, *(number(name.partition(".")[2], x, own.get(name), array=name) for name, x in numbers.items())
    ]  # fmt: skip


def lit(model: Model, point: Table, found: Any = None) -> list[TraceRow]:
    """The light on the only point of a table: with the normal that the port's colour agrees with, if one does."""
    branches: list[Branch] = []
    for lighting in reversed(lightings(model, point)):
        branches, point = model.colors(lighting, model.placed(lighting).world), lighting
        if found is None or allowed(branches, np.asarray(found, np.float64)[None])[0]:
            break
    with journal(model) as kept:
        image, texels = model.case.scene.images[int(point.image[0])], point.texels(slice(None))
        model.program.lit(image, model.placed(point).world, texels.codes, texels.albedo)
    rows = journaled([entry for entry in kept if entry[0] not in _PLACED])
    branches = [branch for branch in branches if branch.legal[0]]
    legal = [allowed([b], np.asarray(found, np.float64)[None])[0] if found is not None else False for b in branches]
    best = int(np.argmax(legal))
    for k, branch in enumerate(branches):
        # Stored as a float32 once more, as where it is judged.
        bounds = [stored_again(one(x)) for x in branch.color.T]
        step = "colour" if k == best else "colour with n.l > 0 decided otherwise"
        rows.append(number(step, bounds, found if k == best else None, array="vertex.color" if k == best else ""))
    return rows


def stored_again(bound: Bounded) -> Bounded:
    """With one rounding more."""
    return bound.widened(UNIT * np.abs(bound.value))
