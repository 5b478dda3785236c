"""What a page has sliders for: fields with their limits and values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ibr_ref.scene import checks
from ibr_ref.scene.limits import Flag, Limit, Real, Whole, Word


@dataclass(frozen=True)
class OneOf:
    """One of some values that are not all words."""

    values: tuple[Any, ...]

    def checked(self, field: str, value: Any) -> Any:
        """The value. Raises ValueError for another."""
        if isinstance(value, bool) or value not in self.values:
            raise checks.reject(field, value, " | ".join(map(str, self.values)))
        return value


@dataclass(frozen=True)
class Knob:
    """A field that may be turned."""

    limit: Limit | OneOf
    value: Any
    """Where it stands when the page opens."""
    says: str = ""
    readers: tuple[str, ...] = ()
    """The values of the field by which systems are chosen that read it; none: all."""

    def described(self, name: str) -> dict[str, Any]:
        """For the page, as JSON has it."""
        return {"name": name, "value": self.value, "says": self.says, "readers": self.readers, **_of(self.limit)}


def _of(limit: Limit | OneOf) -> dict[str, Any]:
    match limit:
        case Whole(low, high):
            return {"kind": "whole", "low": low, "high": high}
        case Real(low=low, above=above, high=high):
            return {"kind": "real", "low": _finite(max(low, above)), "high": _finite(high)}
        case Word(allowed):
            return {"kind": "choice", "values": allowed}
        case OneOf(values):
            return {"kind": "choice", "values": values}
        case Flag():
            return {"kind": "flag"}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def turned(knobs: Mapping[str, Knob], values: Mapping[str, Any]) -> dict[str, Any]:
    """The values that are not where they were, each checked. Raises ValueError for a name or a value that is none."""
    for name in values:
        if name not in knobs:
            raise checks.reject("knob", name, " | ".join(knobs))
    checked = {name: knobs[name].limit.checked(name, value) for name, value in values.items()}
    return {name: value for name, value in checked.items() if value != knobs[name].value}
