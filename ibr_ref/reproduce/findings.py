"""What a reproduction finds: tables and figures beside the published ones, and claims with the number that settles them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from pydantic import BaseModel, ConfigDict

Cell = str | int | float | None


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Table(_Record):
    """Numbers, row by row."""

    title: str
    """"Table 1: frames a second": the paper's own number and words first."""
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    how: str
    """How every number was measured, in a sentence or two."""
    note: str = ""
    """Where and why it differs from what was published."""


class Figure(_Record):
    """A picture that the package has rendered."""

    title: str
    file: str
    """PNG, beside the JSON."""
    caption: str
    """What is seen, and how it was made."""
    published: str = ""
    """What the paper's figure shows, in words."""


class Claim(_Record):
    """A sentence of the paper, and the number that confirms or refutes it."""

    claim: str
    published: str
    measured: str
    holds: bool
    why: str = ""


class Found(_Record):
    """All of one step."""

    tables: tuple[Table, ...] = ()
    figures: tuple[Figure, ...] = ()
    claims: tuple[Claim, ...] = ()


class Within(Protocol):
    """How a step tells how far it is."""

    def __call__(self, description: str, done: int, total: int) -> None:
        """Say so."""


@dataclass(frozen=True, kw_only=True)
class Step:
    """A part of a reproduction that is done as a whole, and not done again."""

    name: str
    """Of its files: "table-1"."""
    title: str
    run: Callable[[Path, Within], Found]
    """Writes its figures into the folder."""


@dataclass(frozen=True, kw_only=True)
class Reproduction:
    """A paper."""

    number: int
    method: str
    paper: str
    """Authors, year, title."""
    steps: tuple[Step, ...]
    ambiguities: tuple[tuple[str, str], ...] = field(default=())
    """What the paper leaves open, and how it is settled here."""
