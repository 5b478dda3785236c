"""What is known of a device."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ibr_ref.oracle.declaration import NUMBERS

DRIVER_FAULTS: dict[str, str] = {
    "sprites beside their points": "point sprites do not lie around their points, by more than a step of any raster",
    "sprites one pixel at least": "point sprites that are smaller than a pixel are drawn as large as one",
    "remainder of unsigned numbers": "a % b of a negative i32 is that of unsigned numbers",
}
"""By name: what no standard allows."""


@dataclass(frozen=True)
class Measured:
    """What was found."""

    numbers: Mapping[str, int | float | str] = field(default_factory=dict)
    """As they are declared."""
    why: Mapping[str, str] = field(default_factory=dict)
    """For each of them, and for what else was measured."""
    faults: Mapping[str, str] = field(default_factory=dict)
    """By their names in `DRIVER_FAULTS`: what shows them."""

    @property
    def assumed(self) -> list[str]:
        """The numbers that are the profile's."""
        return [name for name in NUMBERS if name not in self.numbers]

    def __or__(self, other: Measured) -> Measured:
        """Both."""
        return Measured({**self.numbers, **other.numbers}, {**self.why, **other.why}, {**self.faults, **other.faults})
