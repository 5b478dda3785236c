"""Rows of a trace: numbers, comparisons, and what is only told."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.judgement import TraceRow

CERTAIN, EITHER, DIFFERS = "certain", "either way is legal", "differs"


def text(value: ArrayLike) -> str:
    """Numbers with as many digits as a float32 has."""
    return ", ".join(
        "nan" if np.isnan(number) else f"{number:.9g}" for number in np.ravel(np.asarray(value, np.float64))
    )


def number(step: str, bounds: list[Bounded], port: ArrayLike | None = None) -> TraceRow:
    """A result of one or more numbers, and whether the port's is legal."""
    values = [float(bound.value) for bound in bounds]
    bound = max(float(bound.error) for bound in bounds)
    if port is None:
        return TraceRow(step=step, reference=text(values), port="", bound=bound)
    found = np.ravel(np.asarray(port, np.float64))
    legal = all(bool(bound.allows(value)) for bound, value in zip(bounds, found, strict=True))
    return TraceRow(step=step, reference=text(values), port=text(found), bound=bound, note="" if legal else DIFFERS)


def compared(step: str, outcome: bool, margin: float, bound: float, port: str = "") -> TraceRow:
    """A comparison: how it came out, and whether rounding may turn it."""
    certain = abs(margin) > bound or bound == 0.0
    return TraceRow(
        step=step,
        reference="yes" if outcome else "no",
        port=port,
        margin=abs(float(margin)),
        bound=float(bound),
        note=CERTAIN if certain else EITHER,
    )


def told(step: str, reference: Any, port: Any = None) -> TraceRow:
    """What is exact: integers, names."""
    mine, theirs = str(reference), "" if port is None else str(port)
    return TraceRow(step=step, reference=mine, port=theirs, note=DIFFERS if theirs and theirs != mine else "")
