"""Values of a parameter, as `--over` has them."""

from __future__ import annotations

import re
from decimal import Decimal
from typing import NamedTuple

from ibr_ref.cli import options

Value = int | float | str

MOST_VALUES = 10_000
"""Of a parameter; what a sweep may have in all is said by `ibr_ref.sweep`."""

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d{1,3})?", re.ASCII | re.IGNORECASE)
_WORD = re.compile(r"[a-z_][a-z0-9_]*", re.ASCII | re.IGNORECASE)

_ALLOWED = "NAME=A,B,.. or NAME=FROM:TO:STEP, such as steps=5:100:5 or delta=0.02,0.05,0.1"


class Over(NamedTuple):
    """A parameter and its values."""

    name: str
    values: tuple[Value, ...]

    def __str__(self) -> str:
        return f"{self.name}={','.join(map(str, self.values))}"


class Bound(NamedTuple):
    """A measure, and what it may be."""

    name: str
    value: float

    def __str__(self) -> str:
        return f"{self.name}={self.value:g}"


@options.reads
def over(text: str) -> Over:
    """NAME=A,B,.. or NAME=FROM:TO:STEP, TO included."""
    name, _, rest = text.partition("=")
    name = name.replace("-", "_")  # options are written with dashes
    values = _range(rest) if ":" in rest else [_value(word) for word in rest.split(",")]
    if not _WORD.fullmatch(name) or not values or None in values:
        raise options.bad(text, _ALLOWED)
    return Over(name, tuple(value for value in values if value is not None))


@options.reads
def bound(text: str) -> Bound:
    """MEASURE=NUMBER."""
    name, _, number = text.partition("=")
    if not _WORD.fullmatch(name) or not _NUMBER.fullmatch(number):
        raise options.bad(text, "MEASURE=NUMBER, such as wrong=0.005")
    return Bound(name, float(number))


def _value(word: str) -> Value | None:
    if _NUMBER.fullmatch(word):
        return int(word) if re.fullmatch(r"[+-]?\d{1,18}", word, re.ASCII) else float(word)
    return word if _WORD.fullmatch(word) else None


def _range(text: str) -> list[Value | None]:
    """FROM:TO:STEP in decimals, so that 0.02:0.1:0.02 has 0.1 and no 0.060000000000000005; empty for what is none."""
    parts = text.split(":")
    if len(parts) != 3 or not all(map(_NUMBER.fullmatch, parts)):
        return []
    first, last, step = map(Decimal, parts)
    if not step > 0 or last < first or (last - first) / step >= MOST_VALUES:
        return []
    return [_value(str(first + i * step)) for i in range(int((last - first) / step) + 1)]
