"""Rows of a trace: numbers, comparisons, and what is only told."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.arithmetic.number import Number, Truth
from ibr_ref.oracle.judgement import TraceRow

CERTAIN, EITHER, DIFFERS = "certain", "either way is legal", "differs"


def text(value: ArrayLike, digits: int = 9) -> str:
    """Numbers with as many digits as a float32 has."""
    return ", ".join(f"{float(number):.{digits}g}" for number in np.ravel(np.asarray(value)))


def number(
    step: str,
    bounds: Bounded | list[Bounded],
    port: ArrayLike | None = None,
    *,
    array: str = "",
    index: tuple[int, ...] | None = None,
) -> TraceRow:
    """A result of one or more numbers, how far off a device may be, and whether the port's is legal."""
    bounds = bounds if isinstance(bounds, list) else [bounds]
    values = np.array([float(bound.value) for bound in bounds])
    found = None if port is None else np.ravel(np.asarray(port, np.float64))
    legal = found is None or all(bool(b.allows(p)) for b, p in zip(bounds, found, strict=True))
    return compared_numbers(step, values, found, legal, array, index, max(float(bound.error) for bound in bounds))


def compared_numbers(
    step: str,
    values: NDArray[np.float64],
    found: NDArray[np.float64] | None,
    legal: bool,
    array: str = "",
    index: tuple[int, ...] | None = None,
    bound: float | None = None,
) -> TraceRow:
    """Numbers side by side, with more digits where a float32's do not tell them apart."""
    reference, port = text(values), "" if found is None else text(found)
    if not legal and reference == port:
        reference, port = text(values, 17), "" if found is None else text(found, 17)
    note = "" if legal else DIFFERS
    return TraceRow(step=step, reference=reference, port=port, bound=bound, note=note, array=array, index=index)


def color(step: str, bounds: list[Bounded], found: NDArray[Any], legal: bool) -> TraceRow:
    """A pixel of the port's picture (3,), in bytes where that is."""
    values = np.array([float(bound.value) for bound in bounds])
    row = compared_numbers(
        step, values, found.astype(np.float64), legal, "color", None, max(float(b.error) for b in bounds)
    )
    if found.dtype != np.uint8:
        return row
    return TraceRow(**{**vars(row), "port": f"{text(found)} / 255"})


def compared(step: str, outcome: bool, margin: float, bound: float, port: str = "", answer: str = "") -> TraceRow:
    """A comparison: how it came out, in a word of its own or as yes or no, and whether rounding may turn it."""
    certain = abs(margin) > bound or bound == 0.0
    return TraceRow(
        step=step,
        reference=answer or ("yes" if outcome else "no"),
        port=port,
        margin=abs(float(margin)),
        bound=float(bound),
        note=CERTAIN if certain else EITHER,
    )


def told(
    step: str,
    reference: Any,
    port: Any = None,
    *,
    legal: bool | None = None,
    array: str = "",
    index: tuple[int, ...] | None = None,
) -> TraceRow:
    """What is exact: integers, names. legal: where others than the reference's are."""
    mine, theirs = str(reference), "" if port is None else str(port)
    differs = not legal if legal is not None else bool(theirs) and theirs != mine
    return TraceRow(step=step, reference=mine, port=theirs, note=DIFFERS if differs else "", array=array, index=index)


def journaled(journal: list[tuple[str, Any]]) -> list[TraceRow]:
    """What a program has told of while it ran for one element."""
    return [_journaled(step, x) for step, x in journal]


def _journaled(step: str, x: Any) -> TraceRow:
    if isinstance(x, Truth):
        answer = bool(np.ravel(x.must)[0]) or (bool(np.ravel(x.may)[0]) and float(np.ravel(x.margin)[0]) > 0.0)
        return compared(step, answer, float(np.ravel(x.margin)[0]), float(np.ravel(x.bound)[0]))
    parts = x if isinstance(x, list) else [x]
    if any(isinstance(part, Number) for part in parts):
        return number(step, [one(part) for part in parts])
    if np.asarray(parts[0]).dtype.kind == "b":
        return told(step, "yes" if np.all(x) else "no")
    return told(step, text([np.ravel(part)[0] for part in parts]))


def one(x: Any, index: Any = 0) -> Bounded:
    """A number with its bound, of one element."""
    if not isinstance(x, Number):
        return Bounded(np.asarray(np.ravel(x)[0]), np.zeros(()), None)  # type: ignore[arg-type]
    value, error = (np.broadcast_to(each, x.shape) for each in (x.value, x.deviation))
    at = index if x.shape else ()
    return Bounded(np.asarray(value[at]), np.asarray(error[at]), x.do.device)


def heading(rows: list[TraceRow], array: str) -> TraceRow | None:
    """The row of an array that disagrees, or else the first of that array."""
    mine = [row for row in rows if row.array == array]
    return next((row for row in mine if row.note == DIFFERS), mine[0] if mine else None)
