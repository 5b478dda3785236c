"""Where the object stands as a sample of the light sees it, and where that is among the nine maps."""

from __future__ import annotations

from dataclasses import dataclass

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.arithmetic.number import Number, may_and_must
from ibr_ref.oracle.referees.shadows.model import Model


@dataclass(frozen=True, eq=False)
class Place:
    """Along one axis: a cell of the positions that may hold the object, and its fraction in that."""

    cell: int
    fraction: Bounded


def located(model: Model, line: Number, at: Number) -> list[Place]:
    """The legal places on an axis with three positions, the likeliest first: two where the middle line is too near."""
    upper = model.program.upper(at, line[1])
    may, must = may_and_must(upper)
    cells = [int(bool(upper))]
    if bool(may) != bool(must):
        cells = [int(at.value >= line.value[1]), int(at.value < line.value[1])]
    return [Place(cell, fraction_in(model, line, at, cell)) for cell in cells]


def fraction_in(model: Model, line: Number, at: Number, cell: int) -> Bounded:
    """The fraction in a cell that the port has chosen."""
    return model.bounded(model.program.fraction_in(at, line, cell))
