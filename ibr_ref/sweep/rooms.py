"""What a method says of itself for sweeps: a module such as `ibr_ref.sweep.displacement`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol, cast

from ibr_ref import methods
from ibr_ref.scene import checks
from ibr_ref.sweep.measures import Measure


class Room(Protocol):
    """The names of such a module."""

    MEASURES: Mapping[str, Measure]
    ERROR: str
    """The measure that a sweep is about, if nothing else is said."""
    COST: str
    """What settings cost, likewise: the same on every machine."""
    ALIASES: Mapping[str, str]
    """Fields of `Params` by other names that they have on the command line."""
    Params: type[Any]
    Swept: type[Any]
    """`Params`, or what has more fields."""

    def viewed(self, scene: Any, count: int, against: Any) -> tuple[list[Any], str]:
        """Views of a scene, and the word for what they are measured against."""

    def measured(self, view: Any, params: Any, kept: dict[Any, Any]) -> dict[str, float | None]:
        """A row but for its time. kept: for what is made once a view."""

    def drawing(self, view: Any, params: Any) -> Callable[[], object]:
        """What is timed."""


def room_of(method: str) -> Room:
    """Raises ValueError for a method that is not swept."""
    rooms = {record.name: record.sweep for record in methods.records() if record.sweep is not None}
    if method not in rooms:
        raise checks.reject("method", method, " | ".join(rooms))
    return cast(Room, rooms[method].open())
