"""Rows of a trace."""

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.judgement import TraceRow

CERTAIN, EITHER, DIFFERS = "certain", "either way is legal", "differs"


def text(value: Any) -> str:
    """A number, or several."""
    if value is None:
        return ""
    return ", ".join(f"{float(v):.9g}" for v in np.atleast_1d(np.asarray(value)))


def number(step: str, bounds: Bounded | list[Bounded], port: Any = None) -> TraceRow:
    """A result, or several that belong together, and how far off a device may be."""
    bounds = bounds if isinstance(bounds, list) else [bounds]
    legal = port is None or all(bool(b.allows(p)) for b, p in zip(bounds, np.atleast_1d(port), strict=True))
    return TraceRow(
        step=step,
        reference=text([b.value for b in bounds]),
        port=text(port),
        bound=max(float(b.error) for b in bounds),
        note="" if legal else DIFFERS,
    )


def compared(step: str, difference: Bounded, outcome: str = "") -> TraceRow:
    """A comparison by the difference of its sides: true where that is >= 0."""
    margin, bound = abs(float(difference.value)), float(difference.error)
    return TraceRow(
        step=step,
        reference=outcome or ("yes" if float(difference.value) >= 0.0 else "no"),
        port="",
        margin=margin,
        bound=bound,
        note=CERTAIN if margin > bound else EITHER,
    )


def told(step: str, reference: Any, port: Any = None, *, legal: bool = True) -> TraceRow:
    """Something that is no number with a bound."""
    return TraceRow(
        step=step, reference=str(reference), port="" if port is None else str(port), note="" if legal else DIFFERS
    )
