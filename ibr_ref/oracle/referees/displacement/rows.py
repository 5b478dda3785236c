"""Tables of outcomes: columns of integers, of numbers with bounds, and of vectors of these."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Self

import numpy as np

from ibr_ref.array_types import Bools, Ints
from ibr_ref.oracle.arithmetic.decisions import joined
from ibr_ref.oracle.arithmetic.number import Number

Vector = list[Any]
Index = Any


def taken(column: Any, index: Index) -> Any:
    """Rows of a column."""
    return [taken(x, index) for x in column] if isinstance(column, list) else column[index]


def absorbed(column: Any) -> Any:
    """What leaves a run, for symbols have names within one only."""
    if isinstance(column, list):
        return [absorbed(x) for x in column]
    return column.absorbed() if isinstance(column, Number) else column


class Rows:
    """A dataclass of columns of one length."""

    pixel: Ints

    def __len__(self) -> int:
        return len(self.pixel)

    def take(self, index: Index) -> Self:
        """Some rows."""
        return replace(self, **{f.name: taken(getattr(self, f.name), index) for f in fields(self)})  # type: ignore[type-var, arg-type]

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """One table after the other."""
        columns = {f.name: joined([getattr(p, f.name) for p in parts]) for f in fields(cls)}  # type: ignore[arg-type]
        return cls(**columns)


@dataclass(frozen=True, kw_only=True, eq=False)
class Points(Rows):
    """(n,) fragments that are marched from."""

    pixel: Ints
    polygon: Ints
    face: Ints
    certain: Bools
    """The fragment is there whatever the device does."""
    point: Vector
    """C."""
    depth: Number
    """Of the face."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Hits(Rows):
    """(n,) legal outcomes of the march of fragments."""

    pixel: Ints
    polygon: Ints
    face: Ints
    certain: Bools
    point: Vector
    linear_index: Ints
    hit_index: Ints
    """-1 discarded; then the hit is NaN and the depth infinite."""
    hit: Vector
    """(u, v, h)."""
    height_before: Number
    steep: Bools
    depth: Number

    @property
    def kept(self) -> Bools:
        """Whether anything was hit."""
        return np.asarray(self.hit_index >= 0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Shades(Rows):
    """(n,) legal looks of hits."""

    pixel: Ints
    hit: Ints
    """Index of the hit."""
    albedo: Vector
    normal: Vector
    lit: Bools
