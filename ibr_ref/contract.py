"""What an array of a stage is: the record that each method's table, `<method>/contract.py`, is made of.

The tables are the one place where shape, dtype, the value of "nothing" and the meaning of an array are written down. The
case's schema, its README, the check of submissions and the referees read them; tests hold them against what `render` makes
and against the tables of the pages (`ibr-ref method`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

Value = float | int | bool | tuple[int, ...]

OWN: Literal["own"] = "own"
"""What is left is what any other has there."""

DType = Literal["bool", "uint8", "int32", "float64"]


@dataclass(frozen=True, kw_only=True)
class StageArray:
    """One array, under its name "stage.array"."""

    shape: tuple[str | int, ...]
    """Letters are sizes that the method's page explains: ("H", "W", 3)."""
    dtype: DType
    meaning: str
    nothing: Value | None = None
    """Where no face, splat or surface is; None: there is always something."""
    remark: str = ""
    """What follows the value in words, or stands in its place."""
    discarded: Value | Literal["own"] | None = None
    """What a discarded fragment or point leaves; None: it leaves nothing in this array."""
    paged: bool = False
    """One array for each page of an atlas: "stage.array.0" and so on."""
    per_sample: bool = False
    """With more than one light sample there is a leading axis of samples."""
    only: str = ""
    """The parameters with which it is there, where not always."""

    @property
    def nothing_words(self) -> str:
        """In words: `NaN`, `-1; also where discarded`, `-`."""
        return (spelled(self.nothing) + self.remark) or "-"

    @property
    def blank(self) -> float:
        """The number that stands where nothing is. Raises TypeError for an array that always has something."""
        return _number(self.nothing)

    @property
    def left(self) -> float:
        """The number that a discarded fragment or point leaves. Raises TypeError where that is its own, or nothing."""
        return _number(self.discarded)

    @property
    def shape_words(self) -> str:
        """As Python writes it: `(H, W, 3)`."""
        inner = ", ".join(map(str, self.shape))
        return f"({inner},)" if len(self.shape) == 1 else f"({inner})"


def _number(value: Value | str | None) -> float:
    if value is None or isinstance(value, (str, tuple)):
        raise TypeError(f"found {value}, allowed: an array whose nothing is one number")
    return value


def spelled(value: Value | str | None) -> str:
    """A value as the pages and `case.json` write it."""
    if value is None:
        return ""
    if isinstance(value, (bool, str, tuple)):
        return str(value).lower()
    return "NaN" if value != value else f"{value:g}"


IMAGE: dict[str, StageArray] = {
    "color": StageArray(
        shape=("H", "W", 3), dtype="float64", meaning="linear colour in [0, 1]", remark="the background"
    ),
    "depth": StageArray(
        shape=("H", "W"), dtype="float64", meaning="window depth: 0 at the near plane, 1 at the far plane", nothing=1.0
    ),
}
"""Of every method."""


def described(contract: Mapping[str, StageArray], name: str) -> StageArray:
    """The entry of an array, of an atlas also by a page's name. Raises KeyError for another name."""
    known: dict[str, Any] = {**IMAGE, **contract}
    if name in known:
        return known[name]  # type: ignore[no-any-return]
    stage, _, page = name.rpartition(".")
    if page.isdecimal() and stage in known and known[stage].paged:
        return known[stage]  # type: ignore[no-any-return]
    raise KeyError(name)


def is_margin(name: str) -> bool:
    """Whether an array says how close a decision was, or what a search cost: ports need not hand it in."""
    return name.endswith(("margin", "fetches"))
