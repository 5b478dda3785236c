"""What rows hold: measures by name."""

from __future__ import annotations

from typing import NamedTuple

MILLISECONDS = "milliseconds"
"""The one measure that is not the same on every machine."""


class Measure(NamedTuple):
    """A column of the table."""

    meaning: str
    more: bool = False
    """Whether more of it is better."""


def with_time(measures: dict[str, Measure]) -> dict[str, Measure]:
    """A method's measures, and the time that all methods take."""
    return {**measures, MILLISECONDS: Measure("of the picture alone, kernels warm, on one worker's threads")}
