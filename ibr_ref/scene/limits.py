"""What fields of parameters may be, as tables: checked when a description is made, and shown by whoever offers them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.scene import checks


@dataclass(frozen=True)
class Whole:
    """A whole number in [low, high]."""

    low: int
    high: int

    def checked(self, field: str, value: Any) -> int:
        """The number. Raises ValueError for another."""
        return checks.whole(field, value, low=self.low, high=self.high)


@dataclass(frozen=True, kw_only=True)
class Real:
    """A finite number with low <= number <= high and number > above."""

    low: float = -math.inf
    above: float = -math.inf
    high: float = math.inf

    def checked(self, field: str, value: Any) -> float:
        """The number. Raises ValueError for another."""
        return checks.number(field, value, low=self.low, above=self.above, high=self.high)


@dataclass(frozen=True)
class Word:
    """One of some words."""

    allowed: tuple[str, ...]

    def checked(self, field: str, value: Any) -> str:
        """The word. Raises ValueError for another."""
        checks.choice(field, value, self.allowed)
        return str(value)


@dataclass(frozen=True)
class Flag:
    """True or False."""

    def checked(self, field: str, value: Any) -> bool:
        """Which. Raises ValueError for anything else."""
        if not isinstance(value, (bool, np.bool_)):
            raise checks.reject(field, value, "True | False")
        return bool(value)


Limit = Whole | Real | Word | Flag


def check(description: object, limits: Mapping[str, Limit]) -> None:
    """Put the fields of a frozen description in their places as limits have them. Raises ValueError for one that is not."""
    for name, limit in limits.items():
        object.__setattr__(description, name, limit.checked(name, getattr(description, name)))
