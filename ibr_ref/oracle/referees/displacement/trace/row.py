"""Rows of a trace: results beside what the port has of them, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import TraceRow
from ibr_ref.oracle.referees.displacement.replay import Port
from ibr_ref.oracle.referees.displacement.rows import Vector


def number(value: float) -> str:
    """With nine digits: those of float32."""
    return f"{value:.9g}"


def vector(values: Sequence[float] | Floats) -> str:
    """Numbers in brackets."""
    return "(" + ", ".join(number(float(v)) for v in values) + ")"


def one(components: Vector, i: int) -> Vector:
    """Of one element, the i-th."""
    return [x[i : i + 1] for x in components]


def compared(step: str, legal: Number | Vector, found: Any) -> TraceRow:
    """A result, a number or components, of one element, and what the port has of it."""
    parts = list(legal) if isinstance(legal, list) else [legal]
    value = np.concatenate([np.ravel(x.value) for x in parts])
    error = np.concatenate([np.ravel(np.broadcast_to(x.deviation, x.shape)) for x in parts])
    found = None if found is None else np.ravel(found)
    note = ""
    if found is not None:
        near = (np.abs(found - value) <= error) | (found == value) | (np.isnan(found) & np.isnan(value))
        note = "" if bool(near.all()) else "differs"

    def words(values: Floats) -> str:
        return vector(values) if len(values) > 1 else number(float(values[0]))

    port = "" if found is None else words(found)
    return TraceRow(step=step, reference=words(value), port=port, bound=float(np.max(error)), note=note)


def handed_words(port: Port, pixel: int, names: Sequence[str]) -> str:
    """The port's own numbers, in their order."""
    shown = []
    for name in (name for name in names if name in port.handed):
        value = np.atleast_1d(port.floats(name)[pixel])
        if np.asarray(port.handed[name]).dtype == np.bool_:
            shown.append(str(bool(value[0])))
        else:
            shown.append(vector(value) if len(value) > 1 else number(float(value[0])))
    return ", ".join(shown)
